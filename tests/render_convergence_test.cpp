// How fast progressive photon mapping converges. With the photons of n passes, the radius schedule makes the variance
// fall as n^-α and the bias as n^(α-1) (Knaus & Zwicker 2011, equations 12 to 16): for α = 2/3 both errors fall as
// n^(-1/3).
#include "image_statistics.h"

#include <cmath>

namespace tristim::test {
namespace {

/// The slope of a line through log(value) over log(n) by least squares.
double log_slope(const std::vector<int>& n, const std::vector<double>& values) {
    const double count = static_cast<double>(n.size());
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (std::size_t i = 0; i < n.size(); ++i) {
        mean_x += std::log(n[i]) / count;
        mean_y += std::log(values[i]) / count;
    }
    double xy = 0.0;
    double xx = 0.0;
    for (std::size_t i = 0; i < n.size(); ++i) {
        xy += (std::log(n[i]) - mean_x) * (std::log(values[i]) - mean_y);
        xx += (std::log(n[i]) - mean_x) * (std::log(n[i]) - mean_x);
    }
    return xy / xx;
}

double rmse_of_y(const FilmImage& film, const TestImage& reference) {
    double sum = 0.0;
    for (std::size_t i = 0; i < film.xyz.size(); ++i) {
        const double error = film.xyz[i][1] - reference.xyz[i][1];
        sum += error * error;
    }
    return std::sqrt(sum / static_cast<double>(film.xyz.size()));
}

/// RMSE in Y after each of the given numbers of passes.
std::vector<double> errors_after(const Scene& scene, const RenderOptions& options, const std::vector<int>& passes,
                                 const TestImage& reference) {
    Renderer renderer(scene, options, test_device());
    std::vector<double> errors;
    for (int pass = 0; pass < passes.back(); ++pass) {
        renderer.render_pass(static_cast<std::uint32_t>(pass));
        if (std::find(passes.begin(), passes.end(), pass + 1) != passes.end())
            errors.push_back(rmse_of_y(renderer.film(), reference));
    }
    return errors;
}

/// The slope of repeated renders, with 99.9 % confidence (Student's t, 24 runs), is at least as steep as the theory's,
/// which takes photons as independent while ours are stratified, and not as steep as -1/2, which a radius that stays
/// would give.
void expect_slope(const std::string& name, const std::vector<double>& slopes, double expected) {
    ASSERT_EQ(slopes.size(), 24U);
    constexpr double student_t = 3.485; // 23 degrees of freedom, one-sided 0.001
    const Estimate e = estimate(slopes);
    const double margin = student_t * std::sqrt(e.squared_error);
    testing::Test::RecordProperty(
        name, fmt::format("{:.4f} +- {:.4f}, expected {:.4f}", e.mean, std::sqrt(e.squared_error), expected));
    EXPECT_LE(e.mean - margin, expected) << name << ": slope " << e.mean << " ± " << margin;
    EXPECT_GT(e.mean - margin, -0.5) << name << ": slope " << e.mean << " ± " << margin;
    EXPECT_LT(margin, 0.07) << name << ": too few runs to tell the slope";
}

/// Radii of a pixel over the passes, relative to the first: of the schedule, or as photon statistics make them on
/// average where m photons lie within the first radius (Hachisuka et al. 2008, equations 7 to 10).
std::vector<double> squared_radii(int passes, bool statistics, double photons_at_first) {
    constexpr double alpha = 2.0 / 3.0;
    std::vector<double> squared{1.0};
    double counted = 0.0;
    for (int i = 1; i < passes; ++i) {
        const double last = squared.back();
        const double found = photons_at_first * last;
        squared.push_back(statistics ? last * (counted + alpha * found) / (counted + found)
                                     : last * (i + alpha) / (i + 1.0));
        counted += alpha * found;
    }
    return squared;
}

class Convergence : public testing::TestWithParam<bool> {};

/// In the furnace photons are spread evenly: no bias, radiance 1, and a variance ∝ Σ 1/r_i² / n². By photons alone.
TEST_P(Convergence, VarianceFollowsTheRadii) {
    const bool statistics = GetParam();
    constexpr int side = 12;
    const std::vector<int> passes{4, 8, 16, 32, 64};
    Scene scene;
    scene.path = "furnace";
    scene.camera = look_at({0, 0, 0}, {1, 0.1, 0.05}, {0, 0, 1}, 55.0);
    add_box(scene, {-1, -1, -1}, {1, 1, 1}, true, add_diffuse(scene, Spectrum::constant(0.5)),
            add_area_light(scene, Spectrum::constant(1.0), 0.5));
    RenderOptions options = small_render("tristimulus:1", side, side, 2048, 0.2, 64);
    options.direct_photons = true;
    options.statistics_radius = statistics;
    const TestImage one{side, side, std::vector<Xyz>(side * side, Xyz{1.0, 1.0, 1.0})};

    // Every path stores 1 + 1/2 + 1/4 + … = 2 photons, spread over six walls of area 4.
    const double photons_at_first = 2.0 * 2048 / 24.0 * 3.14159265 * 0.2 * 0.2;
    const std::vector<double> squared = squared_radii(passes.back(), statistics, photons_at_first);
    std::vector<double> expected;
    for (const int n : passes) {
        double sum = 0.0;
        for (int i = 0; i < n; ++i)
            sum += 1.0 / squared[static_cast<std::size_t>(i)];
        expected.push_back(std::sqrt(sum) / n);
    }
    std::vector<double> slopes;
    for (std::uint32_t seed = 1; seed <= 24; ++seed) {
        options.seed = seed;
        slopes.push_back(log_slope(passes, errors_after(scene, options, passes, one)));
    }
    expect_slope(statistics ? "statistics" : "global", slopes, log_slope(passes, expected));
}

INSTANTIATE_TEST_SUITE_P(Radius, Convergence, testing::Values(false, true),
                         [](const testing::TestParamInfo<bool>& radius) {
                             return std::string(radius.param ? "statistics" : "global");
                         });

} // namespace
} // namespace tristim::test
