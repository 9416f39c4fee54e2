#include "base/error.h"
#include "spectra/spectrum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace tristim::spectra_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The message of the Error that a call throws.
std::string error_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

/// A .spd file with a given text, removed with the object.
class SpdFile {
  public:
    explicit SpdFile(const std::string& text)
        : path_(testing::TempDir() + "spectra_test_" + testing::UnitTest::GetInstance()->current_test_info()->name() +
                ".spd") {
        std::ofstream(path_, std::ios::binary) << text;
    }
    SpdFile(const SpdFile&) = delete;
    SpdFile& operator=(const SpdFile&) = delete;
    ~SpdFile() { std::remove(path_.c_str()); }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
};

std::string error_of_spd(const std::string& text) {
    const SpdFile file(text);
    const std::string message = error_of([&] { Spectrum::read_spd(file.path()); });
    // What follows the file's name: ":line: reason".
    return message.starts_with(file.path()) ? message.substr(file.path().size()) : message;
}

TEST(Spectrum, ConstantIsTheSameEverywhere) {
    const Spectrum spectrum = Spectrum::constant(0.75);
    EXPECT_EQ(spectrum(100.0), 0.75);
    EXPECT_EQ(spectrum.mean(380.0, 780.0), 0.75);
    EXPECT_EQ(spectrum.bins()[399], 0.75);
    EXPECT_EQ(spectrum.range_nm()[0], lambda_min_nm);
    EXPECT_EQ(spectrum.range_nm()[1], lambda_max_nm);
    EXPECT_TRUE(spectrum.is_constant());
    EXPECT_EQ(Spectrum()(500.0), 0.0);
}

TEST(Spectrum, InterpolatesBetweenSamplesAndIsZeroOutside) {
    const Spectrum spectrum = Spectrum::piecewise_linear({400.0, 500.0, 600.0}, {1.0, 3.0, 2.0});
    EXPECT_EQ(spectrum(400.0), 1.0);
    EXPECT_EQ(spectrum(450.0), 2.0);
    EXPECT_EQ(spectrum(500.0), 3.0);
    EXPECT_EQ(spectrum(575.0), 2.25);
    EXPECT_EQ(spectrum(600.0), 2.0);
    EXPECT_EQ(spectrum(399.999), 0.0);
    EXPECT_EQ(spectrum(600.001), 0.0);
    EXPECT_EQ(spectrum.range_nm()[0], 400.0);
    EXPECT_EQ(spectrum.range_nm()[1], 600.0);
    EXPECT_EQ(spectrum.scaled(2.0).scaled(3.0)(450.0), 12.0);
}

TEST(Spectrum, MeanIsTheExactIntegral) {
    // Areas of the trapezoids by hand: 400–500 nm: 200, 500–600 nm: 250.
    const Spectrum spectrum = Spectrum::piecewise_linear({400.0, 500.0, 600.0}, {1.0, 3.0, 2.0});
    EXPECT_DOUBLE_EQ(spectrum.mean(400.0, 600.0), 450.0 / 200.0);
    EXPECT_DOUBLE_EQ(spectrum.mean(300.0, 700.0), 450.0 / 400.0);
    EXPECT_DOUBLE_EQ(spectrum.mean(450.0, 550.0), (0.5 * (2.0 + 3.0) + 0.5 * (3.0 + 2.5)) * 50.0 / 100.0);
    EXPECT_DOUBLE_EQ(spectrum.mean(350.0, 450.0), 0.5 * (1.0 + 2.0) * 50.0 / 100.0);
    EXPECT_EQ(spectrum.mean(601.0, 700.0), 0.0);
    EXPECT_EQ(spectrum.mean(450.0, 450.0), 2.0);
}

TEST(Spectrum, BinsTogetherHoldTheIntegral) {
    // Knots inside bins, one of them a discontinuity at the table's end.
    const Spectrum spectrum =
        Spectrum::piecewise_linear({370.0, 401.3, 401.9, 555.25, 700.7}, {0.2, 5.0, 0.1, 2.5, 4.0});
    double sum = 0.0;
    for (const double bin : spectrum.bins())
        sum += bin;
    // 400 sums of a few terms each: 1e-12 is a thousand rounding errors.
    EXPECT_NEAR(sum, spectrum.mean(lambda_min_nm, lambda_max_nm) * lambda_bins, 1e-12 * sum);
}

