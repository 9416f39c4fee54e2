// What tells the noise of passes that are stratified against each other: their groups, sums over blocks of them, and
// the variance of a mean by the covariances that scrambled sequences have.
#include "error_groups.h"
#include "render/error_contrasts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <set>

namespace tristim::test {
namespace {

TEST(ErrorGroups, NeighbouringBatchesAreInNeighbouringGroups) {
    for (int level = 0; level < ERROR_LEVELS; ++level) {
        const std::uint32_t size = 2U << (2 * level);
        std::set<std::uint32_t> first;
        for (std::uint32_t eight = 0; eight < 80; ++eight) {
            const std::uint32_t begin = ERROR_GROUPS * eight, turn = group_at(begin * size, level);
            for (std::uint32_t batch = 0; batch < ERROR_GROUPS; ++batch) {
                EXPECT_EQ(group_at((begin + batch) * size, level), batch ^ turn);
                EXPECT_EQ(group_at((begin + batch + 1) * size - 1, level), batch ^ turn);
            }
            first.insert(turn);
        }
        // All 80 turns without one of the eight: one chance in 8 (7/8)^80, 1 in 5,400.
        EXPECT_EQ(first.size(), static_cast<std::size_t>(ERROR_GROUPS)) << "the order does not turn";
    }
}

/// Sums over blocks of 2^h passes, squared and added up.
BlockSquares slow_squares(const std::map<std::uint32_t, double>& factors) {
    BlockSquares squares{};
    for (std::size_t h = 0; h < block_sizes; ++h) {
        std::map<std::uint64_t, double> sums;
        for (const auto& [pass, factor] : factors)
            sums[std::uint64_t{pass} >> h] += factor;
        for (const auto& [block, sum] : sums)
            squares[h] += sum * sum;
    }
    return squares;
}

std::vector<std::uint32_t> numbers(const PassRanges& passes) {
    std::vector<std::uint32_t> result;
    for (const PassRanges::Range& range : passes.ranges()) {
        for (std::uint32_t pass = range.begin; pass < range.end; ++pass)
            result.push_back(pass);
    }
    return result;
}

const char* const pass_sets[] = {"0:2", "0:16", "0:50", "5:23", "0:500", "3:9,12:13,40:77,1000:1003", "0:6000"};

TEST(ErrorContrasts, SquaresAreThoseOfSumsOverBlocks) {
    for (const char* const text : pass_sets) {
        SCOPED_TRACE(text);
        const PassRanges passes = PassRanges::parse(text);
        std::map<std::uint32_t, double> ones;
        for (const std::uint32_t pass : numbers(passes))
            ones[pass] = 1.0;
        EXPECT_EQ(block_squares(passes), slow_squares(ones));
        double coarsest = 0.0;
        for (const ContrastSet& set : error_contrasts(passes)) {
            BlockSquares expected{};
            for (const ErrorContrast& contrast : set.contrasts) {
                std::map<std::uint32_t, double> factors;
                double sum = 0.0;
                for (const std::uint32_t pass : numbers(passes))
                    sum += factors[pass] = contrast.factors[group_at(pass, set.level)] - contrast.share;
                EXPECT_NEAR(sum, 0.0, 1e-9) << "the mean counts";
                const BlockSquares squares = slow_squares(factors);
                for (std::size_t h = 0; h < block_sizes; ++h)
                    expected[h] += squares[h];
            }
            for (std::size_t h = 0; h < block_sizes; ++h)
                EXPECT_NEAR(set.squares[h], expected[h], 1e-9 * (expected[h] + expected[0])) << h;
            EXPECT_GT(set.freedom, 0.999);
            EXPECT_LT(set.freedom, static_cast<double>(set.contrasts.size()) + 0.001);
            coarsest = std::max(coarsest, set.batch);
        }
        // The largest blocks that passes from 0 on have two of.
        if (passes.ranges().size() == 1 && std::has_single_bit(passes.count()) && passes.count() > 2) {
            EXPECT_EQ(coarsest, static_cast<double>(passes.count()) / 2.0);
        }
    }
}

TEST(ErrorContrasts, PowerLawsHoldForWholeBlocks) {
    for (const double a : {1.0, 1.5, 2.0}) {
        for (const std::uint32_t n : {1U, 2U, 64U, 4096U})
            EXPECT_NEAR(variance_by_power(block_squares(PassRanges(n, 2 * n)), a) / n / n, std::pow(n, -a),
                        1e-6 * std::pow(n, -a));
    }
    // Independent passes, whatever passes.
    for (const char* const text : pass_sets) {
        const PassRanges passes = PassRanges::parse(text);
        EXPECT_NEAR(variance_by_power(block_squares(passes), 1.0), static_cast<double>(passes.count()), 1e-6);
    }
}

/// The van der Corput sequence, which is a Sobol' sequence, with digital shifts: a block of 2^h points lies at equal
/// distances of 2^-h, so that its mean has the variance 4^-h/12. All shifts of 16 digits give that of any points.
TEST(ErrorContrasts, VarianceOfAMeanIsThatOfAShiftedSequence) {
    constexpr int digits = 16;
    for (const char* const text : {"0:3", "0:48", "0:50", "0:100", "0:128", "0:160"}) {
        SCOPED_TRACE(text);
        const PassRanges passes = PassRanges::parse(text);
        std::vector<std::uint32_t> points;
        for (const std::uint32_t pass : numbers(passes)) {
            std::uint32_t mirrored = 0;
            for (int bit = 0; bit < digits; ++bit)
                mirrored |= (pass >> bit & 1U) << (digits - 1 - bit);
            points.push_back(mirrored);
        }
        const auto n = static_cast<double>(points.size());
        double squares = 0.0;
        for (std::uint32_t shift = 0; shift < 1U << digits; ++shift) {
            double sum = 0.0;
            for (const std::uint32_t point : points)
                sum += point ^ shift;
            squares += std::pow(std::ldexp(sum / n + 0.5, -digits) - 0.5, 2);
        }
        const double variance = std::ldexp(squares, -digits);
        // 16 digits leave out 4^-16 of the variance of a point.
        EXPECT_NEAR(variance_by_power(block_squares(passes), 2.0) / (n * n) / 12.0, variance,
                    std::ldexp(1.0, -2 * digits) + 1e-9 * variance);
    }
}

} // namespace
} // namespace tristim::test
