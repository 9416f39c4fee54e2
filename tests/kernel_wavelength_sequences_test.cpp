// The sequences and the inverse cumulative distributions of kernels/wavelengths.cl.

#include "discrepancy.h"
#include "kernel_harness.h"
#include "render/sampler_table.h"
#include "spectra/colour.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <set>

namespace tristim {
namespace {

using namespace kernel_test;

const char* const wavelength_sequences_source = R"(
#include "wavelengths.cl"
kernel void invert(const global float* cdf, const global float* u, global float* lambda) {
    float pdf;
    lambda[get_global_id(0)] = invert_cdf(cdf, (uint)(u[get_global_id(0)] * 0x1p32f), &pdf);
}
kernel void positions(uint seed, uint set, uint sets, global float* out) {
    out[get_global_id(0)] = unit_float(sample_position(seed, (uint)get_global_id(0), set, sets));
}
)";

constexpr const char* channel_names = "XYZ";

/// The cumulative distribution of a colour matching function's bins in double, at λ in nm.
double cumulative(std::size_t channel, double lambda) {
    const auto& bins = cie_bins()[channel];
    const double x = std::clamp(lambda - lambda_min_nm, 0.0, static_cast<double>(lambda_bins));
    const auto whole = static_cast<std::size_t>(x);
    double sum = 0.0, total = 0.0;
    for (std::size_t i = 0; i < bins.size(); ++i) {
        total += bins[i];
        sum += i < whole ? bins[i] : i == whole ? bins[i] * (x - static_cast<double>(whole)) : 0.0;
    }
    return sum / total;
}

std::vector<float> invert(std::size_t channel, const std::vector<float>& u) {
    const std::vector<float> table = sampler_table({Method::Kind::Tristimulus, 1}, {});
    const auto begin = table.begin() + static_cast<std::ptrdiff_t>(3 * lambda_bins + channel * 2 * (lambda_bins + 1));
    const Buffer<float> output = make_buffer<float>(u.size());
    run(build_test_program(wavelength_sequences_source), "invert", u.size(),
        upload(std::vector<float>(begin, begin + 2 * (lambda_bins + 1))), upload(u), output);
    return output.read(test_device());
}

TEST(KernelWavelengthSequences, InverseCdfInvertsTheCdf) {
    Random random(70);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::vector<float> u{0.0F, 0x1p-24F, 1e-6F, 0.5F, 1.0F - 1e-6F, 0x1.fffffcp-1F, 0x1.fffffep-1F};
        while (u.size() < 2000)
            u.push_back(random());
        std::sort(u.begin(), u.end());
        const std::vector<float> lambda = invert(channel, u);
        for (std::size_t i = 0; i < u.size(); ++i) {
            ASSERT_GE(lambda[i], 380.0F) << channel_names[channel] << ", u = " << u[i];
            ASSERT_LE(lambda[i], 780.0F) << channel_names[channel] << ", u = " << u[i];
            if (i > 0) {
                ASSERT_GE(lambda[i], lambda[i - 1])
                    << channel_names[channel] << ", u = " << u[i] << " must not go back";
            }
            // λ is rounded to 2^-15 nm or less, times the density per nm; table and u have steps of 2^-31.
            constexpr double highest_density = 0.03;
            constexpr double tolerance = 2.0 * 0x1p-31 + 2.0 * 0x1p-15 * highest_density;
            ASSERT_NEAR(cumulative(channel, lambda[i]), u[i], tolerance)
                << channel_names[channel] << ", λ = " << lambda[i];
        }
        EXPECT_LT(lambda.front(), 381.0F);
    }
}

TEST(KernelWavelengthSequences, InverseCdfFollowsTheColourMatchingFunctions) {
    Random random(71);
    std::vector<float> u(1 << 18);
    for (float& value : u)
        value = random();
    for (std::size_t channel = 0; channel < 3; ++channel) {
        Histogram histogram(2 * lambda_bins);
        for (const float lambda : invert(channel, u))
            histogram.add(Histogram::bin((lambda - lambda_min_nm) / lambda_bins, 2 * lambda_bins));
        std::vector<double> expected;
        for (const double bin : cie_bins()[channel])
            expected.insert(expected.end(), 2, bin); // even within a bin
        histogram.expect_distribution(fmt::format("wavelengths for {}", channel_names[channel]), expected);
    }
}

