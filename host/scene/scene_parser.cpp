#include "scene/scene_parser.h"

#include "scene/transforms.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

namespace tristim {

namespace {

/// Files within files: deeper ones include themselves by ever longer paths.
constexpr std::size_t deepest_include = 64;
/// All together, so that a few files that include each other several times cannot go on for ever.
constexpr std::size_t most_includes = 100'000;

/// The finite number that is all of the text, else none.
std::optional<double> parse_number(const std::string& text) {
    const char* begin = text.data() + (text.size() > 1 && text.front() == '+' ? 1 : 0);
    const char* end = text.data() + text.size();
    double value = 0.0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc() || stop != end || !std::isfinite(value))
        return std::nullopt;
    return value;
}

/// pbrt's numbers are floats, and so are the kernels'.
void check_float(double value, const Token& token) {
    if (std::abs(value) > std::numeric_limits<float>::max())
        fail_at(token.where, "the number {} is too large: it must be finite in single precision", token.text);
}

/// Directives of pbrt-v4 that this program knows of but does not support.
const std::set<std::string> unsupported_directives = {"ActiveTransform", "Attribute",       "Import",
                                                      "MakeNamedMedium", "MediumInterface", "TransformTimes"};

const std::set<std::string> number_types = {"integer", "float",  "point2",  "point3", "vector2",
                                            "vector3", "normal", "normal3", "rgb",    "blackbody"};

} // namespace

SceneParser::SceneParser(const std::string& path, SceneBuilder& builder) : builder_(builder) {
    files_.push_back(std::make_unique<Tokenizer>(path));
}

void SceneParser::run() {
    for (Token token = next(); token.kind != Token::Kind::End; token = next()) {
        if (token.kind != Token::Kind::Word)
            fail_at(token.where, "\"{}\" stands where a directive is expected", token.text);
        directive(token);
    }
}

Token SceneParser::next() {
    if (has_peeked_) {
        has_peeked_ = false;
        return std::move(peeked_);
    }
    Token token = files_.back()->next();
    while (token.kind == Token::Kind::End && files_.size() > 1) {
        files_.pop_back();
        token = files_.back()->next();
    }
    return token;
}

const Token& SceneParser::peek() {
    if (!has_peeked_) {
        peeked_ = next();
        has_peeked_ = true;
    }
    return peeked_;
}

void SceneParser::directive(const Token& word) {
    if (word.text == "Include")
        include(word);
    else if (unsupported_directives.contains(word.text))
        fail_at(word.where, "the directive \"{}\" is not supported", word.text);
    else if (!transform_directive(word) && !simple_directive(word) && !plugin_directive(word))
        fail_at(word.where, "unknown directive \"{}\"", word.text);
}

bool SceneParser::transform_directive(const Token& word) {
    const std::string& name = word.text;
    if (name == "Identity") {
        builder_.set_transform(M44d());
    } else if (name == "Translate") {
        builder_.concat_transform(translation(expect_triple(word)));
    } else if (name == "Scale") {
        builder_.concat_transform(scaling(expect_triple(word)));
    } else if (name == "Rotate") {
        const double degrees = expect_number(word);
        const V3d axis = expect_triple(word);
        if (axis.length2() == 0.0)
            fail_at(word.where, "the axis of \"Rotate\" is zero");
        builder_.concat_transform(rotation(degrees, axis));
    } else if (name == "LookAt") {
        const V3d eye = expect_triple(word);
        const V3d target = expect_triple(word);
        const V3d up = expect_triple(word);
        builder_.concat_transform(with_location(word.where, [&] { return look_at(eye, target, up); }));
    } else if (name == "Transform") {
        builder_.set_transform(matrix_from_list(expect_matrix(word)));
    } else if (name == "ConcatTransform") {
        builder_.concat_transform(matrix_from_list(expect_matrix(word)));
    } else {
        return false;
    }
    return true;
}

