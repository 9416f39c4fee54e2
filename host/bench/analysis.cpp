#include "bench/analysis.h"
#include "base/median.h"
#include "bench/comparison.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tristim {
namespace {

/// Unless a repeat got this far, as a share of the longest one's time, it says too little to cut the others for it.
constexpr double least_share_of_time = 0.5;

/// Repeats of few passes may have no time in common; times this close still count as one.
constexpr double same_time = 1.25;

/// Points of the common grid this close to its ends would count the end twice in fits.
constexpr double grid_margin = 1.02;

struct Samples {
    std::vector<double> seconds, errors;
};

/// Of one repeat: what can be drawn on a logarithmic axis of time.
Samples usable_samples(const Repeat& repeat, std::size_t region) {
    Samples samples;
    for (const CurvePoint& checkpoint : repeat.checkpoints) {
        if (checkpoint.rmse.size() <= region || !std::isfinite(checkpoint.rmse[region]) ||
            !std::isfinite(checkpoint.seconds))
            continue;
        if (checkpoint.seconds <= (samples.seconds.empty() ? 0.0 : samples.seconds.back()))
            continue;
        samples.seconds.push_back(checkpoint.seconds);
        samples.errors.push_back(checkpoint.rmse[region]);
    }
    return samples;
}

std::vector<Samples> comparable_repeats(const Run& run, std::size_t region) {
    std::vector<Samples> repeats;
    double longest = 0.0;
    for (const Repeat& repeat : run.repeats) {
        Samples samples = usable_samples(repeat, region);
        if (samples.seconds.empty())
            continue;
        longest = std::max(longest, samples.seconds.back());
        repeats.push_back(std::move(samples));
    }
    std::erase_if(repeats, [&](const Samples& s) { return s.seconds.back() < least_share_of_time * longest; });
    return repeats;
}

std::vector<double> common_times(const std::vector<Samples>& repeats) {
    double begin = 0.0;
    double end = repeats.front().seconds.back();
    for (const Samples& repeat : repeats) {
        begin = std::max(begin, repeat.seconds.front());
        end = std::min(end, repeat.seconds.back());
    }
    if (begin >= end)
        return begin <= same_time * end ? std::vector{begin} : std::vector<double>{};
    std::vector<double> times{begin};
    for (double time : repeats.front().seconds)
        if (time > grid_margin * begin && grid_margin * time < end)
            times.push_back(time);
    times.push_back(end);
    return times;
}

nlohmann::ordered_json to_number(std::optional<double> value) {
    return value && std::isfinite(*value) ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json to_numbers(const std::vector<std::optional<double>>& values) {
    auto json = nlohmann::ordered_json::array();
    for (const auto& value : values)
        json.push_back(to_number(value));
    return json;
}

nlohmann::ordered_json summarise_curve(const Curve& curve, const ReferenceSummary& reference, std::size_t region) {
    const auto slope = fitted_slope(curve);
    return {{"seconds", curve.seconds},
            {"median", curve.median},
            {"low", curve.low},
            {"high", curve.high},
            {"slope", to_number(slope)},
            {"halving", to_number(time_to_halve(slope))},
            {"near_floor_from", to_number(near_floor_from(curve, reference, region))}};
}

nlohmann::ordered_json summarise_group(const SceneResults& scene, const RunGroup& group, std::size_t region) {
    const Comparison comparison = compare_runs(scene, group, region);
    auto times = nlohmann::ordered_json::array();
    for (double level : comparison.levels) {
        std::vector<std::optional<double>> reached;
        for (const Curve& curve : comparison.curves)
            reached.push_back(time_to_reach(curve, level));
        times.push_back(to_numbers(reached));
    }
    return {{"levels", comparison.levels},
            {"times", times},
            {"equal_time", to_number(comparison.equal_time)},
            {"errors", to_numbers(comparison.errors)},
            {"ranking", comparison.ranking},
            {"ahead_from", to_numbers(comparison.ahead_from)},
            {"text", describe(scene, group, region, comparison)}};
}

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos)
        return text;
    std::string quoted = "\"";
    for (char c : text) {
        if (c == '"')
            quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

} // namespace

std::optional<double> value_at(const std::vector<double>& seconds, const std::vector<double>& values, double time) {
    if (seconds.empty() || time < seconds.front() || time > seconds.back())
        return std::nullopt;
    const auto above = std::lower_bound(seconds.begin(), seconds.end(), time);
    const auto i = static_cast<std::size_t>(above - seconds.begin());
    if (*above == time)
        return values[i];
    const double u = std::log(time / seconds[i - 1]) / std::log(seconds[i] / seconds[i - 1]);
    const double a = values[i - 1];
    const double b = values[i];
    return a > 0.0 && b > 0.0 ? a * std::pow(b / a, u) : a + (b - a) * u;
}

Curve error_curve(const Run& run, std::size_t region) {
    Curve curve;
    const std::vector<Samples> repeats = comparable_repeats(run, region);
    if (repeats.empty())
        return curve;
    curve.seconds = common_times(repeats);
    curve.repeats = curve.seconds.empty() ? 0 : repeats.size();
    for (double time : curve.seconds) {
        std::vector<double> errors;
        for (const Samples& repeat : repeats) {
            const double within = std::clamp(time, repeat.seconds.front(), repeat.seconds.back());
            errors.push_back(*value_at(repeat.seconds, repeat.errors, within));
        }
        curve.median.push_back(median(errors));
        curve.low.push_back(*std::min_element(errors.begin(), errors.end()));
        curve.high.push_back(*std::max_element(errors.begin(), errors.end()));
    }
    return curve;
}

std::optional<double> time_to_reach(const Curve& curve, double error) {
    if (curve.median.empty() || curve.median.back() > error)
        return std::nullopt;
    std::size_t i = curve.median.size() - 1;
    while (i > 0 && curve.median[i - 1] <= error)
        --i;
    if (i == 0)
        return curve.seconds.front();
    const double a = curve.median[i - 1];
    const double b = curve.median[i];
    const double u = b > 0.0 && error > 0.0 ? std::log(a / error) / std::log(a / b) : (a - error) / (a - b);
    return curve.seconds[i - 1] * std::pow(curve.seconds[i] / curve.seconds[i - 1], u);
}

std::optional<double> fitted_slope(const Curve& curve) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < curve.seconds.size(); ++i)
        // The margin keeps a point exactly a decade before the end in, whatever its rounding.
        if (curve.seconds[i] * 10.0 >= curve.seconds.back() * (1.0 - 1e-9) && curve.median[i] > 0.0) {
            x.push_back(std::log(curve.seconds[i]));
            y.push_back(std::log(curve.median[i]));
        }
    if (x.size() < 3)
        return std::nullopt;
    double mean_x = 0.0, mean_y = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mean_x += x[i] / static_cast<double>(x.size());
        mean_y += y[i] / static_cast<double>(x.size());
    }
    double xx = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    return xy / xx;
}

