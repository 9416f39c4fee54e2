#include "bench/comparison.h"

#include "base/round_numbers.h"

#include <algorithm>
#include <cmath>

namespace tristim {
namespace {

constexpr std::size_t most_levels = 6;

} // namespace

std::vector<double> error_levels(const std::vector<Curve>& curves, double floor) {
    std::vector<double> lasts;
    double greatest_first = 0.0;
    for (const Curve& curve : curves) {
        if (curve.median.empty())
            continue;
        greatest_first = std::max(greatest_first, curve.median.front());
        if (curve.median.back() > 0.0)
            lasts.push_back(curve.median.back());
    }
    if (lasts.empty())
        return {};
    std::sort(lasts.begin(), lasts.end());
    const int bottom = round_number_above(std::max(lasts.front(), floor));
    int top = std::max(bottom, round_number_above(lasts[lasts.size() / 2]));
    while (top - bottom + 1 < static_cast<int>(most_levels) && round_number(top + 1) < greatest_first)
        ++top;
    const auto count = std::min(static_cast<std::size_t>(top - bottom + 1), most_levels);
    std::vector<double> levels{round_number(top)};
    for (std::size_t i = 1; i < count; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(count - 1);
        levels.push_back(round_number(top - static_cast<int>(std::lround(share * (top - bottom)))));
    }
    return levels;
}

std::optional<double> stays_ahead_from(const Curve& best, const Curve& other, double end) {
    if (best.seconds.empty() || other.seconds.empty())
        return std::nullopt;
    const double begin = std::max(best.seconds.front(), other.seconds.front());
    if (begin > end)
        return std::nullopt;
    std::vector<double> times{begin, end};
    for (const Curve* curve : {&best, &other})
        for (double time : curve->seconds)
            if (time > begin && time < end)
                times.push_back(time);
    std::sort(times.begin(), times.end());
    std::optional<double> ahead;
    double later_best = 0.0, later_other = 0.0;
    for (std::size_t i = times.size(); i-- > 0;) {
        const auto a = value_at(best.seconds, best.median, times[i]);
        const auto b = value_at(other.seconds, other.median, times[i]);
        if (!a || !b)
            return std::nullopt;
        if (*a >= *b) {
            // Between two times of the union both are straight in log–log, and so is their ratio.
            if (ahead && *a > 0.0 && *b > 0.0 && later_best > 0.0) {
                const double before = std::log(*a / *b);
                const double after = std::log(later_best / later_other);
                ahead = times[i] * std::pow(*ahead / times[i], before / (before - after));
            }
            return ahead;
        }
        ahead = times[i];
        later_best = *a;
        later_other = *b;
    }
    return ahead;
}

Comparison compare_runs(const SceneResults& scene, const RunGroup& group, std::size_t region) {
    Comparison comparison;
    if (region < scene.reference.floor.size() && std::isfinite(scene.reference.floor[region]))
        comparison.floor = scene.reference.floor[region];
    for (std::size_t run : group.runs) {
        comparison.curves.push_back(error_curve(scene.runs.at(run), region));
        const Curve& curve = comparison.curves.back();
        if (!curve.seconds.empty())
            comparison.equal_time =
                std::min(comparison.equal_time.value_or(curve.seconds.back()), curve.seconds.back());
    }
    comparison.levels = error_levels(comparison.curves, comparison.floor);
    comparison.errors.resize(group.runs.size());
    comparison.ahead_from.resize(group.runs.size());
    if (!comparison.equal_time)
        return comparison;
    for (std::size_t i = 0; i < group.runs.size(); ++i) {
        const Curve& curve = comparison.curves[i];
        comparison.errors[i] = value_at(curve.seconds, curve.median, *comparison.equal_time);
        if (comparison.errors[i])
            comparison.ranking.push_back(i);
    }
    std::stable_sort(comparison.ranking.begin(), comparison.ranking.end(),
                     [&](std::size_t a, std::size_t b) { return *comparison.errors[a] < *comparison.errors[b]; });
    for (std::size_t i : comparison.ranking)
        if (i != comparison.ranking.front())
            comparison.ahead_from[i] = stays_ahead_from(comparison.curves[comparison.ranking.front()],
                                                        comparison.curves[i], *comparison.equal_time);
    return comparison;
}

} // namespace tristim
