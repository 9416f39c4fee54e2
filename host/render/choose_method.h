#pragma once

#include "render/device_scene.h"
#include "render/method.h"
#include "render/options.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tristim {

/// What a few passes of a method tell. Variances are those of a pass's XYZ, means over pixels and channels.
struct MethodTrial {
    Method method;
    double path_variance = 0.0;       ///< of passes with the same wavelengths
    double wavelength_variance = 0.0; ///< of their expectations, over the first sets of wavelengths of the sequence
    double pass_seconds = 0.0;
    double predicted_error = 0.0; ///< error_after() as many passes as the budget has time for

    /// The RMS error of the mean of n passes, without what the search radius blurs: paths of different passes are
    /// independent, wavelengths (unless random) follow a sequence whose error falls as 1/n.
    double error_after(double passes, bool random_sequence) const;
};

/// The method of `--method auto`, and why.
struct MethodChoice {
    Method method;
    std::vector<MethodTrial> trials; ///< in the order they were made
    double budget_seconds = 0.0;     ///< after which errors are predicted
    double seconds = 0.0;            ///< of rendering that the trials took, kernel builds aside
};

/// Called before each trial; false ends them, and the best so far is chosen.
using TrialCallback = std::function<bool(const Method&)>;

/// Tries unbiased methods on the scene, each in a few passes, and chooses the one that predicts the least error when
/// the budget is spent (of passes: the time that they take by the first method tried), or the one tried before it, if
/// that predicts hardly more. No further one is tried once trials have taken a tenth of the budget. What is tried
/// follows from the scene: see the .cpp file. Methods whose predictions differ by less than the machine's timing may
/// change places from run to run. Throws Error as Renderer does.
MethodChoice choose_method(
    const std::shared_ptr<const DeviceScene>& scene, const RenderOptions& options, const Device& device,
    const RenderBudget& budget, const TrialCallback& may_try = [](const Method&) { return true; });

/// A table of the trials and a sentence, several lines, for people.
std::string describe(const MethodChoice& choice);

} // namespace tristim
