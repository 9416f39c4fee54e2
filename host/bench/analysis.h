#pragma once

#include "bench/results.h"

#include <optional>
#include <string>
#include <vector>

namespace tristim {

/// The error of a run over time, over its repeats: for each time, which lies within all repeats, the median and the
/// spread. Values between checkpoints are interpolated in log time and log error.
struct Curve {
    std::vector<double> seconds; ///< ascending
    std::vector<double> median;
    std::vector<double> low, high; ///< the least and greatest of the repeats
    std::size_t repeats = 0;       ///< how many it rests on
};

/// Repeats that got less than half as far as the longest, as in an interrupted bench, are left out. Empty if no repeat
/// has a checkpoint.
Curve error_curve(const Run& run, std::size_t region);

/// The value at a time, of a curve given by ascending times: linear in log time and log value (in log time and value
/// where one of the values is 0); none outside of the curve.
std::optional<double> value_at(const std::vector<double>& seconds, const std::vector<double>& values, double time);

/// From when on the median stays at or below `error`, in seconds; none if it does not at the curve's end. At the first
/// point already below: that point's time.
std::optional<double> time_to_reach(const Curve& curve, double error);

/// Slope of log error over log time, least squares over the points of the last decade of time (at least three points);
/// none with fewer points. -1/2 is that of unbiased Monte Carlo.
std::optional<double> fitted_slope(const Curve& curve);

/// The factor of time that halves an error of this slope, 2^(-1/slope); none for slopes ≥ 0 and where it
/// is beyond all numbers.
std::optional<double> time_to_halve(std::optional<double> slope);

/// Errors below this many times the reference's floor have a visible part of the reference's own error in them.
inline constexpr double near_floor_factor = 3.0;

/// From when on the median is below three times the reference's floor in this region, in seconds: there the
/// reference's own error has a visible part in it.
std::optional<double> near_floor_from(const Curve& curve, const ReferenceSummary& reference, std::size_t region);

/// Everything that report and plots show beyond the raw values, for each scene:
///   {"curves": [per run [per region {"seconds", "median", "low", "high", "slope", "halving", "near_floor_from"}]],
///    "groups": [per group [per region {"levels", "times", "equal_time", "errors", "ranking", "ahead_from", "text"}]]}
/// `halving`: the factor of time that halves the error, 2^(-1/slope), null for slopes ≥ 0 or none.
/// `near_floor_from`: seconds from which on the median is below three times the reference's floor, null: never.
/// `levels`: at most six errors of a 1-2-5 series, falling, each of which some run reaches; `times`: per level, per run
/// of the group, seconds or null.
/// `equal_time`: the latest time that every run of the group reached, null if none has been measured; `errors`: medians
/// then, per run of the group, null for a run without a checkpoint by then.
/// `ranking`: positions in the group's list of runs, least error first, without those whose error is null.
/// `ahead_from`: per run of the group, the time from which on, until the equal time, the best run's median stays below
/// it; null for the best one and where that never is.
/// `text`: one plain paragraph: who wins, by how much, from which time on, and what the spread and the floor allow to
/// say.
nlohmann::ordered_json summarise(const SceneResults& scene);

/// One line per checkpoint, region, repeat: scene, device, run (its id), seed, region, seconds, passes, photons,
/// memory, rmse, relmse. Comma-separated as in RFC 4180, but with plain line feeds; the first line names the columns.
std::string results_csv(const BenchResults& results);

} // namespace tristim