TEST(Spectrum, NarrowLineKeepsItsEnergy) {
    // A triangle of half width 0.1 nm and height 30 inside one bin has area 3.
    const Spectrum line = Spectrum::piecewise_linear({545.9, 546.0, 546.1}, {0.0, 30.0, 0.0});
    const auto bins = line.bins();
    EXPECT_NEAR(bins[165] + bins[166], 3.0, 1e-12);
    EXPECT_NEAR(bins[165], bins[166], 1e-12);
    EXPECT_EQ(bins[164], 0.0);
    EXPECT_EQ(bins[167], 0.0);
    const Spectrum off_centre = Spectrum::piecewise_linear({435.3, 435.4, 435.5}, {0.0, 30.0, 0.0});
    EXPECT_NEAR(off_centre.bins()[55], 3.0, 1e-12);
}

TEST(Spectrum, KnowsWhetherItIsConstant) {
    EXPECT_TRUE(Spectrum::piecewise_linear({300.0, 900.0}, {0.5, 0.5}).is_constant());
    EXPECT_TRUE(Spectrum::piecewise_linear({300.0, 380.0, 780.0, 900.0}, {0.1, 0.5, 0.5, 0.9}).is_constant());
    EXPECT_TRUE(Spectrum::piecewise_linear({800.0, 900.0}, {0.5, 0.5}).is_constant()); // 0 in the visible range
    EXPECT_FALSE(Spectrum::piecewise_linear({400.0, 700.0}, {0.5, 0.5}).is_constant());
    EXPECT_FALSE(Spectrum::piecewise_linear({380.0, 550.0, 780.0}, {0.5, 0.5000001, 0.5}).is_constant());
    EXPECT_FALSE(Spectrum::piecewise_linear({380.0, 550.0, 780.0}, {0.0, 1.0, 0.0}).is_constant());
    EXPECT_FALSE(Spectrum::piecewise_linear({300.0, 900.0}, {0.5, 0.6}).is_constant());
    EXPECT_FALSE(Spectrum::named("glass-BK7").is_constant());
}

TEST(Spectrum, MinimumCountsKnotsAndEnds) {
    const Spectrum spectrum = Spectrum::piecewise_linear({400.0, 500.0, 600.0}, {3.0, 1.0, 2.0}).scaled(2.0);
    EXPECT_EQ(spectrum.minimum(400.0, 600.0), 2.0);
    EXPECT_EQ(spectrum.minimum(550.0, 600.0), 3.0);
    EXPECT_EQ(spectrum.minimum(400.0, 450.0), 4.0);
    EXPECT_EQ(spectrum.minimum(390.0, 450.0), 0.0); // 0 where it is not given
    EXPECT_EQ(Spectrum::constant(-1.5).minimum(400.0, 500.0), -1.5);
}

TEST(Spectrum, RefusesBadSamples) {
    EXPECT_EQ(error_of([] {
                  Spectrum::piecewise_linear({400.0, 500.0}, {1.0});
              }),
              "a spectrum has 2 wavelengths but 1 values");
    EXPECT_EQ(error_of([] { Spectrum::piecewise_linear({}, {}); }), "a spectrum has no samples");
    EXPECT_EQ(error_of([] {
                  Spectrum::piecewise_linear({400.0, 500.0}, {1.0, nan});
              }),
              "sample 2 of a spectrum, nan at 500 nm, is not finite");
    EXPECT_EQ(error_of([] {
                  Spectrum::piecewise_linear({400.0, infinity}, {1.0, 1.0});
              }),
              "sample 2 of a spectrum, 1 at inf nm, is not finite");
    EXPECT_EQ(error_of([] {
                  Spectrum::piecewise_linear({400.0, 400.0}, {1.0, 1.0});
              }),
              "the wavelengths of a spectrum do not ascend: 400 nm follows 400 nm");
}

