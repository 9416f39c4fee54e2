#include "scene/textures.h"

#include "scene/image_texture.h"
#include "scene/transforms.h"
#include "spectra/near_matches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tristim {

namespace {

using std::numbers::pi;

void set_mapping(Texture& texture, ParameterList& parameters, const M44d& ctm) {
    const std::string mapping = parameters.text("mapping", "uv");
    if (mapping == "uv") {
        texture.mapping = Texture::Mapping::Uv;
        texture.uv_scale = {parameters.number("uscale", 1.0), parameters.number("vscale", 1.0),
                            parameters.number("udelta", 0.0), parameters.number("vdelta", 0.0)};
        return;
    }
    M44d& to_texture = texture.world_to_texture;
    to_texture = with_location(parameters.where(), [&] { return inverse_transform(ctm); });
    if (to_texture[0][3] != 0.0 || to_texture[1][3] != 0.0 || to_texture[2][3] != 0.0)
        fail_at(parameters.where(), "{}: a space in perspective is not supported", parameters.owner());
    to_texture *= 1.0 / to_texture[3][3];
    if (!is_finite_float(to_texture))
        fail_at(parameters.where(), "{}: the current transformation is too large", parameters.owner());
    if (mapping == "planar") {
        texture.mapping = Texture::Mapping::Planar;
        const V3d v1 = parameters.vector("v1", V3d(1.0, 0.0, 0.0));
        const V3d v2 = parameters.vector("v2", V3d(0.0, 1.0, 0.0));
        const M44d to_plane(v1.x, v2.x, 0.0, 0.0, //
                            v1.y, v2.y, 0.0, 0.0, //
                            v1.z, v2.z, 0.0, 0.0, //
                            parameters.number("udelta", 0.0), parameters.number("vdelta", 0.0), 0.0, 1.0);
        to_texture = to_texture * to_plane;
        if (!is_finite_float(to_texture))
            fail_at(parameters.where(), "{}: \"v1\" or \"v2\" is too large", parameters.owner());
    } else if (mapping == "spherical") {
        texture.mapping = Texture::Mapping::Spherical;
    } else if (mapping == "cylindrical") {
        texture.mapping = Texture::Mapping::Cylindrical;
    } else {
        fail_at(parameters.where("mapping"),
                "unknown mapping \"{}\": it is \"uv\", \"planar\", \"spherical\" or "
                "\"cylindrical\"",
                mapping);
    }
}

Texture bilinear_texture(ParameterList& parameters, const M44d& ctm) {
    Texture texture;
    texture.kind = Texture::Kind::Bilinear;
    set_mapping(texture, parameters, ctm);
    texture.corners = {parameters.number("v00", 0.0), parameters.number("v01", 1.0), parameters.number("v10", 0.0),
                       parameters.number("v11", 1.0)};
    return texture;
}

/// factor · texture + offset: patterns weight their values by weights that add up to 1.
FloatTexture affine(const FloatTexture& texture, double factor, double offset) {
    FloatTexture result = texture;
    const auto change = [=](double value) { return factor * value + offset; };
    result.value = change(texture.value);
    if (!texture.pattern)
        return result;
    auto pattern = std::make_shared<Texture>(*texture.pattern);
    std::transform(pattern->corners.begin(), pattern->corners.end(), pattern->corners.begin(), change);
    std::transform(pattern->texels.begin(), pattern->texels.end(), pattern->texels.begin(),
                   [&](float value) { return static_cast<float>(change(value)); });
    pattern->outside = change(pattern->outside);
    result.pattern = std::move(pattern);
    return result;
}

/// Scales and mixtures of scales may leave the range of single precision.
void check_values(const FloatTexture& texture, const std::string& name, const SourceLocation& where) {
    const auto is_finite = [](double value) { return std::isfinite(static_cast<float>(value)); };
    bool all_finite = is_finite(texture.value);
    if (texture.pattern) {
        const Texture& pattern = *texture.pattern;
        all_finite &= is_finite(pattern.outside) &&
                      std::all_of(pattern.corners.begin(), pattern.corners.end(), is_finite) &&
                      std::all_of(pattern.texels.begin(), pattern.texels.end(), is_finite);
    }
    if (!all_finite)
        fail_at(where, "the values of the texture \"{}\" are too large", name);
}

/// pbrt-v4's mappings.
V2d texture_coordinates(const Texture& texture, const V3d& point, const V2d& uv) {
    if (texture.mapping == Texture::Mapping::Uv)
        return {texture.uv_scale[0] * uv.x + texture.uv_scale[2], texture.uv_scale[1] * uv.y + texture.uv_scale[3]};
    const V3d p = transform_point(texture.world_to_texture, point);
    if (texture.mapping == Texture::Mapping::Planar)
        return {p.x, p.y};
    const double turn = std::atan2(p.y, p.x) / (2.0 * pi);
    if (texture.mapping == Texture::Mapping::Cylindrical)
        return {0.5 + turn, p.z};
    return {std::atan2(std::hypot(p.x, p.y), p.z) / pi, turn < 0.0 ? turn + 1.0 : turn};
}

double bilinear_value(const Texture& texture, const V3d& point, const V2d& uv) {
    const V2d st = texture_coordinates(texture, point, uv);
    const auto& [v00, v01, v10, v11] = texture.corners;
    return std::lerp(std::lerp(v00, v10, st.x), std::lerp(v01, v11, st.x), st.y);
}

/// The smallest value over [0, 1] of the parabola through three values at 0, 1/2 and 1.
double least_of_parabola(double start, double middle, double end) {
    const double second = 2.0 * (start - 2.0 * middle + end);
    const double first = -3.0 * start + 4.0 * middle - end;
    double least = std::min({start, middle, end});
    if (second > 0.0 && first < 0.0 && -first < 2.0 * second)
        least = std::min(least, start - 0.25 * first * first / second);
    return least;
}

} // namespace

