#include "scene/scene_builder.h"

#include "scene/transforms.h"
#include "spectra/rgb_upsampling.h"

#include <cmath>
#include <limits>
#include <set>

/// The directives before WorldBegin: camera, film and what says how to render.

namespace tristim {

namespace {

int positive_integer(ParameterList& parameters, const std::string& name, int fallback) {
    const int value = parameters.integer(name, fallback);
    if (value <= 0)
        fail_at(parameters.where(name), "\"{}\" of {} is {}, but it must be positive", name, parameters.owner(), value);
    return value;
}

double positive_number(ParameterList& parameters, const std::string& name, double fallback) {
    const double value = parameters.number(name, fallback);
    if (value <= 0.0)
        fail_at(parameters.where(name), "\"{}\" of {} is {}, but it must be positive", name, parameters.owner(), value);
    return value;
}

int stratified_samples(ParameterList& parameters) {
    const std::int64_t x = positive_integer(parameters, "xsamples", 4);
    const std::int64_t y = positive_integer(parameters, "ysamples", 4);
    if (x * y > std::numeric_limits<int>::max())
        fail_at(parameters.where("xsamples"), "{} has {} times {} samples, which is more than {}", parameters.owner(),
                x, y, std::numeric_limits<int>::max());
    return static_cast<int>(x * y);
}

std::uint32_t seed_parameter(ParameterList& parameters) {
    return static_cast<std::uint32_t>(parameters.integer("seed", 0));
}

/// The kernels take the window's size in single precision.
void check_screen_window(const std::array<double, 4>& window, const SourceLocation& where) {
    const auto& [x0, x1, y0, y1] = window;
    constexpr double largest = std::numeric_limits<float>::max();
    if (!(x1 - x0 <= largest && y1 - y0 <= largest))
        fail_at(where, "the screen window of {} by {} is too large", x1 - x0, y1 - y0);
}

void require_known(const std::set<std::string>& names, const std::string& kind, const ParameterList& parameters) {
    if (!names.contains(kind))
        fail_at(parameters.where(), "{} is not known", parameters.owner());
}

} // namespace

void SceneBuilder::camera(const std::string& kind, ParameterList parameters) {
    require_options("Camera", parameters.where());
    if (kind != "perspective")
        fail_at(parameters.where(), "the camera \"{}\" is not supported", kind);
    Camera& camera = scene_.camera;
    camera = Camera{};
    camera.where = parameters.where();
    camera.camera_to_world = with_location(parameters.where(), [&] { return inverse_transform(state_.ctm); });
    if (!is_finite_float(camera.camera_to_world))
        fail_at(parameters.where(), "the current transformation is too large for a camera");
    coordinate_systems_["camera"] = camera.camera_to_world;
    camera.fov_degrees = parameters.number("fov", 90.0);
    if (camera.fov_degrees <= 0.0 || camera.fov_degrees >= 180.0)
        fail_at(parameters.where("fov"), "\"fov\" is {}, but it must lie between 0 and 180 degrees",
                camera.fov_degrees);
    camera.lens_radius = parameters.number("lensradius", 0.0);
    if (camera.lens_radius < 0.0)
        fail_at(parameters.where("lensradius"), "\"lensradius\" is {}, but it must not be negative",
                camera.lens_radius);
    camera.focal_distance = positive_number(parameters, "focaldistance", 1e6);
    if (parameters.has("frameaspectratio")) {
        const double aspect = positive_number(parameters, "frameaspectratio", 1.0);
        const double x = aspect > 1.0 ? aspect : 1.0;
        const double y = aspect > 1.0 ? 1.0 : 1.0 / aspect;
        camera.screen_window = {-x, x, -y, y};
        check_screen_window(*camera.screen_window, parameters.where("frameaspectratio"));
    }
    if (parameters.has("screenwindow")) {
        const std::vector<double> window = parameters.numbers("screenwindow");
        if (window.size() != 4 || window[0] >= window[1] || window[2] >= window[3])
            fail_at(parameters.where("screenwindow"), "\"screenwindow\" takes four numbers: x0 < x1 and y0 < y1");
        camera.screen_window = {window[0], window[1], window[2], window[3]};
        check_screen_window(*camera.screen_window, parameters.where("screenwindow"));
    }
    for (const char* name : {"shutteropen", "shutterclose"}) {
        if (parameters.ignore(name))
            note(parameters.where(name), fmt::format("\"{}\" is ignored: nothing moves", name));
    }
    parameters.finish();
    has_camera_ = true;
}

void SceneBuilder::film(const std::string& kind, ParameterList parameters) {
    require_options("Film", parameters.where());
    if (kind != "rgb")
        fail_at(parameters.where(), "the film \"{}\" is not supported", kind);
    RenderSettings& settings = scene_.settings;
    settings.width = positive_integer(parameters, "xresolution", 1280);
    settings.height = positive_integer(parameters, "yresolution", 720);
    settings.filename = parameters.text("filename", settings.filename);
    for (const char* name : {"cropwindow", "pixelbounds"}) {
        if (parameters.has(name))
            fail_at(parameters.where(name), "\"{}\" of {} is not supported", name, parameters.owner());
    }
    const std::string sensor = parameters.text("sensor", "cie1931");
    if (sensor != "cie1931")
        fail_at(parameters.where("sensor"), "the sensor \"{}\" is not supported", sensor);
    // pbrt-v4 multiplies the image by this ratio.
    const double imaging_ratio = parameters.number("iso", 100.0) * parameters.number("exposuretime", 1.0) / 100.0;
    if (std::abs(imaging_ratio - 1.0) > 1e-6)
        fail_at(parameters.where(parameters.has("iso") ? "iso" : "exposuretime"),
                "\"iso\" times \"exposuretime\" of {} must be 100: other exposures are not supported",
                parameters.owner());
    if (parameters.number("whitebalance", 0.0) != 0.0)
        fail_at(parameters.where("whitebalance"), "\"whitebalance\" of {} is not supported", parameters.owner());
    for (const char* name : {"savefp16", "diagonal", "maxcomponentvalue"}) {
        if (parameters.ignore(name))
            note(parameters.where(name), fmt::format("\"{}\" of {} is ignored", name, parameters.owner()));
    }
    parameters.finish();
}

void SceneBuilder::sampler(const std::string& kind, ParameterList parameters) {
    require_options("Sampler", parameters.where());
    require_known({"halton", "independent", "paddedsobol", "pmj02bn", "sobol", "stratified", "zsobol"}, kind,
                  parameters);
    note(parameters.where(),
         fmt::format("{} is ignored but for its number of samples and its seed", parameters.owner()));
    RenderSettings& settings = scene_.settings;
    if (kind == "stratified")
        settings.passes = stratified_samples(parameters);
    else
        settings.passes = positive_integer(parameters, "pixelsamples", 16);
    if (parameters.has("seed"))
        settings.seed = seed_parameter(parameters);
    for (const char* name : {"randomization", "jitter"})
        parameters.ignore(name);
    parameters.finish();
}

void SceneBuilder::pixel_filter(const std::string& kind, ParameterList parameters) {
    require_options("PixelFilter", parameters.where());
    require_known({"box", "gaussian", "mitchell", "sinc", "triangle"}, kind, parameters);
    note(parameters.where(), fmt::format("{} is ignored: pixels are boxes", parameters.owner()));
    for (const char* name : {"xradius", "yradius", "sigma", "B", "C", "tau"})
        parameters.ignore(name);
    parameters.finish();
}

void SceneBuilder::accelerator(const std::string& kind, ParameterList parameters) {
    require_options("Accelerator", parameters.where());
    require_known({"bvh", "kdtree"}, kind, parameters);
    note(parameters.where(), fmt::format("{} is ignored", parameters.owner()));
    parameters.ignore_rest();
}

void SceneBuilder::integrator(const std::string& kind, ParameterList parameters) {
    require_options("Integrator", parameters.where());
    require_known({"bdpt", "lightpath", "mlt", "path", "randomwalk", "simplepath", "simplevolpath", "sppm", "volpath"},
                  kind, parameters);
    RenderSettings& settings = scene_.settings;
    settings.max_depth = positive_integer(parameters, "maxdepth", 5);
    if (kind != "sppm") {
        note(parameters.where(), fmt::format("{} is ignored but for \"maxdepth\"", parameters.owner()));
        parameters.ignore_rest();
        return;
    }
    // pbrt-v4's default, -1, stands for one photon per pixel; here it leaves the choice to the renderer.
    if (parameters.has("photonsperiteration") && parameters.integer("photonsperiteration", -1) != -1)
        settings.photons_per_pass = positive_integer(parameters, "photonsperiteration", -1);
    if (parameters.has("radius"))
        settings.initial_radius = positive_number(parameters, "radius", 1.0);
    if (parameters.has("seed"))
        settings.seed = seed_parameter(parameters);
    parameters.finish();
}

void SceneBuilder::option(const std::string& name, ParameterList parameters) {
    require_options("Option", parameters.where());
    if (name == "seed") {
        scene_.settings.seed = seed_parameter(parameters);
        return;
    }
    if (name == "rgbupsampling") {
        scene_rgb_upsampling_ =
            with_location(parameters.where(name), [&] { return parse_rgb_upsampling(parameters.text(name, "")); });
        return;
    }
    const std::set<std::string> without_effect = {"disablepixeljitter",
                                                  "disabletexturefiltering",
                                                  "disablewavelengthjitter",
                                                  "displacementedgescale",
                                                  "msereferenceimage",
                                                  "msereferenceout",
                                                  "pixelstats",
                                                  "rendercoordsys",
                                                  "wavefront"};
    if (!without_effect.contains(name))
        fail_at(parameters.where(), "the option \"{}\" is not supported", name);
    note(parameters.where(), fmt::format("the option \"{}\" is ignored", name));
}

void SceneBuilder::color_space(const std::string& name, const SourceLocation& where) {
    if (name != "srgb")
        fail_at(where, "the colour space \"{}\" is not supported: \"rgb\" values are read as linear sRGB", name);
}

} // namespace tristim
