#include "commands/device_check.h"

#include "base/error.h"
#include "base/median.h"
#include "base/stopwatch.h"
#include "meshes/icosphere.h"
#include "opencl/errors.h"
#include "render/renderer.h"
#include "scene/geometry.h"
#include "selftest/selftest.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace tristim {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_passes = 9;
constexpr double most_seconds = 5.0; ///< of passes, as soon as there is one

/// A room |x|, |z| <= 1, 0 <= y <= 2, open to the camera at z = -3.5, which looks along +z.
Scene standard_scene() {
    Scene scene;
    scene.camera.fov_degrees = 40.0;
    scene.camera.camera_to_world = M44d(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, -3.5, 1);
    Material white;
    white.reflectance = Spectrum::constant(0.7);
    Material red;
    red.reflectance = Spectrum::rgb_albedo({0.6, 0.1, 0.1});
    Material glass;
    glass.kind = Material::Kind::Dielectric;
    glass.eta = Spectrum::named("glass-BK7");
    scene.materials = {white, red, glass};
    Light lamp;
    lamp.kind = Light::Kind::Area;
    lamp.scale = 10.0;
    scene.lights = {lamp};

    scene.shapes = {parallelogram({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0),
                    parallelogram({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, 0),
                    parallelogram({-1, 0, 1}, {0, 2, 0}, {2, 0, 0}, 0),
                    parallelogram({-1, 0, -1}, {0, 2, 0}, {0, 0, 2}, 1),
                    parallelogram({1, 0, -1}, {0, 0, 2}, {0, 2, 0}, 0),
                    parallelogram({-0.3, 1.99, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, 0, 0)};

    Shape ball;
    const Icosphere sphere = make_icosphere(3);
    for (const V3d& position : sphere.positions) {
        ball.mesh.positions.push_back(V3d(0.0, 0.6, 0.0) + 0.5 * position);
        ball.mesh.normals.emplace_back(position);
    }
    ball.mesh.triangles = sphere.triangles;
    ball.material = 2;
    scene.shapes.push_back(ball);
    return scene;
}

RenderOptions standard_options() {
    RenderOptions options = options_from_scene({});
    options.method = parse_method("tristimulus:1");
    options.width = 128;
    options.height = 128;
    options.region = {0, 0, options.width, options.height};
    options.photons_per_pass = 16384;
    return options;
}

std::string case_name(const selftest::Case& c) {
    return fmt::format("{}, {}", c.group, c.name);
}

/// Every case, films last: their kernels take the longest to build.
std::vector<selftest::Case> cases_in_order() {
    std::vector<selftest::Case> cases = selftest::all_cases();
    std::stable_partition(cases.begin(), cases.end(), [](const auto& c) { return std::string(c.group) != "film"; });
    return cases;
}

using Report = std::function<void(const std::string&)>;

void time_standard_render(const Device& device, const Report& report) {
    Renderer renderer(standard_scene(), standard_options(), device);
    report(Json{{"kernel_seconds", renderer.statistics().build_kernels_seconds}}.dump());
    std::vector<double> seconds;
    const Stopwatch rendering;
    while (seconds.empty() || (seconds.size() < most_passes && rendering.seconds() < most_seconds)) {
        const Stopwatch pass;
        renderer.render_pass(static_cast<std::uint32_t>(seconds.size()));
        seconds.push_back(pass.seconds());
    }
    report(Json{{"pass_seconds", median(seconds)}}.dump());
}

void run_selftest(const Device& device, double effort, const Report& report) {
    for (const selftest::Case& c : cases_in_order()) {
        const selftest::Outcome outcome = selftest::run(c, {device, false, effort});
        Json line{{"case", case_name(c)}};
        if (!outcome.passed())
            line["failure"] = outcome.failure.empty()
                                  ? fmt::format("error {:.2g} beyond the bound of {}, at {}", outcome.found.worst,
                                                selftest::bound_text(outcome.bound()), outcome.found.where)
                                  : outcome.failure;
        report(line.dump());
    }
}

} // namespace

void check_device(int index, double effort, const std::function<void(const std::string&)>& report) {
    try {
        const Device device = open_device(std::to_string(index));
        // Where a pass takes minutes, the selftest is what there is time for.
        const bool simulator = device.info.platform == "Oclgrind";
        if (!simulator)
            time_standard_render(device, report);
        run_selftest(device, effort, report);
        if (simulator)
            time_standard_render(device, report);
    } catch (const Error& error) {
        report(Json{{"error", error.what()}}.dump());
    } catch (const ::cl::Error& error) {
        report(Json{{"error", describe_opencl_error(error)}}.dump());
    }
}

DeviceCheck unfinished_check(const DeviceInfo& device) {
    DeviceCheck check;
    check.device = device;
    for (const selftest::Case& c : cases_in_order())
        check.skipped.push_back(case_name(c));
    return check;
}

void merge_report(const std::string& line, DeviceCheck& check) {
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object())
        return; // drivers print too
    if (json.contains("error"))
        check.failure = json["error"].get<std::string>();
    if (json.contains("kernel_seconds"))
        check.kernel_seconds = json["kernel_seconds"].get<double>();
    if (json.contains("pass_seconds"))
        check.pass_seconds = json["pass_seconds"].get<double>();
    if (!json.contains("case"))
        return;
    const auto name = json["case"].get<std::string>();
    std::erase(check.skipped, name);
    if (json.contains("failure"))
        check.failed.push_back(name + ": " + json["failure"].get<std::string>());
    else
        ++check.passed;
}

} // namespace tristim
