// Film stacks from text, ranges, illuminants, and the colours of films against integrals in double precision.
#include "films/film_colour.h"
#include "films/film_stack.h"
#include "films/illuminant.h"
#include "films/value_range.h"
#include "kernel_harness.h"
#include "scene_folder.h"

#include <cmath>
#include <functional>
#include <numbers>

namespace tristim::test {
namespace {

TEST(FilmStack, PartsInOrder) {
    const FilmStack stack = parse_film_stack("air|SiO2:300| 2.1,0.5 : 12.5 |Si");
    EXPECT_EQ(stack.outside.name, "air");
    ASSERT_EQ(stack.layers.size(), 2U);
    EXPECT_EQ(stack.layers[0].name, "SiO2");
    EXPECT_EQ(stack.layers[0].thickness, 300.0);
    EXPECT_EQ(stack.layers[0].index.eta(550.0), Spectrum::named("film-SiO2-eta")(550.0));
    EXPECT_EQ(stack.layers[1].thickness, 12.5);
    EXPECT_EQ(stack.layers[1].index.eta(500.0), 2.1);
    EXPECT_EQ(stack.layers[1].index.k(500.0), 0.5);
    EXPECT_EQ(stack.base.index.k(400.0), Spectrum::named("film-Si-k")(400.0));
    EXPECT_EQ(stack.description(), "air | SiO2 300 nm | 2.1,0.5 12.5 nm | Si");
    EXPECT_TRUE(has_absorbing_layer(stack, 380.0, 780.0));
}

TEST(FilmStack, NoLayersAndNoThickness) {
    EXPECT_TRUE(parse_film_stack("air|1.5").layers.empty());
    EXPECT_EQ(parse_film_stack("vacuum|1.38:0|1.52").layers.at(0).thickness, 0.0);
    // An absorbing base is no absorbing layer.
    EXPECT_FALSE(has_absorbing_layer(parse_film_stack("air|SiO2:300|Si"), 380.0, 780.0));
}

TEST(FilmStack, IndexFromFiles) {
    const SceneFolder folder;
    // A folder's name may hold a colon: the last one is the thickness's.
    const std::string eta = folder.write("a:1.spd", "300 1.5\n900 1.7\n"),
                      k = folder.write("k.spd", "300 0\n900 0.6\n");
    const FilmStack stack = parse_film_stack("air|" + eta + "," + k + ":40|" + eta);
    EXPECT_DOUBLE_EQ(stack.layers.at(0).index.eta(600.0), 1.6);
    EXPECT_DOUBLE_EQ(stack.layers.at(0).index.k(600.0), 0.3);
    EXPECT_DOUBLE_EQ(stack.base.index.eta(600.0), 1.6);
}

TEST(FilmStack, Coverage) {
    const SceneFolder folder;
    const std::string eta = folder.write("n.spd", "380 1.5\n800 1.5\n");
    const FilmStack stack = parse_film_stack("air|1.4,0.1:10|" + eta);
    EXPECT_NO_THROW(check_stack_covers(stack, 380.0, 800.0));
    EXPECT_NE(error_of([&] { check_stack_covers(stack, 379.0, 780.0); }).find("n.spd"), std::string::npos);
    EXPECT_NE(error_of([&] { check_stack_covers(stack, 380.0, 801.0); }).find("801"), std::string::npos);
    EXPECT_NO_THROW(check_stack_covers(parse_film_stack("air|1.4,0.1:10|1.5"), 1.0, 1e5)); // constants have no end
    const FilmStack negative = parse_film_stack("air|" + folder.write("m.spd", "380 1\n780 1\n800 -1\n"));
    EXPECT_NE(error_of([&] { check_stack_covers(negative, 380.0, 800.0); }).find("m.spd"), std::string::npos);
    const std::string absorbing = folder.write("k.spd", "380 0\n780 0\n800 1\n");
    EXPECT_NE(error_of([&] {
                  check_stack_covers(parse_film_stack("1.5," + absorbing + "|air"), 380.0, 800.0);
              }).find("absorbs"),
              std::string::npos);
}

TEST(ValueRange, Values) {
    EXPECT_EQ(parse_range("45", "angle"), (std::vector<double>{45.0}));
    EXPECT_EQ(parse_range("0:90:30", "angle"), (std::vector<double>{0.0, 30.0, 60.0, 90.0}));
    EXPECT_EQ(parse_range("0:10:4", "angle"), (std::vector<double>{0.0, 4.0, 8.0}));
    EXPECT_EQ(parse_range("5:5:1", "angle"), (std::vector<double>{5.0}));
    // 0.1 has no exact double, yet the last value belongs to the range, and is not passed.
    const std::vector<double> tenths = parse_range("0:1:0.1", "angle");
    ASSERT_EQ(tenths.size(), 11U);
    EXPECT_EQ(tenths.back(), 1.0);
    const std::vector<double> hundredths = parse_range("380:780:0.01", "wavelength");
    ASSERT_EQ(hundredths.size(), 40001U);
    EXPECT_LE(hundredths.back(), 780.0);
}

TEST(Illuminants, ShortNamesAndFiles) {
    EXPECT_EQ(find_illuminant("D65").name, "stdillum-D65");
    EXPECT_EQ(find_illuminant("stdillum-F12").name, "stdillum-F12");
    EXPECT_EQ(find_illuminant("mercury").name, "illum-mercury");
    const SceneFolder folder;
    EXPECT_EQ(find_illuminant(folder.write("lamp.spd", "500 1\n600 2\n")).spectrum(550.0), 1.5);
    EXPECT_NE(error_of([&] { find_illuminant(folder.write("bad.spd", "500 1\n600 -2\n")); }).find("negative"),
              std::string::npos);
    EXPECT_NE(error_of([&] { find_illuminant(folder.write("uv.spd", "200 1\n300 1\n")); }).find("dark"),
              std::string::npos);
    EXPECT_NE(error_of([] { find_illuminant("D64"); }).find("stdillum-D65"), std::string::npos);
    EXPECT_NE(error_of([] { find_illuminant("glass-BK7"); }).find("glass-BK7"), std::string::npos); // no light
}

TEST(DisplayColours, SrgbOfXyz) {
    const DisplayColour white = display_colour({0.9505, 1.0, 1.0890}); // D65, IEC 61966-2-1
    EXPECT_EQ(white.hex(), "#ffffff");
    EXPECT_FALSE(white.clipped);
    EXPECT_EQ(display_colour({0.0, 0.0, 0.0}).hex(), "#000000");
    EXPECT_TRUE(display_colour({1.2, 1.2, 1.2}).clipped);
    // The red primary, and a spectral green, which lies far outside.
    const DisplayColour red = display_colour({0.4124, 0.2126, 0.0193});
    EXPECT_EQ(red.rgb[0], 255);
    EXPECT_LE(red.rgb[1], 3); // the four digits above put green off by 1e-4 at most, 0.0003 · 12.92 · 255 = 1
    EXPECT_TRUE(display_colour({0.0633, 0.71, 0.0782}).clipped);
    EXPECT_FALSE(chromaticity({0.0, 0.0, 0.0}).has_value());
}

/// Airy's sum for light at normal incidence on a slab in air (Born & Wolf 1999, section 7.6.1, equations 9 and 15):
/// R = F sin²(δ/2) / (1 + F sin²(δ/2)), δ/2 = 2π n d/λ.
double slab_reflectance(double n, double thickness, double lambda) {
    const double r = std::pow((n - 1.0) / (n + 1.0), 2);
    const double f = 4.0 * r / ((1.0 - r) * (1.0 - r));
    const double s = std::pow(std::sin(2.0 * std::numbers::pi * n * thickness / lambda), 2);
    return f * s / (1.0 + f * s);
}

/// ∫ L R f dλ / ∫ L ȳ dλ in steps of 0.002 nm.
Xyz brute_force(const Spectrum& light, const std::function<double(double)>& reflectance) {
    const std::array<Spectrum, 3> matching{Spectrum::named("cie-x"), Spectrum::named("cie-y"),
                                           Spectrum::named("cie-z")};
    constexpr int steps = 200'000;
    Xyz sum{};
    double white = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double lambda = 380.0 + 400.0 * (i + 0.5) / steps;
        const double l = light(lambda), r = reflectance(lambda);
        for (std::size_t c = 0; c < 3; ++c)
            sum[c] += l * r * matching[c](lambda);
        white += l * matching[1](lambda);
    }
    return {sum[0] / white, sum[1] / white, sum[2] / white};
}

struct Slab {
    double n;
    double thickness;
    double tolerance; ///< 1e-5, to which colours settle, and what the kernels promise for a reflectance
};

TEST(FilmColours, AgreeWithIntegralsHoweverThickTheFilm) {
    const Spectrum light = Spectrum::named("stdillum-D65");
    for (const Slab& slab : {Slab{1.5, 0.0, 1.5e-5}, Slab{1.5, 250.0, 1.5e-5}, Slab{1.33, 1900.0, 1.5e-5},
                             Slab{1.5, 20'000.0, 1.1e-4}, Slab{4.0, 50'000.0, 1.1e-4}, Slab{1.5, 100'000.0, 1.1e-4}}) {
        SCOPED_TRACE(slab.thickness);
        const FilmStack stack = parse_film_stack(fmt::format("air|{}:{}|air", slab.n, slab.thickness));
        const FilmEvaluator evaluator(kernel_test::test_device(), stack, 380.0, 780.0, false);
        const FilmColour colour = FilmColours(evaluator, light).colour(0.0);
        const Xyz expected =
            brute_force(light, [&](double lambda) { return slab_reflectance(slab.n, slab.thickness, lambda); });
        const Xyz white = brute_force(light, [](double) { return 1.0; });
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(colour.reflected[c], expected[c], slab.tolerance);
            EXPECT_NEAR(colour.transmitted[c], white[c] - expected[c], slab.tolerance);
        }
    }
}

/// A resonator, whose peaks are much narrower than a quarter of their distance, so that four samples to a fringe miss
/// them.
TEST(FilmColours, SharpPeaksAreResolved) {
    const Spectrum light = Spectrum::named("stdillum-D65");
    const FilmStack stack = parse_film_stack("air|Ag:40|1.5:100000|Ag:40|air");
    const FilmEvaluator evaluator(kernel_test::test_device(), stack, 380.0, 780.0, false);
    std::vector<double> lambda;
    for (int i = 0; i < 200'000; ++i)
        lambda.push_back(380.0 + 400.0 * (i + 0.5) / 200'000);
    const std::vector<FilmResponse> responses = evaluator.evaluate(lambda, 0.0);
    const Xyz expected = brute_force(light, [&](double nm) {
        return responses[static_cast<std::size_t>((nm - 380.0) / 400.0 * 200'000)].transmitted();
    });
    const FilmColour colour = FilmColours(evaluator, light).colour(0.0);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(colour.transmitted[c], expected[c], 1e-5 + 1e-3 * expected[c]);
}

/// A lamp of one line, 0.02 nm wide, off the middle of its nanometre: the reflectance is the one at the line.
TEST(FilmColours, LinesKeepTheirPlace) {
    const Spectrum line = Spectrum::piecewise_linear({546.06, 546.07, 546.08}, {0.0, 1.0, 0.0});
    const FilmStack stack = parse_film_stack("air|2.2:20000|air");
    const FilmEvaluator evaluator(kernel_test::test_device(), stack, 380.0, 780.0, false);
    const double expected = slab_reflectance(2.2, 20'000.0, 546.07);
    ASSERT_GT(std::abs(expected - slab_reflectance(2.2, 20'000.0, 546.5)), 0.05);
    // Fringes are 3.4 nm apart, so that the reflectance bends by less than 1e-4 over the line.
    EXPECT_NEAR(FilmColours(evaluator, line).colour(0.0).reflected[1], expected, 2e-4);
}

TEST(FilmColours, ThicknessesOfAnyLayer) {
    const FilmEvaluator swept(kernel_test::test_device(), parse_film_stack("air|1.4:100|2.3:1|1.5"), 380.0, 780.0,
                              false);
    const Spectrum light = Spectrum::named("stdillum-F12");
    const std::vector<FilmColour> colours = FilmColours(swept, light).colours(30.0, 1, {50.0, 0.0, 900.0});
    ASSERT_EQ(colours.size(), 3U);
    const std::array<std::string, 3> stacks{"air|1.4:100|2.3:50|1.5", "air|1.4:100|1.5", "air|1.4:100|2.3:900|1.5"};
    for (std::size_t i = 0; i < 3; ++i) {
        const FilmEvaluator evaluator(kernel_test::test_device(), parse_film_stack(stacks[i]), 380.0, 780.0, false);
        const FilmColour expected = FilmColours(evaluator, light).colour(30.0);
        for (std::size_t c = 0; c < 3; ++c) // each settles within 1e-5
            EXPECT_NEAR(colours[i].reflected[c], expected.reflected[c], 2e-5);
    }
}

} // namespace
} // namespace tristim::test
