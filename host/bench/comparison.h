#pragma once

#include "bench/analysis.h"

namespace tristim {

/// How the runs of one group compare in one region. Vectors run along the group's list of runs.
struct Comparison {
    std::vector<Curve> curves;
    std::optional<double> equal_time;              ///< seconds: the latest time that every run with a curve reached
    std::vector<std::optional<double>> errors;     ///< medians at the equal time
    std::vector<std::size_t> ranking;              ///< positions in the group with an error, least first
    std::vector<std::optional<double>> ahead_from; ///< seconds from which on the first of the ranking stays ahead
    std::vector<double> levels;                    ///< of error, falling
    double floor = 0.0;                            ///< of the reference, 0: none known
};

Comparison compare_runs(const SceneResults& scene, const RunGroup& group, std::size_t region);

/// From when on, until the time `end`, the median of `best` stays below that of `other`, in seconds; none where one of
/// them has no value at `end` or `best` isn't below then. Where it is below throughout: the first time that both have.
std::optional<double> stays_ahead_from(const Curve& best, const Curve& other, double end);

/// At most six errors of the series 1, 2, 5, 10, …, the greatest first: down to the least that some curve reaches
/// without going below `floor`, up to one that most curves reach, and further while that tells curves apart.
std::vector<double> error_levels(const std::vector<Curve>& curves, double floor);

/// The paragraph on a group, in English: see summarise.
std::string describe(const SceneResults& scene, const RunGroup& group, std::size_t region,
                     const Comparison& comparison);

} // namespace tristim
