// The choice how RGB colours become spectra, from a scene's option or the command's, up to the image.
#include "child_process.h"
#include "colour_difference.h"
#include "image/read_image.h"
#include "image_statistics.h"
#include "scene_folder.h"

#include <array>
#include <cmath>
#include <numbers>

namespace tristim::test {
namespace {

constexpr const char* option = "Option \"string rgbupsampling\" \"meng\"\n";

/// A colour of each kind: of a light, of reflectances in a material and in a named one, and of a refractive index.
constexpr const char* coloured_world = "WorldBegin\n"
                                       "LightSource \"point\" \"rgb I\" [ 30 20 5 ]\n"
                                       "Material \"diffuse\" \"rgb reflectance\" [ 0.7 0.2 0.1 ]\n"
                                       "Shape \"sphere\"\n"
                                       "MakeNamedMaterial \"blue\" \"string type\" \"diffuse\"\n"
                                       "  \"rgb reflectance\" [ 0.1 0.2 0.7 ]\n"
                                       "NamedMaterial \"blue\" Shape \"sphere\"\n"
                                       "Material \"conductor\" \"rgb eta\" [ 0.2 0.9 1.5 ] \"rgb k\" [ 4 2 3 ]\n"
                                       "AttributeBegin\n"
                                       "  AreaLightSource \"diffuse\" \"rgb L\" [ 1 2 0.5 ]\n"
                                       "  Shape \"sphere\"\n"
                                       "AttributeEnd\n";

void expect_equal(const Spectrum& a, const Spectrum& b, const char* what) {
    for (double lambda = 380.0; lambda <= 780.0; lambda += 10.0)
        EXPECT_DOUBLE_EQ(a(lambda), b(lambda)) << what;
}

void expect_upsampling(const Scene& scene, RgbUpsampling form) {
    ASSERT_EQ(scene.lights.size(), 2U);
    ASSERT_EQ(scene.materials.size(), 3U);
    const double white = spectrum_to_xyz(Spectrum::rgb_illuminant_white())[1];
    const auto emission = [&](const Rgb& rgb) { return Spectrum::rgb_illuminant(rgb, form).scaled(1.0 / white); };
    expect_equal(scene.lights[0].emission, emission({30.0, 20.0, 5.0}), "I");
    expect_equal(scene.lights[1].emission, emission({1.0, 2.0, 0.5}), "L");
    expect_equal(scene.materials[0].reflectance, Spectrum::rgb_albedo({0.7, 0.2, 0.1}, form), "reflectance");
    expect_equal(scene.materials[1].reflectance, Spectrum::rgb_albedo({0.1, 0.2, 0.7}, form), "named material");
    expect_equal(scene.materials[2].eta, Spectrum::rgb_unbounded({0.2, 0.9, 1.5}, form), "eta");
    expect_equal(scene.materials[2].k, Spectrum::rgb_unbounded({4.0, 2.0, 3.0}, form), "k");
}

TEST(SceneRgbUpsampling, ReachesEveryColour) {
    const SceneFolder folder;
    const std::string camera = "Camera \"perspective\"\n";
    expect_upsampling(folder.load(camera + coloured_world), RgbUpsampling::JakobHanika);
    const Scene scene = folder.load(option + camera + coloured_world);
    expect_upsampling(scene, RgbUpsampling::Meng);
    EXPECT_TRUE(scene.notes.empty()) << scene.notes.front();
    expect_upsampling(folder.load(camera + "Option \"string rgbupsampling\" \"jakob-hanika\"\n" + coloured_world),
                      RgbUpsampling::JakobHanika);
}

TEST(SceneRgbUpsampling, TheCallersChoiceOverridesTheScenes) {
    const SceneFolder folder;
    const std::string text = std::string("Camera \"perspective\"\n") + option + coloured_world;
    expect_upsampling(load_scene(folder.write("a.pbrt", text), RgbUpsampling::JakobHanika), RgbUpsampling::JakobHanika);
    const std::string plain = std::string("Camera \"perspective\"\n") + coloured_world;
    expect_upsampling(load_scene(folder.write("b.pbrt", plain), RgbUpsampling::Meng), RgbUpsampling::Meng);
    const std::string bad = "Camera \"perspective\"\nOption \"string rgbupsampling\" \"smits\"\n";
    expect_message(error_of([&] { load_scene(folder.write("c.pbrt", bad + coloured_world), RgbUpsampling::Meng); }),
                   folder.path("c.pbrt") + ":2: ", "smits");
}

const std::array<Rgb, 3> strip_colours{Rgb{0.7, 0.2, 0.1}, Rgb{0.0, 0.0, 1.0}, Rgb{0.5, 1.0, 0.0}};

/// Looks down at a diffuse plane of three colours side by side, three columns of pixels each, which a lamp at infinity
/// lights at an angle of 60° to its normal.
std::string lit_strips(const std::string& directives, const std::string& lamp) {
    std::string text = "LookAt 0 0 1  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 30\n"
                       "Film \"rgb\" \"integer xresolution\" 9 \"integer yresolution\" 3\n" +
                       directives + "WorldBegin\nLightSource \"distant\" \"spectrum L\" \"" + lamp +
                       "\" \"float scale\" 5\n"
                       "  \"point3 from\" [ 1.7320508075688772 0 1 ] \"point3 to\" [ 0 0 0 ]\n";
    // Half the height of the image, 1.5 pixels, is tan 15°.
    const std::array<double, 4> borders{-9.0, -std::tan(std::numbers::pi / 12.0), std::tan(std::numbers::pi / 12.0),
                                        9.0};
    for (std::size_t i = 0; i < strip_colours.size(); ++i) {
        const auto& [r, g, b] = strip_colours[i];
        text += fmt::format("Material \"diffuse\" \"rgb reflectance\" [ {} {} {} ]\n"
                            "Shape \"bilinearmesh\" \"point3 P\" [ {} -9 0  {} -9 0  {} 9 0  {} 9 0 ]\n",
                            r, g, b, borders[i], borders[i + 1], borders[i], borders[i + 1]);
    }
    return text;
}

TEST(SceneRgbUpsampling, LitPlanesShowTheirColourInEitherForm) {
    const SceneFolder folder;
    // L = ρ E / π with E = 5 cos 60°: the colour times that, by the white of D65 for RGB.
    constexpr double radiance = 5.0 * 0.5 / std::numbers::pi;
    const Xyz d65 = spectrum_to_xyz(Spectrum::rgb_illuminant_white());
    const Matrix3 matrix = rgb_to_xyz_matrix({radiance * d65[0], radiance * d65[1], radiance * d65[2]});
    for (const std::string& directives : {std::string(), std::string(option)}) {
        const Scene scene = folder.load(lit_strips(directives, "stdillum-D65"));
        // A pass has every wavelength at the same place of its nanometre; over 64 passes that place is its middle to a
        // few hundredths. A shift of all wavelengths by 1 nm is of the order of ΔE = 2.
        const TestImage image = render_image(scene, small_render("spectral:400", 9, 3, 64, 0.1, 4), 64);
        for (std::size_t i = 0; i < strip_colours.size(); ++i) {
            const Rgb& rgb = strip_colours[i];
            Xyz expected{};
            for (std::size_t c = 0; c < 3; ++c)
                expected[c] = matrix[c][0] * rgb[0] + matrix[c][1] * rgb[1] + matrix[c][2] * rgb[2];
            const Xyz white{radiance * d65[0], radiance * d65[1], radiance * d65[2]};
            const Xyz& middle = image.xyz[9 + 3 * (2 - i) + 1]; // +x is on the left in pbrt's left-handed space
            EXPECT_LT(delta_e_1976(to_lab(middle, white), to_lab(expected, white)), 0.5) << directives << i;
        }
    }
}

TEST(SceneRgbUpsampling, TheCommandsOptionDoesWhatTheScenesDoes) {
    const SceneFolder folder;
    // Under a lamp other than D65 the two forms differ in colour.
    const auto render = [&](const std::string& directives, const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"render",
                                           folder.write("scene.pbrt", lit_strips(directives, "stdillum-F11")),
                                           "--passes=1",
                                           "--photons=64",
                                           "--initial-radius=0.1",
                                           "--method=spectral:400",
                                           "--quiet",
                                           "--outfile",
                                           folder.path("out.exr")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ChildResult result = run_tristim(arguments);
        EXPECT_EQ(result.exit_code, 0) << result.standard_error;
        return read_exr(folder.path("out.exr")).xyz;
    };
    const auto by_scene = render(option, {});
    EXPECT_EQ(render("", {"--rgb-upsampling=meng"}), by_scene);
    const auto sigmoid = render("", {});
    EXPECT_GT(std::abs(sigmoid.front()[0] - by_scene.front()[0]), 0.003F * by_scene.front()[0]);
    EXPECT_EQ(render(option, {"--rgb-upsampling", "jakob-hanika"}), sigmoid);
}

} // namespace
} // namespace tristim::test