bool SceneParser::simple_directive(const Token& word) {
    const std::string& name = word.text;
    const SourceLocation& where = word.where;
    if (name == "WorldBegin")
        builder_.world_begin(where);
    else if (name == "AttributeBegin")
        builder_.attribute_begin(where);
    else if (name == "AttributeEnd")
        builder_.attribute_end(where);
    else if (name == "TransformBegin")
        builder_.transform_begin(where);
    else if (name == "TransformEnd")
        builder_.transform_end(where);
    else if (name == "ReverseOrientation")
        builder_.reverse_orientation(where);
    else if (name == "CoordinateSystem")
        builder_.coordinate_system(expect_string(word));
    else if (name == "CoordSysTransform")
        builder_.coord_sys_transform(expect_string(word), where);
    else if (name == "NamedMaterial")
        builder_.named_material(expect_string(word), where);
    else if (name == "ObjectBegin")
        builder_.object_begin(expect_string(word), where);
    else if (name == "ObjectEnd")
        builder_.object_end(where);
    else if (name == "ObjectInstance")
        builder_.object_instance(expect_string(word), where);
    else if (name == "ColorSpace")
        builder_.color_space(expect_string(word), where);
    else
        return false;
    return true;
}

bool SceneParser::plugin_directive(const Token& word) {
    using Handler = void (SceneBuilder::*)(const std::string&, ParameterList);
    static const std::map<std::string, Handler> handlers = {
        {"Camera", &SceneBuilder::camera},
        {"Film", &SceneBuilder::film},
        {"Sampler", &SceneBuilder::sampler},
        {"PixelFilter", &SceneBuilder::pixel_filter},
        {"Integrator", &SceneBuilder::integrator},
        {"Accelerator", &SceneBuilder::accelerator},
        {"Material", &SceneBuilder::material},
        {"MakeNamedMaterial", &SceneBuilder::make_named_material},
        {"LightSource", &SceneBuilder::light_source},
        {"AreaLightSource", &SceneBuilder::area_light_source},
        {"Shape", &SceneBuilder::shape},
    };
    if (word.text == "Option") {
        const Token declaration = next();
        if (declaration.kind != Token::Kind::String)
            fail_at(word.where, "\"Option\" must be followed by \"type name\" in quotes, not by \"{}\"",
                    declaration.text);
        ParameterList option("Option", word.where);
        Parameter value = parameter(declaration, "Option");
        const std::string name = value.name;
        option.add(std::move(value));
        builder_.option(name, std::move(option));
        return true;
    }
    if (word.text == "Texture") {
        const std::string name = expect_string(word);
        const std::string type = expect_string(word);
        const std::string kind = expect_string(word);
        builder_.texture(name, type, kind, parameters(fmt::format("Texture \"{}\"", name), word.where));
        return true;
    }
    const auto handler = handlers.find(word.text);
    if (handler == handlers.end())
        return false;
    const std::string plugin = expect_string(word);
    ParameterList list = parameters(fmt::format("{} \"{}\"", word.text, plugin), word.where);
    (builder_.*handler->second)(plugin, std::move(list));
    return true;
}

void SceneParser::include(const Token& word) {
    const std::string name = expect_string(word);
    const std::string path = builder_.resolve_path(name, word.where);
    const bool circular =
        std::any_of(files_.begin(), files_.end(), [&](const auto& file) { return file->path() == path; });
    if (circular)
        fail_at(word.where, "the file \"{}\" includes itself", name);
    if (files_.size() > deepest_include || ++includes_ > most_includes)
        fail_at(word.where, "the file \"{}\" is one too many: a scene has at most {} includes, {} within each other",
                name, most_includes, deepest_include);
    files_.push_back(with_location(word.where, [&] { return std::make_unique<Tokenizer>(path); }));
}

std::string SceneParser::expect_string(const Token& directive) {
    Token token = next();
    if (token.kind != Token::Kind::String)
        fail_at(directive.where, "\"{}\" must be followed by a name in quotes, not by \"{}\"", directive.text,
                token.text);
    return std::move(token.text);
}

double SceneParser::expect_number(const Token& directive) {
    const Token token = next();
    const std::optional<double> value = token.kind == Token::Kind::Word ? parse_number(token.text) : std::nullopt;
    if (!value)
        fail_at(token.where, "\"{}\" in \"{}\" is not a finite number", token.text, directive.text);
    check_float(*value, token);
    return *value;
}