void TextureTable::define(const std::string& name, const std::string& type, const std::string& kind,
                          ParameterList& parameters, const M44d& ctm, const PathResolver& resolve,
                          std::vector<std::string>& remarks) {
    const SourceLocation& where = parameters.where();
    if (name.empty() || by_name_.contains(name))
        fail_at(where, "the texture \"{}\" {}", name, name.empty() ? "has no name" : "is defined already");
    if (type != "float")
        fail_at(where,
                "the texture \"{}\" has the type \"{}\", and only \"float\" textures are supported, for "
                "\"filmthickness\" of materials",
                name, type);
    FloatTexture texture;
    if (kind == "constant") {
        texture.value = parameters.number("value", 1.0);
    } else if (kind == "bilerp") {
        texture.pattern = std::make_shared<Texture>(bilinear_texture(parameters, ctm));
    } else if (kind == "imagemap") {
        Texture image = image_texture(parameters, resolve, remarks);
        set_mapping(image, parameters, ctm);
        texture.pattern = std::make_shared<Texture>(std::move(image));
    } else if (kind == "scale" || kind == "mix") {
        texture = combined(kind, parameters);
    } else {
        fail_at(where,
                "the texture \"{}\" is of the kind \"{}\", which is not supported: it may be \"constant\", "
                "\"bilerp\", \"imagemap\", \"scale\" or \"mix\"",
                name, kind);
    }
    parameters.finish();
    check_values(texture, name, where);
    texture.name = name;
    texture.where = where;
    by_name_.emplace(name, std::move(texture));
}

FloatTexture TextureTable::operand(ParameterList& parameters, const std::string& name, double fallback) const {
    const std::string texture = parameters.texture(name);
    if (!texture.empty())
        return find(texture, parameters.where(name));
    FloatTexture constant;
    constant.value = parameters.number(name, fallback);
    return constant;
}

FloatTexture TextureTable::combined(const std::string& kind, ParameterList& parameters) const {
    if (kind == "scale") {
        const FloatTexture texture = operand(parameters, "tex", 1.0);
        const FloatTexture scale = operand(parameters, "scale", 1.0);
        if (texture.pattern && scale.pattern)
            fail_at(parameters.where(), "{} multiplies two textures, and one of them must be a constant",
                    parameters.owner());
        return scale.pattern ? affine(scale, texture.value, 0.0) : affine(texture, scale.value, 0.0);
    }
    const FloatTexture first = operand(parameters, "tex1", 0.0);
    const FloatTexture second = operand(parameters, "tex2", 1.0);
    const FloatTexture amount = operand(parameters, "amount", 0.5);
    if (!!first.pattern + !!second.pattern + !!amount.pattern > 1)
        fail_at(parameters.where(), "{} mixes several textures, and all but one of them must be constants",
                parameters.owner());
    if (amount.pattern)
        return affine(amount, second.value - first.value, first.value);
    const double a = amount.value;
    return second.pattern ? affine(second, a, (1.0 - a) * first.value) : affine(first, 1.0 - a, a * second.value);
}

const FloatTexture& TextureTable::find(const std::string& name, const SourceLocation& where) const {
    const auto it = by_name_.find(name);
    if (it != by_name_.end())
        return it->second;
    if (by_name_.empty())
        fail_at(where, "no texture \"{}\" is defined", name);
    std::vector<std::string> names;
    for (const auto& [known, texture] : by_name_)
        names.push_back(known);
    fail_at(where, "no texture \"{}\" is defined; did you mean {}?", name, near_matches(name, names));
}

int TextureTable::use(const FloatTexture& texture) {
    const auto it = std::find_if(used_.begin(), used_.end(),
                                 [&](const FloatTexture& other) { return other.pattern == texture.pattern; });
    if (it != used_.end())
        return static_cast<int>(it - used_.begin());
    used_.push_back(texture);
    return static_cast<int>(used_.size()) - 1;
}

std::array<double, 2> value_range(const Texture& texture) {
    if (texture.kind == Texture::Kind::Bilinear) {
        const auto [low, high] = std::minmax_element(texture.corners.begin(), texture.corners.end());
        return {*low, *high};
    }
    const auto [low, high] = std::minmax_element(texture.texels.begin(), texture.texels.end());
    std::array<double, 2> range{*low, *high};
    if (texture.wrap == Texture::Wrap::Black)
        range = {std::min(range[0], texture.outside), std::max(range[1], texture.outside)};
    return range;
}

double least_value(const Texture& texture, const Mesh& mesh) {
    constexpr std::array<std::array<double, 2>, 3> default_uv{{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}};
    double least = std::numeric_limits<double>::infinity();
    for (const auto& triangle : mesh.triangles) {
        std::array<V3d, 3> points{};
        std::array<V2d, 3> uv{};
        for (std::size_t i = 0; i < 3; ++i) {
            points[i] = V3d(mesh.positions[triangle[i]]);
            uv[i] = mesh.uv.empty() ? V2d(default_uv[i][0], default_uv[i][1]) : V2d(mesh.uv[triangle[i]]);
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            least = std::min(
                least, least_of_parabola(bilinear_value(texture, points[i], uv[i]),
                                         bilinear_value(texture, 0.5 * (points[i] + points[j]), 0.5 * (uv[i] + uv[j])),
                                         bilinear_value(texture, points[j], uv[j])));
        }
    }
    return least;
}

} // namespace tristim
