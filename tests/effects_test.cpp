// The table of effects, why a scene calls for each, and that one that is compiled in without need changes nothing.
#include "base/embedded_files.h"
#include "image_statistics.h"
#include "render/kernel_macros.h"
#include "scene_folder.h"

#include <cstring>
#include <regex>
#include <set>

namespace tristim::test {
namespace {

const EffectKind& kind_of(const std::string& name) {
    for (const EffectKind& kind : effect_table()) {
        if (kind.name == name)
            return kind;
    }
    throw std::out_of_range(name);
}

TEST(Effects, TableHoldsTheMacrosOfConfigH) {
    const std::string config(embedded_files().at("kernels/config.h"));
    const std::regex definition("#ifndef (HAS_[A-Z_]+)\n#define \\1 0");
    std::set<std::string> macros;
    for (std::sregex_iterator it(config.begin(), config.end(), definition), end; it != end; ++it)
        macros.insert((*it)[1]);
    std::set<std::string> table;
    for (const EffectKind& kind : effect_table())
        EXPECT_TRUE(table.insert(kind.macro).second) << kind.macro << " comes twice";
    EXPECT_EQ(table, macros);
    const Effects all = parse_effects("all");
    for (const auto& [macro, value] : effect_macros(all))
        EXPECT_EQ(value, "1") << macro;
}

/// A line of a scene file for each effect, or several.
struct CallingLine {
    int line;
    std::vector<std::string> effects;
    std::string what; ///< part of the reason
};

TEST(Effects, EachHasItsReasonWithFileAndLine) {
    const SceneFolder folder;
    const std::string square = "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0  1 1 0 ]\n";
    const std::string text =
        "Camera \"perspective\" \"float lensradius\" 0.1\n"
        "WorldBegin\n"
        "LightSource \"point\"\n"
        "LightSource \"spot\"\n"
        "LightSource \"distant\"\n"
        "LightSource \"infinite\"\n"
        "MakeNamedMaterial \"unused\" \"string type\" \"dielectric\"\n"
        "MakeNamedMaterial \"glass\" \"string type\" \"dielectric\" \"spectrum eta\" \"glass-BK7\"\n"
        "Texture \"wedge\" \"float\" \"bilerp\" \"float v00\" 100 \"float v01\" 200\n"
        "NamedMaterial \"glass\" " +
        square +
        "Material \"conductor\" \"float uroughness\" 0.5 \"float vroughness\" 0.2 \"bool remaproughness\" false " +
        square + "Material \"dielectric\" \"float roughness\" 0.01 \"bool remaproughness\" false " + square +
        "Material \"diffuse\" \"texture filmthickness\" \"wedge\" \"string filmeta\" \"Ag\" " + square +
        "AreaLightSource \"diffuse\" Shape \"trianglemesh\" \"point3 P\" [ 0 0 1  1 0 1  0 1 1 ] "
        "\"normal N\" [ 0 0 1  0 0 1  0 0 1 ]\n";
    const Scene scene = folder.load(text);
    const std::vector<CallingLine> lines{{1, {"thin-lens"}, "lens radius 0.1"},
                                         {3, {"point-light"}, "point light"},
                                         {4, {"spot-light"}, "spot light"},
                                         {5, {"distant-light"}, "distant light"},
                                         {6, {"infinite-light"}, "infinite light"},
                                         {8, {"dielectric", "dispersion"}, "material \"glass\""},
                                         {9, {"texture", "uv"}, "texture \"wedge\""},
                                         {11, {"conductor"}, "material \"conductor\""},
                                         {11, {"rough", "rough-photons", "anisotropic", "uv"}, "alpha 0.5 and 0.2"},
                                         {12, {"dielectric", "rough", "nearly-specular"}, "material \"dielectric\""},
                                         {13, {"film", "absorbing-film", "coated-diffuse"}, "material \"diffuse\""},
                                         {14, {"area-light"}, "area light"},
                                         {14, {"shading-normals"}, "mesh with normals"}};
    const std::vector<EffectReason> reasons = effect_reasons(scene);
    std::size_t expected = 0;
    for (const CallingLine& line : lines) {
        for (const std::string& name : line.effects) {
            ++expected;
            const std::string where = folder.path("scene.pbrt") + ":" + std::to_string(line.line);
            const auto found = std::count_if(reasons.begin(), reasons.end(), [&](const EffectReason& reason) {
                return reason.effect == kind_of(name).flag && reason.where.text() == where &&
                       reason.what.find(line.what) != std::string::npos;
            });
            EXPECT_EQ(found, 1) << name << " by line " << line.line;
        }
    }
    EXPECT_EQ(reasons.size(), expected);
    EXPECT_EQ(derive_effects(scene), parse_effects("all"));
}

TEST(Effects, PlainSceneCallsForItsLightAlone) {
    Effects expected;
    expected.point_light = true;
    const SceneFolder folder;
    EXPECT_EQ(derive_effects(folder.load(with_lit_world(""))), expected);
}

TEST(Effects, NamesSwitchOnWhatTheyNeed) {
    Effects expected;
    expected.anisotropic = expected.rough = expected.uv = expected.thin_lens = true;
    EXPECT_EQ(parse_effects("anisotropic,thin-lens"), expected);
    for (const std::string bad : {"", "fog", "film,", "Film", "film, rough", "all,fog"}) {
        const std::string message = error_of([&] { parse_effects(bad); });
        expect_message(message, "unknown effect '", "dielectric, dispersion, conductor, film");
    }
}

/// A room without a ceiling under a lamp, with an object in it.
Scene room(int light, const std::function<int(Scene&)>& add_object) {
    Scene scene;
    scene.camera = look_at({0.0, -4.0, 2.0}, {0.0, 0.0, 0.4}, {0.0, 0.0, 1.0}, 40.0);
    const int grey = add_diffuse(scene, Spectrum::piecewise_linear({380.0, 780.0}, {0.3, 0.7}));
    add_horizontal_square(scene, 3.0, 0.0, true, grey);
    add_parallelogram(scene, {-3.0, 1.5, 0.0}, {6.0, 0.0, 0.0}, {0.0, 0.0, 3.0}, grey);
    if (const int object = add_object(scene); object >= 0)
        add_sphere(scene, 0.6, 2, true, object, {0.0, 0.0, 0.7});
    if (light == 0) {
        Light lamp;
        lamp.position = {1.0, -1.0, 3.0};
        scene.lights.push_back(lamp);
    } else if (light == 1) {
        scene.lights.push_back(environment(Spectrum::named("stdillum-D65")));
    } else {
        add_parallelogram(scene, {-0.5, -0.5, 3.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, grey,
                          add_area_light(scene, Spectrum::named("stdillum-D65"), 5.0));
    }
    return scene;
}

Scene plain_room(int light = 0) {
    return room(light, [](Scene&) { return -1; });
}
Scene glass_room(const Spectrum& eta, int light = 0) {
    return room(light, [&](Scene& scene) { return add_dielectric(scene, eta); });
}
Scene metal_room(double alpha, int light) {
    return room(light, [alpha](Scene& scene) {
        const int metal = add_conductor(scene, Spectrum::named("metal-Cu-eta"), Spectrum::named("metal-Cu-k"));
        scene.materials.back().alpha_u = scene.materials.back().alpha_v = alpha;
        return metal;
    });
}
const std::vector<FilmLayer> clear_film{{300.0, Spectrum::constant(1.4), Spectrum::constant(0.0)}};
Scene film_room(int light) {
    return room(light, [](Scene& scene) {
        return with_film(scene, add_dielectric(scene, Spectrum::constant(1.5)), clear_film);
    });
}

RenderOptions room_render(const std::string& method, const std::string& effects = "") {
    RenderOptions options = small_render(method, 24, 16, 16384, 0.4, 8);
    if (!effects.empty())
        options.more_effects = parse_effects(effects);
    return options;
}

std::vector<std::array<float, 3>> image_bits(const Scene& scene, const RenderOptions& options) {
    Renderer renderer(scene, options, test_device());
    renderer.render_pass(0);
    renderer.render_pass(1);
    const FilmImage film = renderer.film();
    EXPECT_EQ(film.rejected_samples, 0U);
    return film.xyz;
}

/// Of two images the largest difference of a value, in units of the larger of the two.
double largest_difference(const std::vector<std::array<float, 3>>& a, const std::vector<std::array<float, 3>>& b) {
    EXPECT_EQ(a.size(), b.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double size = std::max(std::abs(a[i][c]), std::abs(b[i][c]));
            if (a[i][c] != b[i][c])
                largest = std::max(largest, std::abs(double{a[i][c]} - b[i][c]) / size);
        }
    }
    return largest;
}

/// Everything that neither colours camera paths nor works out films otherwise.
constexpr const char* same_arithmetic =
    "dielectric,dispersion,shading-normals,thin-lens,uv,point-light,spot-light,distant-light,infinite-light,area-light";

TEST(Effects, UnneededOnesLeaveEveryBit) {
    if (!long_tests())
        GTEST_SKIP() << "TRISTIM_LONG_TESTS=1 runs it";
    const std::vector<std::pair<std::string, Scene>> scenes{
        {"point light", plain_room(0)}, {"infinite light", plain_room(1)},
        {"area light", plain_room(2)},  {"dispersion", glass_room(Spectrum::named("glass-BK7"), 2)},
        {"metal", metal_room(0.0, 0)},  {"rough metal", metal_room(0.3, 2)},
        {"film", film_room(1)}};
    for (const auto& [name, scene] : scenes)
        EXPECT_EQ(largest_difference(image_bits(scene, room_render("tristimulus:1")),
                                     image_bits(scene, room_render("tristimulus:1", same_arithmetic))),
                  0.0)
            << name;
}

/// With unneeded effects that colour camera paths, photons are added up wavelength by wavelength rather than in X, Y
/// and Z: the same terms, none negative, in another order. A sum of n of them is within n units of 2^-24 either way,
/// and the other factors of a pixel, the film's sums included, add less than 32 such roundings.
double largest_rounding(const Scene& scene, const RenderOptions& options) {
    Renderer renderer(scene, options, test_device());
    renderer.render_pass(0);
    float most = 0.0F;
    for (const cl_float4& flux : renderer.gathered_flux())
        most = std::max(most, flux.s[3]);
    EXPECT_GT(most, 10.0F) << "no photons to add up";
    return 2.0 * (2.0 * most + options.method.wavelengths() + 32.0) * 0x1p-24;
}

TEST(Effects, AllOfThemLeaveTheImageToRounding) {
    std::vector<std::pair<std::string, Scene>> scenes{{"point light", plain_room(0)}};
    if (long_tests()) {
        scenes.emplace_back("dispersion", glass_room(Spectrum::named("glass-BK7"), 2));
        scenes.emplace_back("infinite light", plain_room(1));
        scenes.emplace_back("glass", glass_room(Spectrum::constant(1.5), 1));
        scenes.emplace_back("metal", metal_room(0.0, 0));
        scenes.emplace_back("rough metal", metal_room(0.3, 2));
        scenes.emplace_back("nearly specular metal", metal_room(0.05, 2));
    }
    for (const auto& [name, scene] : scenes) {
        const RenderOptions options = room_render("tristimulus:1");
        EXPECT_LE(
            largest_difference(image_bits(scene, options), image_bits(scene, room_render("tristimulus:1", "all"))),
            largest_rounding(scene, options))
            << name;
    }
}

TEST(Effects, WithoutDispersionNoSlotIsPicked) {
    const auto slots = [](const Scene& scene, const std::string& effects) {
        Renderer renderer(scene, room_render("tristimulus:1", effects), test_device());
        renderer.render_pass(0);
        std::set<int> found;
        for (const Photon& photon : renderer.photons())
            found.insert(photon.slot);
        for (const VisiblePoint& point : renderer.visible_points())
            found.insert(point.slot);
        found.erase(SLOT_NONE);
        return found;
    };
    EXPECT_EQ(slots(glass_room(Spectrum::constant(1.5)), ""), std::set<int>{SLOT_ALL});
    if (long_tests()) {
        EXPECT_EQ(slots(glass_room(Spectrum::constant(1.5)), "dispersion"), std::set<int>{SLOT_ALL});
    }
    EXPECT_EQ(slots(glass_room(Spectrum::named("glass-BK7")), ""), (std::set<int>{SLOT_ALL, 0, 1, 2}));
}

std::uint64_t bytes_of(const Renderer& renderer, const std::string& buffer) {
    for (const auto& [name, bytes] : renderer.statistics().buffer_bytes) {
        if (name == buffer)
            return bytes;
    }
    ADD_FAILURE() << "no buffer " << buffer;
    return 0;
}

TEST(Effects, PhotonsHoldSpectraOnlyWhereCameraPathsDependOnTheWavelength) {
    struct Expected {
        Scene scene;
        bool spectra, coloured;
    };
    std::vector<Expected> all{{plain_room(), false, false},
                              {glass_room(Spectrum::constant(1.5)), false, false},
                              {glass_room(Spectrum::named("glass-BK7")), true, false}};
    if (long_tests())
        all.push_back({metal_room(0.0, 0), true, true});
    for (const Expected& expected : all) {
        const RenderOptions options = room_render("tristimulus:1");
        const Renderer renderer(expected.scene, options, test_device());
        EXPECT_EQ(bytes_of(renderer, "photon spectra") > 0, expected.spectra);
        EXPECT_EQ(bytes_of(renderer, "throughput spectra") > 0, expected.coloured);
        EXPECT_EQ(bytes_of(renderer, "photon surfaces"), 0U);
        EXPECT_EQ(bytes_of(renderer, "visible surfaces"), 0U);
        const ItemBytes bytes = item_bytes(renderer.effects(), wavelength_layout(options.method));
        EXPECT_EQ(static_cast<double>(bytes.pixel), renderer.statistics().bytes_per_pixel);
        EXPECT_EQ(static_cast<double>(bytes.photon), renderer.statistics().bytes_per_photon);
    }
}

TEST(Effects, ReflectancesAreNotTracedPerWavelength) {
    const auto rays = [](const std::string& method) {
        Renderer renderer(plain_room(), room_render(method), test_device());
        renderer.render_pass(0);
        return std::pair(renderer.rays(), renderer.statistics().bytes_per_photon);
    };
    const auto [few, few_bytes] = rays("tristimulus:1");
    const auto [many, many_bytes] = rays("spectral:400");
    EXPECT_EQ(few.camera, 24U * 16U); // one for each pixel: nothing lets it on
    EXPECT_EQ(many.camera, few.camera);
    EXPECT_EQ(many.shadow, few.shadow);
    EXPECT_LE(few.shadow, few.camera);
    EXPECT_EQ(many_bytes, few_bytes);
    // Photon paths survive by the share of their flux that is reflected, which depends on the wavelengths a little.
    EXPECT_NEAR(static_cast<double>(many.photon), static_cast<double>(few.photon),
                0.2 * static_cast<double>(few.photon));
}

TEST(Effects, RenderersOfOtherEffectsNeedAnotherDeviceScene) {
    const Scene scene = plain_room();
    const DeviceScene own(scene, room_render("tristimulus:1"), test_device());
    EXPECT_FALSE(own.effects().film);
    EXPECT_EQ(own.mismatch(room_render("tristimulus:1", "film"), test_device()), "choice of effects");
    const DeviceScene more(scene, room_render("tristimulus:1", "film"), test_device());
    EXPECT_TRUE(more.effects().film);
    EXPECT_EQ(more.mismatch(room_render("spectral:400", "film"), test_device()), "");
}

} // namespace
} // namespace tristim::test