V3d SceneParser::expect_triple(const Token& directive) {
    const double x = expect_number(directive);
    const double y = expect_number(directive);
    const double z = expect_number(directive);
    return {x, y, z};
}

std::array<double, 16> SceneParser::expect_matrix(const Token& directive) {
    std::array<double, 16> values{};
    if (next().kind != Token::Kind::OpenBracket)
        fail_at(directive.where, "\"{}\" must be followed by 16 numbers in brackets", directive.text);
    for (double& value : values)
        value = expect_number(directive);
    if (next().kind != Token::Kind::CloseBracket)
        fail_at(directive.where, "\"{}\" must be followed by 16 numbers in brackets", directive.text);
    return values;
}

ParameterList SceneParser::parameters(std::string owner, const SourceLocation& where) {
    ParameterList list(owner, where, builder_.rgb_upsampling());
    while (peek().kind == Token::Kind::String)
        list.add(parameter(next(), owner));
    return list;
}

Parameter SceneParser::parameter(const Token& declaration, const std::string& owner) {
    Parameter result;
    result.where = declaration.where;
    const std::string& text = declaration.text;
    const std::size_t begin = text.find_first_not_of(" \t");
    const std::size_t gap = text.find_first_of(" \t", begin);
    const std::size_t name = text.find_first_not_of(" \t", gap);
    const std::size_t end = text.find_last_not_of(" \t");
    if (begin == std::string::npos || gap == std::string::npos || name == std::string::npos ||
        text.find_first_of(" \t", name) <= end)
        fail_at(result.where, "\"{}\" of {} does not read \"type name\"", text, owner);
    result.type = text.substr(begin, gap - begin);
    result.name = text.substr(name, end + 1 - name);
    if (!number_types.contains(result.type) && result.type != "string" && result.type != "texture" &&
        result.type != "bool" && result.type != "spectrum")
        fail_at(result.where, "the parameter \"{}\" of {} has the unknown type \"{}\"", result.name, owner,
                result.type);

    Token token = next();
    if (token.kind == Token::Kind::OpenBracket) {
        for (token = next(); token.kind != Token::Kind::CloseBracket; token = next()) {
            if (token.kind == Token::Kind::End || token.kind == Token::Kind::OpenBracket)
                fail_at(result.where, "the values of the parameter \"{}\" of {} have no closing bracket", result.name,
                        owner);
            add_value(result, token);
        }
    } else if (token.kind == Token::Kind::End || token.kind == Token::Kind::CloseBracket) {
        fail_at(result.where, "the parameter \"{}\" of {} has no value", result.name, owner);
    } else {
        add_value(result, token);
    }
    return result;
}

void SceneParser::add_value(Parameter& parameter, const Token& value) const {
    const bool quoted = value.kind == Token::Kind::String;
    if (parameter.type == "bool") {
        if (value.text != "true" && value.text != "false")
            fail_at(value.where, "\"{}\" in the parameter \"{}\" is neither true nor false", value.text,
                    parameter.name);
        parameter.bools.push_back(value.text == "true");
        return;
    }
    const bool takes_strings =
        parameter.type == "string" || parameter.type == "texture" || parameter.type == "spectrum";
    if (quoted && takes_strings) {
        parameter.strings.push_back(value.text);
        return;
    }
    const bool takes_numbers = parameter.type == "spectrum" || number_types.contains(parameter.type);
    const std::optional<double> number = quoted || !takes_numbers ? std::nullopt : parse_number(value.text);
    if (!number)
        fail_at(value.where, "\"{}\" in the parameter \"{}\" is not a {}", value.text, parameter.name,
                takes_numbers ? "finite number" : "string in quotes");
    if (parameter.type == "integer" &&
        (*number != std::floor(*number) || std::abs(*number) > std::numeric_limits<int>::max()))
        fail_at(value.where, "\"{}\" in the parameter \"{}\" is not an integer", value.text, parameter.name);
    check_float(*number, value);
    parameter.numbers.push_back(*number);
}

} // namespace tristim