TEST(Spectrum, BlackbodyFollowsPlanckAndWien) {
    // 5000 K has its maximum, 1, at b / T = 2.897771955e6 nm K / 5000 K = 579.55 nm (CODATA 2018). The curve is flat
    // there: half a nanometre beside it Planck's law is lower by (x²/2)(0.5/579.55)² < 1e-5.
    const Spectrum spectrum = Spectrum::blackbody(5000.0);
    EXPECT_NEAR(spectrum(579.554391), 1.0, 1e-5);
    EXPECT_LE(spectrum.mean(579.0, 580.0), 1.0);
    EXPECT_GT(spectrum(579.554391), spectrum(560.0));
    EXPECT_GT(spectrum(579.554391), spectrum(600.0));
    // The ratio of two wavelengths from h, c and k (SI 2019) themselves.
    const auto planck = [](double lambda_nm, double kelvin) {
        const double lambda = lambda_nm * 1e-9;
        const double h = 6.62607015e-34, c = 299792458.0, k = 1.380649e-23;
        return 2.0 * h * c * c / std::pow(lambda, 5) / std::expm1(h * c / (lambda * k * kelvin));
    };
    for (const double kelvin : {1000.0, 2856.0, 6500.0, 20000.0}) {
        const Spectrum at = Spectrum::blackbody(kelvin);
        const double expected = planck(400.0, kelvin) / planck(700.0, kelvin);
        EXPECT_NEAR(at(400.0) / at(700.0), expected, 1e-8 * expected) << kelvin;
    }
    EXPECT_EQ(Spectrum::blackbody(1.0)(500.0), 0.0); // exp(28776) is beyond double: no NaN
    for (const double bad : {0.0, -1.0, nan, infinity})
        EXPECT_NE(error_of([&] { Spectrum::blackbody(bad); }).find("must be positive and finite"), std::string::npos);
}

TEST(SpdFile, ReadsPairsAndComments) {
    const SpdFile file("# head\r\n400 1 # one\n\n\t500 +3e0 600\n2.5e-1\n");
    const Spectrum spectrum = Spectrum::read_spd(file.path());
    EXPECT_EQ(spectrum(450.0), 2.0);
    EXPECT_EQ(spectrum(600.0), 0.25);
}

TEST(SpdFile, ErrorsNameFileAndLine) {
    EXPECT_EQ(error_of_spd("400 1\n500 red\n"), ":2: \"red\" is not a finite number");
    EXPECT_EQ(error_of_spd("400 1\n500 1,5\n"), ":2: \"1,5\" is not a finite number");
    EXPECT_EQ(error_of_spd("400 nan\n"), ":1: \"nan\" is not a finite number");
    EXPECT_EQ(error_of_spd("400 1\n500 1e999\n"), ":2: \"1e999\" is not a finite number");
    EXPECT_EQ(error_of_spd("# head\n400 1\n\n500\n\n"), ":4: the wavelength 500 nm has no value");
    EXPECT_EQ(error_of_spd("400 1\n500 1\n450 1\n"), ":3: the wavelengths do not ascend: 450 nm follows 500 nm");
    EXPECT_EQ(error_of_spd("# nothing\n"), ":1: the file holds no samples");
    EXPECT_EQ(error_of_spd(""), ":1: the file holds no samples");
    EXPECT_EQ(error_of([] { Spectrum::read_spd("/nonexistent/a.spd"); }),
              "cannot read the spectrum file /nonexistent/a.spd: No such file or directory");
    EXPECT_EQ(error_of([] { Spectrum::read_spd("/"); }), "cannot read the spectrum file /: Is a directory");
}

TEST(NamedSpectra, HoldAllThatPbrtNames) {
    std::vector<std::string> expected{"stdillum-A",  "stdillum-D50", "stdillum-D65", "illum-acesD60", "glass-BK7",
                                      "glass-BAF10", "glass-FK51A",  "glass-LASF9",  "glass-F5",      "glass-F10",
                                      "glass-F11",   "cie-x",        "cie-y",        "cie-z"};
    for (int i = 1; i <= 12; ++i)
        expected.push_back(fmt::format("stdillum-F{}", i));
    for (const char* metal : {"Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"}) {
        expected.push_back(fmt::format("metal-{}-eta", metal));
        expected.push_back(fmt::format("metal-{}-k", metal));
    }
    const std::vector<std::string> names = named_spectra();
    EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
    for (const std::string& name : expected)
        EXPECT_TRUE(std::binary_search(names.begin(), names.end(), name)) << name;
    for (const std::string& name : names) {
        const auto range = Spectrum::named(name).range_nm();
        EXPECT_LE(range[0], lambda_min_nm) << name;
        EXPECT_GE(range[1], lambda_max_nm) << name;
    }
}

