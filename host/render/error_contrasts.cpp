#include "render/error_contrasts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tristim {
namespace {

constexpr std::uint64_t most_batches = 2048;

int batch_bits(int level) {
    return 2 * level + 1;
}

std::uint32_t group_of_batch(std::uint64_t batch, int level) {
    // lowbias32 (Wellons 2018, "Prospecting for Hash Functions").
    std::uint32_t x =
        static_cast<std::uint32_t>(batch / ERROR_GROUPS) + 0x9e3779b9U * static_cast<std::uint32_t>(level + 1);
    x = (x ^ x >> 16U) * 0x7feb352dU;
    x = (x ^ x >> 15U) * 0x846ca68bU;
    return (static_cast<std::uint32_t>(batch) ^ x ^ x >> 16U) % ERROR_GROUPS;
}

/// Blocks of one size that follow one another and hold as many of the passes each.
struct BlockRun {
    std::uint64_t first = 0;
    std::uint64_t blocks = 0;
    double passes = 0.0; ///< in each
};

std::vector<BlockRun> single_passes(const PassRanges& passes) {
    std::vector<BlockRun> runs;
    for (const PassRanges::Range& range : passes.ranges())
        runs.push_back({range.begin, range.end - range.begin, 1.0});
    return runs;
}

/// The blocks of twice the size.
std::vector<BlockRun> doubled(const std::vector<BlockRun>& runs) {
    std::vector<BlockRun> result;
    const auto add = [&](std::uint64_t first, std::uint64_t blocks, double passes) {
        if (blocks == 1 && !result.empty() && result.back().blocks == 1 && result.back().first == first)
            result.back().passes += passes;
        else if (blocks > 0)
            result.push_back({first, blocks, passes});
    };
    for (const BlockRun& run : runs) {
        const std::uint64_t end = run.first + run.blocks, whole = (run.first + 1) / 2;
        if (run.first % 2 == 1)
            add(run.first / 2, 1, run.passes);
        if (end / 2 > whole)
            add(whole, end / 2 - whole, 2.0 * run.passes);
        if (end % 2 == 1 && end / 2 >= whole)
            add(end / 2, 1, run.passes);
    }
    return result;
}

/// A block and the sum over its passes of some numbers.
struct BlockSum {
    std::uint64_t block = 0;
    double sum = 0.0;
};

double squared(const std::vector<BlockSum>& sums) {
    double total = 0.0;
    for (const BlockSum& block : sums)
        total += block.sum * block.sum;
    return total;
}

void double_blocks(std::vector<BlockSum>& sums) {
    std::size_t count = 0;
    for (const BlockSum& block : sums) {
        if (count > 0 && sums[count - 1].block == block.block / 2)
            sums[count - 1].sum += block.sum;
        else
            sums[count++] = {block.block / 2, block.sum};
    }
    sums.resize(count);
}

/// The batches of a level that hold passes, and what the groups hold.
struct Batches {
    int level = 0;
    double passes = 0.0;
    std::vector<BlockSum> batches; ///< and their passes
    std::array<double, ERROR_GROUPS> group_passes{};
    std::array<BlockSquares, ERROR_GROUPS> squares{}; ///< of the passes in blocks up to the size of a batch
};

PassRanges block(std::uint64_t number, int bits) {
    const std::uint64_t end = std::min<std::uint64_t>((number + 1) << bits, std::numeric_limits<std::uint32_t>::max());
    return {static_cast<std::uint32_t>(number << bits), static_cast<std::uint32_t>(end)};
}

Batches batches_of(const PassRanges& passes, int level) {
    Batches result;
    result.level = level;
    result.passes = static_cast<double>(passes.count());
    const int bits = batch_bits(level);
    std::vector<BlockRun> runs = single_passes(passes);
    for (int h = 0; h < bits; ++h)
        runs = doubled(runs);
    for (const BlockRun& run : runs) {
        for (std::uint64_t batch = run.first; batch < run.first + run.blocks; ++batch) {
            const std::uint32_t group = group_of_batch(batch, level);
            result.batches.push_back({batch, run.passes});
            result.group_passes[group] += run.passes;
            const bool whole = run.passes == std::ldexp(1.0, bits);
            BlockSquares squares{};
            if (!whole)
                squares = block_squares(passes.common(block(batch, bits)));
            for (int h = 0; h <= bits; ++h) {
                const auto i = static_cast<std::size_t>(h);
                result.squares[group][i] += whole ? std::ldexp(1.0, bits + h) : squares[i];
            }
        }
    }
    return result;
}

/// The groups with the numbers 2 k, 2 k + 1 over 2^step, one against the other.
ErrorContrast contrast_of(const Batches& batches, int step, int k) {
    ErrorContrast contrast;
    std::array<double, 2> sides{};
    for (int group = 0; group < ERROR_GROUPS; ++group) {
        const auto g = static_cast<std::size_t>(group);
        contrast.factors[g] = group >> step == 2 * k ? 1.0 : group >> step == 2 * k + 1 ? -1.0 : 0.0;
        contrast.share += contrast.factors[g] * batches.group_passes[g] / batches.passes;
        if (contrast.factors[g] != 0.0)
            sides[contrast.factors[g] > 0.0 ? 0 : 1] += batches.group_passes[g];
    }
    // One side against nothing is one against the rest of the passes, which larger blocks tell already.
    if (sides[0] == 0.0 || sides[1] == 0.0)
        return {};
    const auto bits = static_cast<std::size_t>(batch_bits(batches.level));
    for (std::size_t h = 0; h <= bits; ++h) {
        for (std::size_t g = 0; g < ERROR_GROUPS; ++g)
            contrast.squares[h] += std::pow(contrast.factors[g] - contrast.share, 2) * batches.squares[g][h];
    }
    std::vector<BlockSum> sums;
    for (const BlockSum& batch : batches.batches) {
        const double factor = contrast.factors[group_of_batch(batch.block, batches.level)] - contrast.share;
        sums.push_back({batch.block, factor * batch.sum});
    }
    for (std::size_t h = bits + 1; h < block_sizes; ++h) {
        double_blocks(sums);
        contrast.squares[h] = squared(sums);
    }
    return contrast;
}

ContrastSet contrast_set(const Batches& batches, int step) {
    ContrastSet set;
    set.level = batches.level;
    double squared_freedom = 0.0;
    for (int k = 0; k < ERROR_GROUPS >> (step + 1); ++k) {
        const ErrorContrast contrast = contrast_of(batches, step, k);
        if (contrast.squares[0] == 0.0)
            continue;
        for (std::size_t h = 0; h < block_sizes; ++h)
            set.squares[h] += contrast.squares[h];
        squared_freedom += contrast.squares[0] * contrast.squares[0];
        set.contrasts.push_back(contrast);
    }
    if (!set.contrasts.empty()) {
        set.batch = set.squares[static_cast<std::size_t>(batch_bits(batches.level) + step)] / set.squares[0];
        set.freedom = set.squares[0] * set.squares[0] / squared_freedom;
    }
    return set;
}

} // namespace

