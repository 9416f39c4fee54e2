#include "kernel_harness.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>

namespace tristim::kernel_test {

Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vec3& a) {
    return std::sqrt(dot(a, a));
}
Vec3 normalized(const Vec3& a) {
    return (1.0 / length(a)) * a;
}

std::array<Vec3, 2> tangents(const Vec3& n) {
    const Vec3 other = std::abs(n[0]) < 0.5 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0};
    const Vec3 s = normalized(cross(other, n));
    return {s, cross(n, s)};
}

double turn(double x, double y) {
    const double fraction = std::atan2(y, x) / (2.0 * std::numbers::pi);
    return fraction < 0.0 ? fraction + 1.0 : fraction;
}

::cl::Program build_test_program(const std::string& text, const Macros& macros) {
    return build_program_from_text(test_device(), "test.cl", text, macros, {});
}

Vec3 Random::direction() {
    for (;;) {
        const Vec3 v{(*this)(-1.0, 1.0), (*this)(-1.0, 1.0), (*this)(-1.0, 1.0)};
        if (const double squared = dot(v, v); squared > 0.01 && squared <= 1.0)
            return normalized(v);
    }
}

std::vector<cl_float2> random_squares(std::size_t count, std::uint32_t seed) {
    Random random(seed);
    std::vector<cl_float2> squares(count);
    for (cl_float2& square : squares) {
        square.s[0] = random();
        square.s[1] = random();
    }
    return squares;
}

std::vector<cl_float4> random_hypercubes(std::size_t count, std::uint32_t seed) {
    Random random(seed);
    std::vector<cl_float4> cubes(count);
    for (cl_float4& cube : cubes) {
        for (float& coordinate : cube.s)
            coordinate = random();
    }
    return cubes;
}

double chi_squared_tail(double statistic, double degrees_of_freedom) {
    const double a = 0.5 * degrees_of_freedom;
    const double x = 0.5 * statistic;
    if (x <= 0.0)
        return 1.0;
    const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
    constexpr double precision = 1e-14;
    if (x < a + 1.0) { // 6.5.29: the series of 1 - Q
        double term = 1.0 / a;
        double sum = term;
        for (double n = a + 1.0; term > precision * sum; n += 1.0)
            sum += term *= x / n;
        return 1.0 - front * sum;
    }
    // 6.5.31: Q's continued fraction, from its 400th level inwards, far past convergence for the few hundred degrees of
    // freedom here.
    double fraction = 0.0;
    for (int level = 400; level >= 1; --level)
        fraction = level * (level - a) / (x + 2.0 * level + 1.0 - a - fraction);
    return front / (x + 1.0 - a - fraction);
}

double significance_of_one() {
    return 1.0 - std::pow(0.99, 1.0 / statistical_tests);
}

std::size_t Histogram::bin(double x, std::size_t bins) {
    const auto index = static_cast<std::ptrdiff_t>(std::floor(x * static_cast<double>(bins)));
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(index, 0, static_cast<std::ptrdiff_t>(bins) - 1));
}

void Histogram::expect_distribution(const std::string& what, const std::vector<double>& probabilities) const {
    ASSERT_EQ(probabilities.size(), counts_.size()) << what;
    const double samples = static_cast<double>(std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0}));
    const double total = std::accumulate(probabilities.begin(), probabilities.end(), 0.0);
    constexpr double fewest = 5.0;
    double statistic = 0.0;
    int cells = 0;
    double pooled_expected = 0.0;
    double pooled_count = 0.0;
    double worst = 0.0;
    std::size_t worst_bin = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        const double expected = samples * probabilities[i] / total;
        const auto count = static_cast<double>(counts_[i]);
        if (expected <= 0.0) {
            EXPECT_EQ(counts_[i], 0U) << what << ": bin " << i << " has samples but probability 0";
            continue;
        }
        if (expected < fewest) {
            pooled_expected += expected;
            pooled_count += count;
            continue;
        }
        const double term = (count - expected) * (count - expected) / expected;
        if (term > worst) {
            worst = term;
            worst_bin = i;
        }
        statistic += term;
        ++cells;
    }
    if (pooled_expected >= fewest) {
        statistic += (pooled_count - pooled_expected) * (pooled_count - pooled_expected) / pooled_expected;
        ++cells;
    } else if (pooled_expected > 0.0 || pooled_count > 0.0) {
        // Too little for a cell of its own; a Poisson count this high must still be believable.
        EXPECT_LT(pooled_count, 40.0) << what << ": samples in bins that expect " << pooled_expected << " together";
    }
    ASSERT_GT(cells, 1) << what << ": too few samples for a test";
    const double p = chi_squared_tail(statistic, cells - 1);
    EXPECT_GT(p, significance_of_one()) << what << ": χ² = " << statistic << " with " << cells - 1
                                        << " degrees of freedom, p = " << p << "; worst bin " << worst_bin << " of "
                                        << counts_.size() << " has " << counts_[worst_bin] << " samples where "
                                        << samples * probabilities[worst_bin] / total << " are expected";
}

void Histogram::expect_uniform(const std::string& what) const {
    expect_distribution(what, std::vector<double>(counts_.size(), 1.0));
}

void expect_mean(const std::string& what, double value, double expected, double standard_error, double rounding) {
    // The two-sided normal quantile by bisection of erfc.
    double low = 0.0, high = 40.0;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (std::erfc(middle / std::numbers::sqrt2) > significance_of_one() ? low : high) = middle;
    }
    EXPECT_LE(std::abs(value - expected), low * standard_error + rounding)
        << what << ": " << value << " where " << expected << " ± " << standard_error << " (one standard error) + "
        << rounding << " is expected";
}

void Moments::add(double value) {
    count_ += 1.0;
    const double from_old = value - mean_;
    mean_ += from_old / count_;
    squares_ += from_old * (value - mean_);
}

double Moments::standard_error() const {
    return std::sqrt(squares_ / (count_ * (count_ - 1.0)));
}

} // namespace tristim::kernel_test
