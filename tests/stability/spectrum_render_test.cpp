// Whole renders of lamps of single lines, narrower than any bin: the image has the line's X, Y and Z whatever the
// method, the line's place and its width.
#include "image/read_image.h"
#include "image_statistics.h"
#include "png_pixels.h"
#include "sampler_oracle.h"
#include "scene_folder.h"
#include "test_names.h"

#include <numbers>

namespace tristim::test {
namespace {

using kernel_test::SamplerOracle;
using kernel_test::unit_roundoff;

/// A triangle of unit area on its foot; what of it is visible.
Spectrum line(double at_nm, double width_nm) {
    return Spectrum::piecewise_linear({at_nm - 0.5 * width_nm, at_nm, at_nm + 0.5 * width_nm},
                                      {0.0, 2.0 / width_nm, 0.0});
}

constexpr double reflectance = 0.5;
constexpr int passes = 256;

/// Nothing but the lamp all around.
Scene seen_lamp(const Spectrum& emission) {
    Scene scene;
    scene.path = "lamp";
    scene.camera = look_at({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 40.0);
    scene.lights = {environment(emission)};
    // Behind the camera: an empty scene is none.
    add_parallelogram(scene, {-5, -1, -1}, {0, 1, 0}, {0, 0, 1}, add_diffuse(scene, Spectrum::constant(0.0)));
    return scene;
}

/// A diffuse floor under a distant lamp of irradiance 1 straight above.
Scene lit_floor(const Spectrum& emission) {
    Scene scene;
    scene.path = "floor";
    scene.camera = look_at({0, -1, 2}, {0, 0, 0}, {0, 0, 1}, 20.0);
    Light lamp;
    lamp.kind = Light::Kind::Distant;
    lamp.direction = {0, 0, -1};
    lamp.emission = emission;
    scene.lights = {lamp};
    add_horizontal_square(scene, 4.0, 0.0, true, add_diffuse(scene, Spectrum::constant(reflectance)));
    return scene;
}

/// Pixels have `factor` times the lamp's X, Y and Z. 2^m stratified passes are off by no more than their discrepancy,
/// 2/2^m, times the variation of the integrand over the positions of a pass's parts (Koksma's inequality; see
/// tests/kernel_sampler_means_test.cpp). spectral:400 has every bin in every pass.
void expect_line(const std::string& what, const Method& method, const Spectrum& lamp, const TestImage& image,
                 double factor) {
    WavelengthBins ones{};
    ones.fill(1.0);
    for (std::size_t c = 0; c < 3; ++c) {
        double exact = 0.0, tolerance = 0.0;
        if (method.kind == Method::Kind::Spectral) {
            exact = spectrum_to_xyz(lamp)[c];
        } else {
            const SamplerOracle oracle(method, lamp.bins());
            const SamplerOracle::Integral integral = oracle.integral(c, lamp.bins(), ones);
            exact = integral.value;
            tolerance = 2.0 / passes / oracle.parts() * integral.variation + integral.rounding;
        }
        // The film's sums, the weights and the geometry are float.
        tolerance += 32.0 * unit_roundoff * exact;
        for (const Xyz& pixel : image.xyz)
            ASSERT_NEAR(pixel[c], factor * exact, factor * tolerance) << what << ", "
                                                                      << "XYZ"[c];
    }
}

class SpectrumStabilityLines : public testing::TestWithParam<const char*> {};

TEST_P(SpectrumStabilityLines, HaveTheirTristimulusValuesInTheImage) {
    const RenderOptions options = small_render(GetParam(), 2, 2, 64, 0.1, 4);
    for (const auto& [at, width] : {std::pair{380.005, 0.01}, {460.0, 0.01}, {546.075, 1e-4}, {779.995, 0.01}}) {
        const Spectrum lamp = line(at, width);
        expect_line(fmt::format("{} sees a line at {} nm", GetParam(), at), options.method, lamp,
                    render_image(seen_lamp(lamp), options, passes), 1.0);
    }
    const Spectrum lamp = line(579.067, 0.01);
    expect_line(fmt::format("{}, a floor under a line", GetParam()), options.method, lamp,
                render_image(lit_floor(lamp), options, passes), reflectance / std::numbers::pi);
}

INSTANTIATE_TEST_SUITE_P(Methods, SpectrumStabilityLines,
                         testing::Values("spectral:400", "tristimulus:20", "illuminant:1", "illuminant-mixture:4",
                                         "visible:16"),
                         [](const auto& method) { return test_name(method.param); });

/// Of a green line: red is negative in the EXR file and black in the PNG file.
TEST(SpectrumStability, ImagesOfLinesKeepTheirNegativeChannels) {
    const Scene scene = seen_lamp(line(520.5, 0.01).scaled(0.01));
    Renderer renderer(scene, small_render("spectral:400", 2, 2, 64, 0.1, 4), test_device());
    renderer.render_pass(0);
    const XyzImage image = xyz_image(renderer.film());
    const Rgb rgb = xyz_to_rgb({image.xyz[0][0], image.xyz[0][1], image.xyz[0][2]});
    ASSERT_LT(rgb[0], 0.0);
    const SceneFolder folder;
    write_exr(folder.path("line.exr"), image, ColourSpace::Srgb, {});
    const XyzImage read = read_exr(folder.path("line.exr"));
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(read.xyz[0][c], image.xyz[0][c], 8.0 * unit_roundoff * (std::abs(rgb[0]) + rgb[1] + rgb[2]));
    write_png(folder.path("line.png"), image, {ToneMapping::Kind::Linear, 9.0});
    const std::array<int, 3> shown = read_png(folder.path("line.png")).rgb.at(0);
    EXPECT_EQ(shown[0], 0);
    EXPECT_GT(shown[1], 50);
}

} // namespace
} // namespace tristim::test
