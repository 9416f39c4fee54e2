// The Sobol' sequence: host/render/sobol.h and its scrambling in kernels/rng.h.

#include "kernel_harness.h"
#include "render/sobol.h"

#include <algorithm>
#include <array>
#include <bit>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace kernel_test;

const char* const source = R"(
#include "rng.h"
kernel void points(const global uint* table, uint first, const global uint* scrambles, global float* outputs) {
    const uint i = (uint)get_global_id(0);
    vstore8(sobol8(table, first + i, vload8(0, scrambles)), i, outputs);
}
kernel void points_at(const global uint* table, const global uint* indices, const global uint* scrambles, global float* outputs) {
    const uint i = (uint)get_global_id(0);
    vstore8(sobol8(table, indices[i], vload8(0, scrambles)), i, outputs);
}
// One point under many scramblings, as the passes take them.
kernel void scramblings(const global uint* table, uint index, global float* outputs) {
    const uint i = (uint)get_global_id(0);
    const uint8 scramble = (uint8)(pcg4d((uint4)(i, STREAM_EYE, 0u, 0u)), pcg4d((uint4)(i, STREAM_EYE, 1u, 0u)));
    vstore8(sobol8(table, index, scramble), i, outputs);
}
)";

struct KnownPoint {
    std::uint32_t number;
    std::array<std::uint32_t, 8> coordinates;
};

/// Points of scipy 1.17.1's scipy.stats.qmc.Sobol(8, scramble=False, bits=32), whose direction numbers are Joe & Kuo's
/// new-joe-kuo-6.21201, times 4096. scipy numbers its points in Gray code (Antonov & Saleev 1979): its k is our k ^ (k
/// >> 1).
constexpr std::array<KnownPoint, 17> known_points{{
    {1, {0x800, 0x800, 0x800, 0x800, 0x800, 0x800, 0x800, 0x800}},
    {2, {0xc00, 0x400, 0x400, 0x400, 0xc00, 0xc00, 0x400, 0xc00}},
    {3, {0x400, 0xc00, 0xc00, 0xc00, 0x400, 0x400, 0xc00, 0x400}},
    {4, {0x600, 0x600, 0xa00, 0xe00, 0x600, 0x200, 0x600, 0xe00}},
    {5, {0xe00, 0xe00, 0x200, 0x600, 0xe00, 0xa00, 0xe00, 0x600}},
    {6, {0xa00, 0x200, 0xe00, 0xa00, 0xa00, 0xe00, 0x200, 0x200}},
    {7, {0x200, 0xa00, 0x600, 0x200, 0x200, 0x600, 0xa00, 0xa00}},
    {8, {0x300, 0x500, 0xf00, 0x700, 0x900, 0x500, 0x700, 0xf00}},
    {12, {0x500, 0x300, 0x500, 0x900, 0xf00, 0x700, 0x100, 0x100}},
    {24, {0x280, 0x280, 0x880, 0xd80, 0xd80, 0xa80, 0xf80, 0x280}},
    {48, {0x140, 0x3c0, 0xcc0, 0x240, 0x6c0, 0x140, 0x440, 0x740}},
    {96, {0x0a0, 0x220, 0x660, 0x5a0, 0x820, 0x9e0, 0x660, 0x9a0}},
    {192, {0x050, 0x330, 0x990, 0xe70, 0x410, 0xdf0, 0x770, 0x090}},
    {384, {0x028, 0x2a8, 0xe68, 0x7a8, 0x208, 0xb68, 0x808, 0x648}},
    {768, {0x014, 0x3fc, 0x59c, 0xb64, 0xb2c, 0x8b4, 0xc0c, 0xb34}},
    {1536, {0x00a, 0x202, 0x86e, 0x816, 0xfbe, 0x48e, 0xa0a, 0x7ea}},
    {3072, {0x005, 0x303, 0xc95, 0xc39, 0xdf7, 0x647, 0xd0d, 0xfa5}},
}};

