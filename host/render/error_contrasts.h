#pragma once

#include "render/pass_ranges.h"
#include "shared_types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tristim {

/// The group that a pass belongs to at each level: ERROR_GROUP_BITS for each, the first level in the lowest bits. At
/// level l, passes with the same number over 2^(2l+1) are a batch; the place of a batch among ERROR_GROUPS successive
/// ones, xor a number that is random for these, is its group. So the difference of two groups that differ in the last
/// bit is a sum, with random signs, of differences of batches next to each other, and so on for pairs of groups.
std::uint32_t error_groups(std::uint32_t pass);

/// Blocks are passes with the same number over 2^h. For each h, the sum over the blocks of the square of a sum over the
/// passes of a block.
inline constexpr std::size_t block_sizes = 33;
using BlockSquares = std::array<double, block_sizes>;

/// Of how many of the passes are in each block.
BlockSquares block_squares(const PassRanges& passes);

/// The variance of Σ t_i x_i over passes x_i, if the mean of a block of B passes has the variance B^-a, from the block
/// squares of the t_i. Passes of a sequence that is scrambled digit by digit have a covariance that depends on the xor
/// of their numbers alone; its mean over those with the highest bit h, 2 v(2^(h+1)) − v(2^h) by the variances v of the
/// means of blocks, is all that counts here: exactly for the mean of the first n passes, whatever n.
double variance_by_power(const BlockSquares& squares, double a);

/// Sums of passes with signs: + in the groups of one side, − in those of the other; less a share of the sum of all, so
/// that the mean does not count.
struct ErrorContrast {
    std::array<double, ERROR_GROUPS> factors{}; ///< of the groups' sums
    double share = 0.0;                         ///< of the sum of all passes, to be taken off
    BlockSquares squares{};
};

/// The contrasts of one level that separate blocks of one size; none of them without passes.
struct ContrastSet {
    int level = 0;
    std::vector<ErrorContrast> contrasts;
    double batch = 1.0;   ///< passes of the blocks that they compare
    double freedom = 0.0; ///< degrees of freedom of their squares
    BlockSquares squares{};
};

/// All that tell of the passes' noise, finer blocks first. Blocks that are very many are left out: what they tell is of
/// little weight.
std::vector<ContrastSet> error_contrasts(const PassRanges& passes);

} // namespace tristim
