#include "scene/lights.h"

#include "scene/transforms.h"

#include <cmath>
#include <numbers>

namespace tristim {

namespace {

constexpr double pi = std::numbers::pi;

double radians(double degrees) {
    return degrees * pi / 180.0;
}

double scale_parameter(ParameterList& parameters) {
    const double scale = parameters.number("scale", 1.0);
    if (scale <= 0.0)
        fail_at(parameters.where("scale"), "\"scale\" of {} is {}, but a light must emit", parameters.owner(), scale);
    return scale;
}

/// A photometric target ("power", "illuminance"), absent if not given.
std::optional<double> target_parameter(ParameterList& parameters, const std::string& name) {
    if (!parameters.has(name))
        return std::nullopt;
    const double value = parameters.number(name, 0.0);
    if (value <= 0.0)
        fail_at(parameters.where(name), "\"{}\" of {} is {}, but it must be positive", name, parameters.owner(), value);
    return value;
}

V3d direction_parameter(ParameterList& parameters, const V3d& from, const M44d& ctm) {
    const V3d to = parameters.point("to", V3d(0.0, 0.0, 1.0));
    const V3d direction = transform_vector(ctm, to - from).normalized();
    if (direction.length2() == 0.0)
        fail_at(parameters.where("to"), "\"from\" and \"to\" of {} are the same point", parameters.owner());
    return direction;
}

void set_spot(Light& light, ParameterList& parameters, const M44d& ctm) {
    const V3d from = parameters.point("from", V3d(0.0));
    light.position = transform_point(ctm, from);
    light.direction = direction_parameter(parameters, from, ctm);
    if (!keeps_angles(ctm))
        fail_at(parameters.where(), "{} stands under a transformation that distorts its cone", parameters.owner());
    const double cone = parameters.number("coneangle", 30.0);
    const double delta = parameters.number("conedeltaangle", 5.0);
    if (cone <= 0.0 || cone > 180.0)
        fail_at(parameters.where("coneangle"), "\"coneangle\" is {}, but it must lie in (0, 180] degrees", cone);
    if (delta < 0.0 || delta > cone)
        fail_at(parameters.where("conedeltaangle"), "\"conedeltaangle\" is {}, but it must lie in [0, {}] degrees",
                delta, cone);
    light.cos_total_width = std::cos(radians(cone));
    light.cos_falloff_start = std::cos(radians(cone - delta));
    // pbrt-v4's estimate of the solid angle: the falloff counts as half.
    if (const auto power = target_parameter(parameters, "power"))
        light.scale *=
            *power /
            (2.0 * pi * ((1.0 - light.cos_falloff_start) + (light.cos_falloff_start - light.cos_total_width) / 2.0));
}

void set_distant(Light& light, ParameterList& parameters, const M44d& ctm) {
    const V3d from = parameters.point("from", V3d(0.0));
    light.direction = direction_parameter(parameters, from, ctm);
    light.scale *= target_parameter(parameters, "illuminance").value_or(1.0);
}

} // namespace

void check_light(const Light& light, const SourceLocation& where) {
    const auto scale = static_cast<float>(light.scale);
    if (!(scale > 0.0F) || !std::isfinite(scale))
        fail_at(where, "a light's strength, {} times its spectrum, cannot be held in single precision", light.scale);
    if (!is_finite_float(light.position) || !is_finite_float(light.direction))
        fail_at(where, "the current transformation is too large for a light");
}

Light make_light(const std::string& kind, ParameterList& parameters, const M44d& ctm, const PathResolver& resolve) {
    Light light;
    light.where = parameters.where();
    if (kind != "point" && kind != "spot" && kind != "distant" && kind != "infinite")
        fail_at(parameters.where(), "the light \"{}\" is not supported", kind);
    const bool has_intensity = kind == "point" || kind == "spot";
    light.scale = scale_parameter(parameters);
    if (kind == "infinite" && parameters.has("filename"))
        fail_at(parameters.where("filename"), "\"filename\" of {}: image lights are not supported", parameters.owner());
    light.emission = emission_parameter(parameters, has_intensity ? "I" : "L", resolve);
    if (kind == "point") {
        light.kind = Light::Kind::Point;
        light.position = transform_point(ctm, parameters.point("from", V3d(0.0)));
        if (const auto power = target_parameter(parameters, "power"))
            light.scale *= *power / (4.0 * pi);
    } else if (kind == "spot") {
        light.kind = Light::Kind::Spot;
        set_spot(light, parameters, ctm);
    } else if (kind == "distant") {
        light.kind = Light::Kind::Distant;
        set_distant(light, parameters, ctm);
    } else {
        light.kind = Light::Kind::Infinite;
        if (const auto illuminance = target_parameter(parameters, "illuminance"))
            light.scale *= *illuminance / pi;
    }
    parameters.finish();
    check_light(light, parameters.where());
    return light;
}

AreaLight make_area_light(const std::string& kind, ParameterList& parameters, const PathResolver& resolve) {
    if (kind != "diffuse")
        fail_at(parameters.where(), "the area light \"{}\" is not supported", kind);
    if (parameters.has("filename"))
        fail_at(parameters.where("filename"), "\"filename\" of {}: image lights are not supported", parameters.owner());
    AreaLight result;
    result.light.kind = Light::Kind::Area;
    result.light.where = parameters.where();
    result.light.scale = scale_parameter(parameters);
    result.light.emission = emission_parameter(parameters, "L", resolve);
    result.light.two_sided = parameters.boolean("twosided", false);
    result.power = target_parameter(parameters, "power");
    parameters.finish();
    return result;
}

Light light_of_area(const AreaLight& area_light, double area) {
    Light light = area_light.light;
    if (area_light.power)
        light.scale *= *area_light.power / (pi * area * (light.two_sided ? 2.0 : 1.0));
    return light;
}

} // namespace tristim
