#pragma once

#include "scene/parameters.h"
#include "scene/scene_builder.h"
#include "scene/tokenizer.h"

#include <memory>
#include <string>
#include <vector>

namespace tristim {

/// Reads pbrt-v4's syntax and tells a SceneBuilder what it says.
class SceneParser {
  public:
    /// Throws Error if the file cannot be read.
    SceneParser(const std::string& path, SceneBuilder& builder);

    /// Reads to the end of the file and of all files that it includes.
    void run();

  private:
    void directive(const Token& word);
    bool transform_directive(const Token& word);
    bool simple_directive(const Token& word);
    bool plugin_directive(const Token& word);
    void include(const Token& word);

    Token next();
    const Token& peek();
    std::string expect_string(const Token& directive);
    double expect_number(const Token& directive);
    V3d expect_triple(const Token& directive);
    std::array<double, 16> expect_matrix(const Token& directive);
    ParameterList parameters(std::string owner, const SourceLocation& where);
    Parameter parameter(const Token& declaration, const std::string& owner);
    void add_value(Parameter& parameter, const Token& value) const;

    SceneBuilder& builder_;
    std::vector<std::unique_ptr<Tokenizer>> files_; ///< the innermost include last
    std::size_t includes_ = 0;                      ///< so far
    Token peeked_;
    bool has_peeked_ = false;
};

} // namespace tristim
