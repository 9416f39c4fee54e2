#pragma once

#include "mpi/communicator.h"
#include "render/pass_ranges.h"

#include <bit>

namespace tristim {

/// What ranks tell each other while they render: the first word of a message, and what follows it.
enum class Topic : std::uint64_t {
    Report,    ///< to rank 0: passes done in all, seconds a pass takes, whether it needs passes, whether it was
               ///< interrupted
    Failed,    ///< to rank 0: no device is left; passes that are lost
    Saved,     ///< to rank 0: the sums that it asked for are there
    Passes,    ///< to a rank: passes to be done
    TakenBack, ///< to a rank that has failed: passes that it lost and that are no longer its own
    Save,      ///< to all: save sums
    Reduce,    ///< to all: add up the saved sums
    Stop       ///< to all: the render is over
};

inline Topic topic(const Words& words) {
    return static_cast<Topic>(words.front());
}

inline Words about(Topic topic) {
    return {static_cast<std::uint64_t>(topic)};
}

struct RankReport {
    std::uint64_t done = 0;
    double pass_seconds = 0.0; ///< 0: not known yet
    bool needs_passes = false;
    bool interrupted = false;
};

inline Words words(const RankReport& report) {
    return {static_cast<std::uint64_t>(Topic::Report), report.done, std::bit_cast<std::uint64_t>(report.pass_seconds),
            report.needs_passes ? 1U : 0U, report.interrupted ? 1U : 0U};
}

inline RankReport report_of(const Words& words) {
    return {words[1], std::bit_cast<double>(words[2]), words[3] != 0, words[4] != 0};
}

inline Words words(Topic topic, const PassRanges& passes) {
    Words words = about(topic);
    for (const PassRanges::Range& range : passes.ranges())
        words.push_back(std::uint64_t{range.begin} << 32U | range.end);
    return words;
}

inline PassRanges passes_of(const Words& words) {
    PassRanges passes;
    for (std::size_t i = 1; i < words.size(); ++i)
        passes.add(PassRanges(static_cast<std::uint32_t>(words[i] >> 32U), static_cast<std::uint32_t>(words[i])));
    return passes;
}

} // namespace tristim
