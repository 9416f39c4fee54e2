// The named spectra against published numbers that are not those they were made from, and the names of materials.

#include "base/error.h"
#include "scene_folder.h"
#include "spectra/colour.h"
#include "spectra/complex_index.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <gtest/gtest.h>
#include <tuple>
#include <utility>
#include <vector>

namespace tristim {
namespace {

constexpr double line_g = 435.835, line_f = 486.1327, line_e = 546.074, line_d = 587.5618, line_sodium = 589.3,
                 line_c = 656.2725; // nm, in air

std::string error_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

double eta(const char* name, double lambda_nm) {
    return named_index(name).eta(lambda_nm);
}
double k(const char* name, double lambda_nm) {
    return named_index(name).k(lambda_nm);
}

/// Formulas are tabulated every 2 nm. Between two values a line is off by n″ h² / 8; n = a + b/λ² with b < 6200 nm²
/// (oil; the others have less) has n″ = 6 b/λ⁴ < 1.5e-6 nm⁻² beyond 400 nm.
constexpr double interpolation = 1e-6;

TEST(NamedIndex, SilicaHasTheIndicesThatMalitsonMeasured) {
    // Malitson 1965, table I, the observed values; his formula is within 1.1e-5 of them (mean residual 4e-6), and they
    // are printed to five decimals.
    const std::pair<double, double> observed[] = {{404.656, 1.46961}, {435.835, 1.46669}, {486.133, 1.46313},
                                                  {546.074, 1.46008}, {587.561, 1.45846}, {656.272, 1.45637},
                                                  {706.519, 1.45515}};
    for (const auto& [lambda, n] : observed)
        EXPECT_NEAR(eta("SiO2", lambda), n, 1.1e-5 + 5e-6 + interpolation) << lambda;
}

TEST(NamedIndex, CrystalsAgreeWithOtherMeasurements) {
    const auto sellmeier = [](double lambda_nm, double constant, const std::vector<std::array<double, 2>>& terms) {
        const double square = lambda_nm * lambda_nm * 1e-6;
        double sum = 1.0 + constant;
        for (const auto& [b, c] : terms)
            sum += b * square / (square - c * c);
        return std::sqrt(sum);
    };
    for (const double lambda : {400.0, line_g, line_f, line_d, 700.0, 780.0}) {
        // Li 1980, ordinary ray, from all measurements before Dodge's.
        const double li = sellmeier(lambda, 0.27620, {{0.60967, 0.08636}, {0.0080, 18.0}, {2.14973, 25.0}});
        EXPECT_NEAR(eta("MgF2", lambda), li, 5e-5) << lambda; // four decimals
        // Malitson 1962, another crystal, at 24 °C: four degrees at 1.3e-5 per degree, and four decimals.
        const double malitson =
            sellmeier(lambda, 0.0, {{1.023798, 0.06144821}, {1.058264, 0.1106997}, {5.280792, 17.92656}});
        EXPECT_NEAR(eta("sapphire", lambda), malitson, 4 * 1.3e-5 + 5e-5) << lambda;
    }
    // Gemmology: diamond has n_D = 2.417 and the dispersion n_G - n_B = 0.044 between Fraunhofer's lines.
    EXPECT_NEAR(eta("diamond", line_sodium), 2.417, 5e-4);
    EXPECT_NEAR(eta("diamond", 430.8) - eta("diamond", 686.7), 0.044, 5e-4);
}

TEST(NamedIndex, LiquidsHavePublishedIndices) {
    // Tilton & Taylor 1938 (NBS), 20 °C, relative to air, here times the index of air: 1.000272 (±1e-6 over the lines).
    // They are printed to six decimals; five are left for the two laboratories to agree in.
    for (const auto& [lambda, n] :
         {std::pair{line_f, 1.337123}, std::pair{line_sodium, 1.332988}, std::pair{line_c, 1.331151}})
        EXPECT_NEAR(eta("water", lambda), n * 1.000272, 1e-5 + interpolation) << lambda;
    // A soap film is water with a little soap; measured indices of such solutions are 1.333 to 1.338.
    EXPECT_GT(eta("soap", line_d), eta("water", line_d));
    EXPECT_LT(eta("soap", line_d), 1.338);
    // ISO 8036-1:1998: n_e = 1.5180, v_e = (n_e - 1) / (n_F' - n_C') = 44. The difference of two indices has an error
    // of 1e-6 each, out of 0.0118.
    EXPECT_NEAR(eta("oil", line_e), 1.5180, interpolation);
    EXPECT_NEAR((eta("oil", line_e) - 1.0) / (eta("oil", 479.9914) - eta("oil", 643.8469)), 44.0, 44.0 * 2e-6 / 0.0118);
}

TEST(NamedIndex, FilmsAgreeWithOtherFilms) {
    // Films of one substance differ by how dense they are: in the second decimal of n.
    // Jolivet et al., amorphous TiO2 by atomic layer deposition at 200 °C.
    for (const auto& [lambda, n] : {std::pair{449.22, 2.54837}, std::pair{551.04, 2.44841}, std::pair{649.13, 2.40450}})
        EXPECT_NEAR(eta("TiO2", lambda), n, 0.03) << lambda;
    // Clear beyond the band gap of 3.2 eV (388 nm), absorbing before it.
    EXPECT_GT(k("TiO2", 380.0), 1e-3);
    EXPECT_LT(k("TiO2", 430.0), 1e-3);
    // Rodríguez-de Marcos et al. 2016, Ta2O5 by electron-beam evaporation.
    for (const auto& [lambda, n] : {std::pair{450.075, 2.1610}, std::pair{552.658, 2.1149}, std::pair{653.756, 2.0906}})
        EXPECT_NEAR(eta("Ta2O5", lambda), n, 0.05) << lambda;
    // Zhukovsky et al. 2015, 20 nm of Al2O3 by atomic layer deposition; far below sapphire.
    EXPECT_NEAR(eta("Al2O3", 550.6), 1.6298, 0.06);
    EXPECT_LT(eta("Al2O3", 550.6), eta("sapphire", 550.6) - 0.05);
}

TEST(NamedIndex, SemiconductorsAgreeWithAspnesAndStudna) {
    // Aspnes & Studna 1983 at 2.0, 2.5 and 3.0 eV. Silicon's n of the two laboratories agrees to 1 %; where their k
    // differ, Green has the transmission measurements, as below.
    const double at[] = {619.921, 495.937, 413.281};
    const double silicon[] = {3.906, 4.320, 5.222};
    const double germanium[][2] = {{5.588, 0.933}, {4.340, 2.384}, {4.082, 2.145}};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(eta("Si", at[i]), silicon[i], 0.01 * silicon[i]) << at[i];
        EXPECT_NEAR(eta("Ge", at[i]), germanium[i][0], 0.05) << at[i];
        EXPECT_NEAR(k("Ge", at[i]), germanium[i][1], 0.05) << at[i];
    }
    // Green 2008: absorption coefficient 4πk/λ = 1.11e4 cm⁻¹ at 500 nm, to three digits.
    EXPECT_NEAR(4.0 * std::acos(-1.0) * k("Si", 500.0) / 500e-7, 1.11e4, 50.0);
}

TEST(NamedIndex, TitaniumIsJohnsonAndChristys) {
    // Johnson & Christy 1974, 2.01 and 2.26 eV: n and k with two decimals; wavelengths rounded to 1 nm shift them by
    // less than 0.003.
    EXPECT_NEAR(eta("Ti", 1239.842 / 2.01), 2.67, 5e-3);
    EXPECT_NEAR(k("Ti", 1239.842 / 2.01), 3.72, 5e-3);
    EXPECT_NEAR(eta("Ti", 1239.842 / 2.26), 2.54, 5e-3);
    EXPECT_NEAR(k("Ti", 1239.842 / 2.26), 3.43, 5e-3);
}

TEST(NamedIndex, ClearMaterialsHaveNormalDispersion) {
    for (const char* name :
         {"SiO2", "TiO2", "MgF2", "Al2O3", "sapphire", "Ta2O5", "water", "soap", "oil", "diamond", "Si", "BK7"}) {
        const Spectrum n = named_index(name).eta;
        for (int lambda = 381; lambda <= 780; ++lambda)
            EXPECT_LT(n(lambda), n(lambda - 1)) << name << " at " << lambda;
    }
}

TEST(NamedIndex, EveryMaterialIsAnIndexOverTheVisibleRange) {
    const std::vector<std::string> names = named_indices();
    for (const char* expected :
         {"SiO2",    "TiO2", "MgF2", "Al2O3", "sapphire", "Ta2O5", "Si",  "Ge",  "Ti",   "water", "soap",  "oil",
          "diamond", "Ag",   "Al",   "Au",    "Cu",       "CuZn",  "MgO", "BK7", "SF11", "air",   "vacuum"})
        EXPECT_TRUE(std::binary_search(names.begin(), names.end(), expected)) << expected;
    for (const std::string& name : names)
        EXPECT_NO_THROW(check_index(named_index(name), name)) << name;
}

TEST(NamedIndex, GoesByShortAndFullNames) {
    EXPECT_EQ(named_index("Ag").eta(550.0), Spectrum::named("metal-Ag-eta")(550.0));
    EXPECT_EQ(named_index("Ag").k(550.0), Spectrum::named("metal-Ag-k")(550.0));
    EXPECT_EQ(named_index("metal-Ag").k(550.0), Spectrum::named("metal-Ag-k")(550.0));
    EXPECT_EQ(named_index("BK7").eta(550.0), Spectrum::named("glass-BK7")(550.0));
    EXPECT_EQ(named_index("glass-BK7").k(550.0), 0.0);
    EXPECT_EQ(named_index("film-Si").k(550.0), Spectrum::named("film-Si-k")(550.0));
    // The film before the crystal of pbrt's name.
    EXPECT_EQ(named_index("TiO2").eta(550.0), Spectrum::named("film-TiO2-eta")(550.0));
    EXPECT_EQ(named_index("metal-TiO2").eta(550.0), Spectrum::named("metal-TiO2-eta")(550.0));
    // A table's own name is that table.
    EXPECT_EQ(named_index("metal-Ag-eta").eta(550.0), Spectrum::named("metal-Ag-eta")(550.0));
    EXPECT_EQ(named_index("metal-Ag-eta").k(550.0), 0.0);
    EXPECT_EQ(named_index("air").eta(550.0), 1.0);
    EXPECT_EQ(index_tables("Si"), (std::vector<std::string>{"film-Si-eta", "film-Si-k"}));
    EXPECT_EQ(index_tables("BK7"), (std::vector<std::string>{"glass-BK7"}));
    EXPECT_TRUE(index_tables("stdillum-D65").empty());
}

TEST(NamedIndex, ErrorsSayWhatIsMeant) {
    EXPECT_EQ(error_of([] { named_index("sio2"); }).find("unknown refractive index \"sio2\"; did you mean SiO2,"), 0U);
    EXPECT_EQ(error_of([] { named_index("stdillum-D65"); }), "the spectrum \"stdillum-D65\" is not a refractive index");
    EXPECT_EQ(error_of([] { named_index("metal-Ag-k"); }),
              "the spectrum \"metal-Ag-k\" is the imaginary part of a refractive index; the whole index is \"Ag\"");
    EXPECT_NE(error_of([] { named_index(""); }).find("unknown refractive index \"\""), std::string::npos);
}

TEST(ParseIndex, NumbersNamesAndFiles) {
    EXPECT_EQ(parse_index("1.38").eta(550.0), 1.38);
    EXPECT_EQ(parse_index("1.38").k(550.0), 0.0);
    EXPECT_EQ(parse_index("0.2,3.4").eta(550.0), 0.2);
    EXPECT_EQ(parse_index("0.2,3.4").k(550.0), 3.4);
    EXPECT_EQ(parse_index("Ag").k(550.0), Spectrum::named("metal-Ag-k")(550.0));
    const test::SceneFolder folder;
    const std::string n = folder.write("n.spd", "380 1.5\n780 1.4\n"),
                      absorption = folder.write("k.spd", "300 0 900 6\n");
    EXPECT_EQ(parse_index(n).eta(580.0), 1.45);
    EXPECT_EQ(parse_index(n).k(580.0), 0.0);
    EXPECT_EQ(parse_index(n + "," + absorption).k(600.0), 3.0);
    EXPECT_EQ(parse_index("1.5," + absorption).k(600.0), 3.0);
    EXPECT_EQ(parse_index("n.spd", [&](const std::string& name) { return folder.path(name); }).eta(580.0), 1.45);
}

TEST(ParseIndex, RefusesWhatIsNoIndex) {
    const test::SceneFolder folder;
    const std::string narrow = folder.write("narrow.spd", "400 1.5\n780 1.4\n");
    const std::string dips = folder.write("dips.spd", "380 1\n500 -0.5\n780 1\n");
    const std::pair<std::string, std::string> cases[] = {
        {"0", "n of the refractive index \"0\" must be positive and finite, not 0"},
        {"-1.5", "n of the refractive index \"-1.5\" must be positive and finite, not -1.5"},
        {"nan", "must be positive and finite, not nan"},
        {"inf", "must be positive and finite, not inf"},
        {"1.5,-0.1", "k of the refractive index \"1.5,-0.1\" must be finite and not negative, not -0.1"},
        {"1.5,nan", "must be finite and not negative, not nan"},
        {"1.5,inf", "must be finite and not negative, not inf"},
        {"1.5,", "k of the refractive index \"1.5,\" must be a number or a .spd file"},
        {",1", "unknown refractive index \",1\""},
        {"1,2,3", "must be a number or a .spd file"},
        {"1.5,Ag", "must be a number or a .spd file"},
        {"1.5x", "unknown refractive index \"1.5x\""},
        {narrow, "covers 400 to 780 nm, not the whole visible range from 380 to 780 nm"},
        {"1.5," + narrow, "k of the refractive index"},
        {dips, "must be positive and finite, not -0.5"},
        {"1.5," + dips, "must be finite and not negative, not -0.5"},
        {"absent.spd", "cannot read the spectrum file absent.spd"},
    };
    for (const auto& [text, words] : cases) {
        const std::string message = error_of([&] { parse_index(text); });
        EXPECT_NE(message.find(words), std::string::npos) << text << ": " << message;
    }
}

/// Chromaticity by sums over every fifth nanometre, as the CIE computes it.
std::array<double, 2> chromaticity(const Spectrum& light) {
    Xyz xyz{};
    const char* functions[] = {"cie-x", "cie-y", "cie-z"};
    for (std::size_t c = 0; c < 3; ++c) {
        for (int lambda = 380; lambda <= 780; lambda += 5)
            xyz[c] += light(lambda) * Spectrum::named(functions[c])(lambda);
    }
    const double sum = xyz[0] + xyz[1] + xyz[2];
    return {xyz[0] / sum, xyz[1] / sum};
}

TEST(NamedIlluminants, DischargeLampsAndLedsHaveTheChromaticityOfTheCie) {
    // CIE 15:2018, 2° observer, to four decimals; the last is NIST's clear mercury lamp as colour-science gives it.
    const std::tuple<const char*, double, double> published[] = {
        {"stdillum-HP1", 0.5330, 0.4150},     {"stdillum-HP2", 0.4778, 0.4158},
        {"stdillum-HP3", 0.4302, 0.4075},     {"stdillum-HP4", 0.3812, 0.3797},
        {"stdillum-HP5", 0.3776, 0.3713},     {"stdillum-LED-B1", 0.4560, 0.4078},
        {"stdillum-LED-B2", 0.4357, 0.4012},  {"stdillum-LED-B3", 0.3756, 0.3723},
        {"stdillum-LED-B4", 0.3422, 0.3502},  {"stdillum-LED-B5", 0.3118, 0.3236},
        {"stdillum-LED-BH1", 0.4474, 0.4066}, {"stdillum-LED-RGB1", 0.4557, 0.4211},
        {"stdillum-LED-V1", 0.4548, 0.4044},  {"stdillum-LED-V2", 0.3781, 0.3775},
        {"illum-mercury", 0.3112, 0.3829},
    };
    for (const auto& [name, x, y] : published) {
        const auto [found_x, found_y] = chromaticity(Spectrum::named(name));
        EXPECT_NEAR(found_x, x, 5.1e-5) << name;
        EXPECT_NEAR(found_y, y, 5.1e-5) << name;
    }
    for (const std::string& name : named_spectra()) {
        if (is_illuminant(name)) {
            EXPECT_NEAR(spectrum_to_xyz(Spectrum::named(name))[1], 1.0, 1e-12) << name;
            EXPECT_GE(Spectrum::named(name).minimum(lambda_min_nm, lambda_max_nm), 0.0) << name;
        }
    }
}

/// Power of a light between two wavelengths.
double power(const Spectrum& light, double from_nm, double to_nm) {
    return light.mean(from_nm, to_nm) * (to_nm - from_nm);
}

TEST(NamedIlluminants, LinesLieWhereAtomsEmit) {
    // Handbook wavelengths in air, to 0.01 nm: all the light is within that of them, and each line has some.
    const std::pair<const char*, std::vector<double>> lamps[] = {
        {"illum-mercury-lines", {404.66, 435.83, 546.07, 576.96, 579.07}}, {"illum-sodium-lines", {589.00, 589.59}}};
    for (const auto& [name, lines] : lamps) {
        const Spectrum light = Spectrum::named(name);
        const double all = power(light, lambda_min_nm, lambda_max_nm);
        double found = 0.0;
        for (const double line : lines) {
            const double here = power(light, line - 0.011, line + 0.011);
            EXPECT_GT(here, 0.05 * all) << name << ", " << line;
            found += here;
        }
        // 1e-9: the ends of a line 0.01 nm wide are known to 1e-13 nm.
        EXPECT_NEAR(found, all, 1e-9 * all) << name;
    }
    // The upper levels of the D lines have weights 2J + 1 = 4 and 2.
    const Spectrum sodium = Spectrum::named("illum-sodium-lines");
    EXPECT_NEAR(power(sodium, 588.9, 589.1) / power(sodium, 589.5, 589.7), 2.0, 1e-6);
}

TEST(NamedIlluminants, MercuryLinesHaveThePowerOfTheLampsBands) {
    // Both lamps have Y = 1, but one has a continuum too: one factor between them for all lines. A table's values have
    // ten and four decimals, of powers above 100.
    const Spectrum lines = Spectrum::named("illum-mercury-lines"), lamp = Spectrum::named("illum-mercury");
    const auto factor = [&](double from, double to) {
        const double continuum = 0.5 * (lamp(from) + lamp(to)) * (to - from);
        return power(lines, from, to) / (power(lamp, from, to) - continuum);
    };
    const double green = factor(535.0, 555.0);
    EXPECT_GT(green, 1.0);
    EXPECT_NEAR(factor(395.0, 415.0), green, 1e-6 * green);
    EXPECT_NEAR(factor(425.0, 445.0), green, 1e-6 * green);
    EXPECT_NEAR(factor(565.0, 590.0), green, 1e-6 * green);
}

} // namespace
} // namespace tristim