TEST(Sobol, DirectionNumbersGiveThePointsOfScipy) {
    for (int dimension = 0; dimension < sobol_dimensions; ++dimension) {
        const std::vector<std::uint32_t> v = sobol_direction_numbers(dimension);
        for (const KnownPoint& known : known_points) {
            const std::uint32_t index = known.number ^ (known.number >> 1);
            std::uint32_t x = 0;
            for (std::size_t bit = 0; bit < 32; ++bit) {
                if ((index >> bit & 1U) != 0)
                    x ^= v[bit];
            }
            EXPECT_EQ(x, known.coordinates[static_cast<std::size_t>(dimension)] << 20)
                << "dimension " << dimension << ", point " << known.number << " in scipy's order";
        }
    }
}

TEST(Sobol, TableHoldsTheBitReversedDirectionNumbers) {
    const std::vector<std::uint32_t> table = sobol_table();
    ASSERT_EQ(table.size(), 8U * 4U * 256U);
    Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const std::uint32_t index = random.bits();
        const std::size_t dimension = random.bits() % 8;
        const std::vector<std::uint32_t> v = sobol_direction_numbers(static_cast<int>(dimension));
        std::uint32_t expected = 0;
        std::uint32_t found = 0;
        for (std::size_t bit = 0; bit < 32; ++bit) {
            if ((index >> bit & 1U) != 0)
                expected ^= v[bit];
        }
        for (std::size_t byte = 0; byte < 4; ++byte)
            found ^= table[(byte * 256 + (index >> (8 * byte) & 255U)) * 8 + dimension];
        for (std::size_t bit = 0; bit < 32; ++bit)
            ASSERT_EQ(expected >> bit & 1U, found >> (31 - bit) & 1U)
                << "dimension " << dimension << ", index " << index;
    }
}

class ScrambledSobol : public ::testing::Test {
  protected:
    /// Eight coordinates of each point.
    std::vector<std::array<float, 8>> points(std::uint32_t first, std::uint32_t count,
                                             const std::vector<std::uint32_t>& scrambles) const {
        const Buffer<std::array<float, 8>> output = make_buffer<std::array<float, 8>>(count);
        run(program_, "points", count, table_, first, upload(scrambles), output);
        return output.read(test_device());
    }

    static std::vector<std::uint32_t> random_scrambles(Random& random) {
        std::vector<std::uint32_t> scrambles(8);
        for (std::uint32_t& scramble : scrambles)
            scramble = random.bits();
        return scrambles;
    }

    const ::cl::Program program_ = build_test_program(source);
    const Buffer<std::uint32_t> table_ = upload(sobol_table());
};

/// Nested scrambling (Owen 1995) sends two numbers that agree in their first n binary digits to two that agree in as
/// many, and to no more.
TEST_F(ScrambledSobol, KeepsHowManyDigitsTwoPointsShare) {
    Random random(6);
    std::vector<std::uint32_t> indices{0U, 1U, 0xffffffffU, 0xfffffffeU, 0x80000000U, 0U};
    while (indices.size() < 4000)
        indices.push_back(random.bits());
    const Buffer<std::array<float, 8>> output = make_buffer<std::array<float, 8>>(indices.size());
    run(program_, "points_at", indices.size(), table_, upload(indices), upload(random_scrambles(random)), output);
    const std::vector<std::array<float, 8>> scrambled = output.read(test_device());
    constexpr int digits = 24; // of a float below 1
    const auto shared = [=](std::uint32_t a, std::uint32_t b) { return std::min(std::countl_zero(a ^ b), digits); };
    for (int dimension = 0; dimension < sobol_dimensions; ++dimension) {
        const std::vector<std::uint32_t> v = sobol_direction_numbers(dimension);
        const auto d = static_cast<std::size_t>(dimension);
        for (std::size_t i = 0; i + 1 < indices.size(); i += 2) {
            std::uint32_t difference = 0; // of the two points, in binary
            for (std::size_t bit = 0; bit < 32; ++bit) {
                if (((indices[i] ^ indices[i + 1]) >> bit & 1U) != 0)
                    difference ^= v[bit];
            }
            const auto binary = [&](std::size_t point) {
                return static_cast<std::uint32_t>(scrambled[point][d] * 0x1p24F) << 8;
            };
            ASSERT_EQ(shared(binary(i), binary(i + 1)), shared(difference, 0U))
                << "dimension " << dimension << ", points " << indices[i] << " and " << indices[i + 1];
        }
    }
}