std::vector<float> positions(bool random_sequence, std::uint32_t seed, std::uint32_t set, std::uint32_t sets,
                             std::size_t passes) {
    const Buffer<float> output = make_buffer<float>(passes);
    run(build_test_program(wavelength_sequences_source, {{"SEQUENCE_RANDOM", random_sequence ? "1" : "0"}}),
        "positions", passes, seed, set, sets, output);
    return output.read(test_device());
}

TEST(KernelWavelengthSequences, RandomSequenceIsUniformAndItsSetsIndependent) {
    constexpr std::size_t passes = 1 << 16;
    for (const std::uint32_t seed : {0U, 9U}) {
        Histogram single(400), pair(400);
        const std::vector<float> first = positions(true, seed, 0, 2, passes),
                                 second = positions(true, seed, 1, 2, passes);
        for (std::size_t i = 0; i < passes; ++i) {
            single.add(Histogram::bin(first[i], 400));
            pair.add(Histogram::bin(first[i], 20) * 20 + Histogram::bin(second[i], 20));
        }
        single.expect_uniform("random positions over the passes");
        pair.expect_uniform("random positions of two sets");
    }
}

/// Direction numbers of the ninth dimension of Joe & Kuo 2008's new-joe-kuo-6: degree s = 5, a = 4, m = 1, 1, 5, 5, 5.
std::uint32_t ninth_sobol_point(std::uint32_t index) {
    std::array<std::uint32_t, 32> v{1U << 31, 1U << 30, 5U << 29, 5U << 28, 5U << 27};
    for (std::size_t k = 5; k < 32; ++k)
        v[k] = v[k - 5] ^ (v[k - 5] >> 5) ^ v[k - 2]; // of the coefficients a_1 … a_4 = 0, 1, 0, 0
    std::uint32_t x = 0;
    for (std::size_t bit = 0; bit < 32; ++bit)
        x ^= (index >> bit & 1U) != 0 ? v[bit] : 0U;
    return x;
}

TEST(KernelWavelengthSequences, StratifiedSequenceIsTheNinthOfSobolsWithADigitalShift) {
    std::set<std::uint32_t> shifts;
    for (const std::uint32_t seed : {0U, 9U, 0xffffffffU}) {
        const std::vector<float> p = positions(false, seed, 0, 1, 5000);
        const auto bits = [&](std::size_t pass) { return static_cast<std::uint32_t>(std::ldexp(p[pass], 24)); };
        for (std::uint32_t pass = 0; pass < p.size(); ++pass)
            ASSERT_EQ(bits(pass) ^ bits(0), ninth_sobol_point(pass) >> 8) << pass;
        shifts.insert(bits(0));
    }
    EXPECT_EQ(shifts.size(), 3U) << "of every seed its own";
}

/// The first n points of a (0,1)-sequence in base 2 consist of nets, one for each digit 1 of n, that have one point in
/// every interval of their resolution: n D* is at most the number of these digits (Niederreiter 1992, section 4.1).
TEST(KernelWavelengthSequences, StratifiedSequenceFillsEverySet) {
    for (const std::uint32_t seed : {0U, 9U}) {
        for (const std::uint32_t sets : {1U, 20U}) {
            for (const std::uint32_t set : {0U, sets - 1U}) {
                for (const std::size_t passes : {10U, 100U, 4096U}) {
                    std::vector<double> points;
                    for (const float position : positions(false, seed, set, sets, passes)) {
                        const double within = double{position} * sets - set;
                        // Cut off to 24 digits; in units of a set.
                        ASSERT_GE(within, -unit_roundoff * sets) << "set " << set << " of " << sets;
                        ASSERT_LT(within, 1.0) << "set " << set << " of " << sets;
                        ASSERT_LT(position, 1.0F);
                        points.push_back(within);
                    }
                    const double bound =
                        std::popcount(passes) / static_cast<double>(passes) + 4.0 * unit_roundoff * sets;
                    EXPECT_LE(test::star_discrepancy(points), bound)
                        << passes << " passes, set " << set << " of " << sets << ", seed " << seed;
                }
            }
        }
    }
}

} // namespace
} // namespace tristim
