#pragma once
// Bench results whose errors follow a formula.

#include "bench/results.h"

#include <cmath>
#include <functional>

namespace tristim::test {

/// In the body of a TEST, Run is a function of GoogleTest's.
using BenchRun = tristim::Run;

using ErrorLaw = std::function<double(double seconds)>;

/// Checkpoints at first · 2^k seconds, up to `end`.
inline Repeat repeat_of(const ErrorLaw& error, double first = 0.1, double end = 103.0) {
    Repeat repeat;
    repeat.finished = true;
    for (double t = first; t <= end; t *= 2.0) {
        CurvePoint point;
        point.seconds = t;
        point.passes = repeat.checkpoints.size() + 1;
        point.photons = 1000 * point.passes;
        point.memory = 1 << 20;
        point.rmse = {error(t)};
        point.rel_mse = {error(t) * error(t)};
        repeat.checkpoints.push_back(point);
    }
    return repeat;
}

/// A run of some repeats.
inline BenchRun run_of(const std::string& label, const std::vector<ErrorLaw>& errors, double first = 0.1,
                       double end = 103.0) {
    BenchRun run;
    run.id = label;
    run.label = label;
    for (const ErrorLaw& error : errors)
        run.repeats.push_back(repeat_of(error, first, end));
    return run;
}

/// c · t^-1/2, times 1 ± spread for the first and last of three repeats.
inline BenchRun noisy_run(const std::string& label, double c, double spread = 0.01) {
    const auto law = [=](double factor) { return [=](double t) { return factor * c / std::sqrt(t); }; };
    return run_of(label, {law(1.0 - spread), law(1.0), law(1.0 + spread)});
}

/// A scene of one region and one group of all runs; the baseline is the last run.
inline SceneResults scene_of(std::vector<BenchRun> runs, double floor = 0.0) {
    SceneResults scene;
    scene.name = "scene";
    scene.regions = {{"image", {0, 0, 8, 8}}};
    scene.reference.floor = scene.reference.noise = {floor};
    scene.reference.bias = {0.0};
    RunGroup group;
    group.name = "methods";
    for (std::size_t i = 0; i < runs.size(); ++i) {
        group.runs.push_back(i);
        group.labels.push_back(runs[i].label);
    }
    group.baseline = runs.empty() ? 0 : runs.size() - 1;
    scene.runs = std::move(runs);
    scene.groups = {group};
    return scene;
}

} // namespace tristim::test
