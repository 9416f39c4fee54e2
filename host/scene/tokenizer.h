#pragma once

#include "scene/source_location.h"

#include <cstddef>
#include <string>

namespace tristim {

/// The smallest unit of pbrt's syntax.
struct Token {
    enum class Kind { Word, String, OpenBracket, CloseBracket, End };
    Kind kind = Kind::End;
    std::string
        text; ///< a word (directive, number, true/false) as it stands; a string without quotes, escapes replaced
    SourceLocation where;
};

/// Splits one scene file into tokens. '#' starts a comment up to the end of the line.
class Tokenizer {
  public:
    /// Throws Error if the file is missing or unreadable.
    explicit Tokenizer(const std::string& path);

    /// The next token; Kind::End at the end of the file, again and again. Throws Error at an unterminated string.
    Token next();

    const std::string& path() const { return *path_; }

  private:
    void skip_blank();
    std::string read_string(const SourceLocation& where);

    std::shared_ptr<const std::string> path_;
    std::string source_;
    std::size_t position_ = 0;
    int line_ = 1;
};

} // namespace tristim
