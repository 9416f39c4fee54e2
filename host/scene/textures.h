#pragma once

#include "scene/parameters.h"
#include "scene/scene.h"
#include "scene/spectrum_parameters.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tristim {

/// A "float" texture: a constant or a pattern.
struct FloatTexture {
    std::string name;
    SourceLocation where; ///< of the directive
    double value = 0.0;
    std::shared_ptr<const Texture> pattern; ///< null: the value everywhere
};

/// The textures of a scene by name, and the ones that materials use by index.
class TextureTable {
  public:
    /// The directive Texture "name" "type" "kind": pbrt-v4's "float" textures "constant", "bilerp", "imagemap", and
    /// "scale" and "mix" as far as they change one of them linearly, in the space of `ctm`. Remarks for the user go to
    /// `remarks`. Throws Error for anything else.
    void define(const std::string& name, const std::string& type, const std::string& kind, ParameterList& parameters,
                const M44d& ctm, const PathResolver& resolve, std::vector<std::string>& remarks);

    /// Throws Error if no texture has this name so far.
    const FloatTexture& find(const std::string& name, const SourceLocation& where) const;

    /// The index by which a material refers to a texture's pattern.
    int use(const FloatTexture& texture);
    const FloatTexture& used(int index) const { return used_.at(static_cast<std::size_t>(index)); }

  private:
    FloatTexture combined(const std::string& kind, ParameterList& parameters) const;
    FloatTexture operand(ParameterList& parameters, const std::string& name, double fallback) const;

    std::map<std::string, FloatTexture> by_name_;
    std::vector<FloatTexture> used_;
};

/// The smallest and the largest value: of a Bilinear texture within its unit square, of an Image anywhere.
std::array<double, 2> value_range(const Texture& texture);

/// The smallest value on a mesh of a Bilinear texture, which goes on beyond its unit square as in pbrt; exact on edges
/// (where the extremes are) for Uv and Planar mappings, at vertices and edges' middles else.
double least_value(const Texture& texture, const Mesh& mesh);

} // namespace tristim