/// Every aligned run of 2^m points has one in each of the 2^m intervals, in every dimension and under every scrambling.
TEST_F(ScrambledSobol, IsStratifiedInEveryDimension) {
    Random random(3);
    for (const std::uint32_t count : {2U, 64U, 4096U}) {
        const std::uint32_t first = count * (random.bits() % 1000U);
        const auto coordinates = points(first, count, random_scrambles(random));
        for (std::size_t dimension = 0; dimension < 8; ++dimension) {
            std::vector<int> hits(count, 0);
            for (const auto& point : coordinates) {
                ASSERT_GE(point[dimension], 0.0F);
                ASSERT_LT(point[dimension], 1.0F);
                ++hits[static_cast<std::size_t>(point[dimension] * static_cast<float>(count))];
            }
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_EQ(hits[i], 1) << "dimension " << dimension << ", interval " << i << " of " << count
                                      << ", points from " << first;
            }
        }
    }
}

/// Dimensions 0 and 1 are a (0,2)-sequence (Sobol' 1967): of 2^m points from a multiple of 2^m on, each rectangle of
/// 2^-a by 2^-(m-a) holds one. Owen's scrambling keeps that.
TEST_F(ScrambledSobol, FirstTwoDimensionsAreANet) {
    Random random(4);
    for (const unsigned m : {1U, 4U, 8U, 12U}) {
        const std::uint32_t count = 1U << m;
        const std::uint32_t first = count * (random.bits() % 1000U);
        const auto coordinates = points(first, count, random_scrambles(random));
        for (unsigned a = 0; a <= m; ++a) {
            std::vector<int> hits(count, 0);
            for (std::size_t i = 0; i < count; ++i) {
                const auto column = static_cast<std::size_t>(coordinates[i][0] * static_cast<float>(1U << a));
                const auto row = static_cast<std::size_t>(coordinates[i][1] * static_cast<float>(1U << (m - a)));
                ++hits[(column << (m - a)) + row];
            }
            for (std::size_t i = 0; i < count; ++i)
                ASSERT_EQ(hits[i], 1) << "rectangle " << i << " of 2^-" << a << " by 2^-" << m - a << ", points from "
                                      << first;
        }
    }
}

TEST_F(ScrambledSobol, EachPointIsUniformOverScramblingsAndItsDimensionsIndependent) {
    constexpr std::size_t count = 1 << 16;
    constexpr std::size_t side = 16;
    for (const std::uint32_t index : {0U, 1U, 12345U, 0xffffffffU}) {
        const Buffer<float> output = make_buffer<float>(8 * count);
        run(program_, "scramblings", count, table_, index, output);
        const std::vector<float> values = output.read(test_device());
        for (std::size_t a = 0; a < 8; ++a) {
            Histogram single(256);
            for (std::size_t i = 0; i < count; ++i)
                single.add(Histogram::bin(values[8 * i + a], 256));
            single.expect_uniform(fmt::format("point {}, dimension {}", index, a));
            for (std::size_t b = a + 1; b < 8; ++b) {
                Histogram pair(side * side);
                for (std::size_t i = 0; i < count; ++i)
                    pair.add(Histogram::bin(values[8 * i + a], side) * side + Histogram::bin(values[8 * i + b], side));
                pair.expect_uniform(fmt::format("point {}, dimensions {} and {}", index, a, b));
            }
        }
    }
}

/// 2^14 points put 16 into each cell of a 32×32 grid in every pair of dimensions: (t,2)-nets with t <= 4 do, and Joe &
/// Kuo chose their numbers for low t in pairs. A wrong polynomial leaves gaps.
TEST_F(ScrambledSobol, PairsOfDimensionsFillTheSquare) {
    constexpr std::uint32_t count = 1 << 14;
    constexpr std::size_t side = 32;
    Random random(5);
    const auto coordinates = points(0, count, random_scrambles(random));
    for (std::size_t a = 0; a < 8; ++a) {
        for (std::size_t b = a + 1; b < 8; ++b) {
            std::vector<int> hits(side * side, 0);
            for (std::size_t i = 0; i < count; ++i)
                ++hits[Histogram::bin(coordinates[i][a], side) * side + Histogram::bin(coordinates[i][b], side)];
            for (std::size_t i = 0; i < hits.size(); ++i)
                ASSERT_EQ(hits[i], 16) << "dimensions " << a << " and " << b << ", cell " << i;
        }
    }
}

} // namespace
} // namespace tristim