std::uint32_t error_groups(std::uint32_t pass) {
    std::uint32_t groups = 0;
    for (int level = 0; level < ERROR_LEVELS; ++level)
        groups |= group_of_batch(pass >> batch_bits(level), level) << (level * ERROR_GROUP_BITS);
    return groups;
}

BlockSquares block_squares(const PassRanges& passes) {
    BlockSquares squares{};
    std::vector<BlockRun> runs = single_passes(passes);
    for (double& square : squares) {
        for (const BlockRun& run : runs)
            square += static_cast<double>(run.blocks) * run.passes * run.passes;
        runs = doubled(runs);
    }
    return squares;
}

double variance_by_power(const BlockSquares& squares, double a) {
    // Σ_ij t_i t_j c(i, j), with the products of passes that share a block of 2^(h+1) but none of 2^h being what
    // the sums over squares of the blocks differ by.
    const auto v = [a](std::size_t h) { return std::exp2(-a * static_cast<double>(h)); };
    double variance = squares[0];
    for (std::size_t h = 0; h + 1 < block_sizes; ++h)
        variance += (2.0 * v(h + 1) - v(h)) * (squares[h + 1] - squares[h]);
    return variance;
}

std::vector<ContrastSet> error_contrasts(const PassRanges& passes) {
    std::vector<ContrastSet> sets;
    for (int level = 0; level < ERROR_LEVELS; ++level) {
        const bool last = level == ERROR_LEVELS - 1;
        if (!last && passes.count() >> batch_bits(level) > most_batches)
            continue;
        const Batches batches = batches_of(passes, level);
        // Blocks of four batches are those of the next level.
        for (int step = 0; step < (last ? ERROR_GROUP_BITS : 2); ++step) {
            ContrastSet set = contrast_set(batches, step);
            if (!set.contrasts.empty())
                sets.push_back(set);
        }
    }
    return sets;
}

} // namespace tristim