std::optional<double> time_to_halve(std::optional<double> slope) {
    if (!slope || *slope >= 0.0)
        return std::nullopt;
    const double factor = std::exp2(-1.0 / *slope);
    return std::isfinite(factor) ? std::optional(factor) : std::nullopt;
}

std::optional<double> near_floor_from(const Curve& curve, const ReferenceSummary& reference, std::size_t region) {
    if (region >= reference.floor.size() || !(reference.floor[region] > 0.0))
        return std::nullopt;
    return time_to_reach(curve, near_floor_factor * reference.floor[region]);
}

nlohmann::ordered_json summarise(const SceneResults& scene) {
    auto curves = nlohmann::ordered_json::array();
    for (const Run& run : scene.runs) {
        auto regions = nlohmann::ordered_json::array();
        for (std::size_t r = 0; r < scene.regions.size(); ++r)
            regions.push_back(summarise_curve(error_curve(run, r), scene.reference, r));
        curves.push_back(std::move(regions));
    }
    auto groups = nlohmann::ordered_json::array();
    for (const RunGroup& group : scene.groups) {
        auto regions = nlohmann::ordered_json::array();
        for (std::size_t r = 0; r < scene.regions.size(); ++r)
            regions.push_back(summarise_group(scene, group, r));
        groups.push_back(std::move(regions));
    }
    return {{"curves", std::move(curves)}, {"groups", std::move(groups)}};
}

std::string results_csv(const BenchResults& results) {
    std::string csv = "scene,device,run,seed,region,seconds,passes,photons,memory,rmse,relmse\n";
    for (const SceneResults& scene : results.scenes)
        for (const Run& run : scene.runs) {
            const std::string head = fmt::format("{},{},{}", csv_field(scene.name),
                                                 csv_field(results.devices.at(run.device).name), csv_field(run.id));
            for (const Repeat& repeat : run.repeats)
                for (const CurvePoint& point : repeat.checkpoints)
                    for (std::size_t r = 0; r < scene.regions.size(); ++r)
                        csv += fmt::format("{},{},{},{},{},{},{},{},{}\n", head, repeat.seed,
                                           csv_field(scene.regions[r].name), point.seconds, point.passes, point.photons,
                                           point.memory, point.rmse.at(r), point.rel_mse.at(r));
        }
    return csv;
}

} // namespace tristim