TEST(NamedSpectra, UnknownNameIsAnErrorWithNearMatches) {
    EXPECT_EQ(error_of([] {
                  Spectrum::named("glas-bk7");
              }).rfind("unknown spectrum \"glas-bk7\"; did you mean glass-BK7,", 0),
              0U);
    EXPECT_NE(error_of([] { Spectrum::named("SF11"); }).find("did you mean glass-SF11"), std::string::npos);
    EXPECT_NE(error_of([] { Spectrum::named(""); }).find("unknown spectrum \"\""), std::string::npos);
}

TEST(NamedSpectra, GlassesHaveSchottsIndexAtTheDLine) {
    // n_d of the SCHOTT data sheets. Tables every 2 nm: linear interpolation is within n″ h² / 8 < 1e-6 at this line.
    const std::pair<const char*, double> glasses[] = {
        {"glass-BK7", 1.51680},  {"glass-BAF10", 1.67003}, {"glass-FK51A", 1.48656}, {"glass-LASF9", 1.85025},
        {"glass-F5", 1.67271},   {"glass-F10", 1.72828},   {"glass-F11", 1.78472},   {"glass-SF5", 1.67270},
        {"glass-SF10", 1.72825}, {"glass-SF11", 1.78472},
    };
    for (const auto& [name, n_d] : glasses)
        EXPECT_NEAR(Spectrum::named(name)(587.5618), n_d, 1e-5) << name;
}

TEST(NamedSpectra, GlassesDisperseAsSchottPublishes) {
    // Abbe numbers V_d = (n_d − 1) / (n_F − n_C) of the SCHOTT catalogue, given to 0.01; an error of 1e-6 in each index
    // changes them by less than 0.01 / 2 + V_d · 1.5e-6 / (n_F − n_C) ≈ 0.02.
    const std::pair<const char*, double> glasses[] = {{"glass-BK7", 64.17},
                                                      {"glass-LASF9", 32.17},
                                                      {"glass-F11", 25.68},
                                                      {"glass-SF11", 25.76},
                                                      {"glass-F10", 28.53}};
    for (const auto& [name, abbe] : glasses) {
        const Spectrum n = Spectrum::named(name);
        EXPECT_NEAR((n(587.5618) - 1.0) / (n(486.1327) - n(656.2725)), abbe, 0.02) << name;
    }
}

TEST(NamedSpectra, MetalsHavePublishedIndices) {
    // Handbook of Optical Constants of Solids (Palik 1985) at the photon energy 2.0 eV, to the digits printed there.
    const double lambda = 1239.84198 / 2.0;
    const std::tuple<const char*, double, double> handbook[] = {
        {"Ag", 0.131, 3.88}, {"Al", 1.30, 7.48}, {"Au", 0.194, 3.06}, {"Cu", 0.272, 3.24}};
    for (const auto& [metal, n, k] : handbook) {
        EXPECT_NEAR(Spectrum::named(fmt::format("metal-{}-eta", metal))(lambda), n, 5e-4) << metal;
        EXPECT_NEAR(Spectrum::named(fmt::format("metal-{}-k", metal))(lambda), k, 5e-3) << metal;
    }
    // Querry 1985 at 550 nm.
    EXPECT_NEAR(Spectrum::named("metal-CuZn-eta")(550.0), 0.527, 5e-4);
    EXPECT_NEAR(Spectrum::named("metal-CuZn-k")(550.0), 2.765, 5e-4);
    // Stephens & Malitson 1952, their dispersion formula at the sodium line; the table has five decimals.
    const double square = 0.5893 * 0.5893;
    const double mgo =
        std::sqrt(2.956362 + 0.02195770 / (square - 0.01428322) - 0.01062387 * square - 0.0000204968 * square * square);
    EXPECT_NEAR(Spectrum::named("metal-MgO-eta")(589.3), mgo, 1e-4);
    // Devore 1951, rutile, extraordinary ray; the table has two decimals.
    EXPECT_NEAR(Spectrum::named("metal-TiO2-eta")(589.3), std::sqrt(7.197 + 0.3322 / (square - 0.0843)), 0.01);
    EXPECT_EQ(Spectrum::named("metal-TiO2-k")(589.3), 0.0);
}

} // namespace
} // namespace tristim::spectra_test
