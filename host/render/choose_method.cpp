#include "render/choose_method.h"

#include "base/error.h"
#include "image/image.h"
#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// What is tried: illuminant-mixture:C, of the samplers in kernels/samplers/ the one that varies least under lamps of
// lines. (Under smooth light others may vary less, in a term that falls as the square of the passes.) First C = 8, the
// best or near it wherever no surface disperses (bench/methods). Where surfaces disperse, paths keep one of C
// wavelengths and may lose by a larger C: then a single one. Then four, which may trace faster. If none of these is
// better, twice as many as long as that pays, since wavelengths at equal distances vary less the more there are.
// Samplers that do not know the light are not tried: a trial of a few wavelengths that miss the lines of a lamp would
// take its darkness for a lack of variance.

namespace tristim {
namespace {

constexpr int usual = 8;
constexpr int narrow = 4; ///< the lanes of a narrow vector
constexpr int widest = 64;
/// Sets of wavelengths that a trial sees, each with two sets of paths; more where a set is a single wavelength.
constexpr int least_sets = 2;
/// Share of the budget after which no further method is tried.
constexpr double most_trial_share = 0.1;
/// Search radii are those of the middle of the render, but not of a later pass than this: they hardly shrink from
/// there.
constexpr double last_typical_pass = 1000.0;
/// The predicted error of another C over that of the best so far, below which it is taken: what a few passes can tell.
constexpr double worthwhile = 0.98;

/// The variances of pairs of images: each pair has wavelengths of its own, the two of a pair different paths.
class Pairs {
  public:
    using Image = std::vector<std::array<float, 3>>;

    void add(const Image& first, const Image& second) {
        sums_.resize(first.size());
        for (std::size_t i = 0; i < first.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                const double a = first[i][c];
                const double b = second[i][c];
                squares_ += 0.5 * (a - b) * (a - b);
                products_ += a * b;
                sums_[i][c][0] += a;
                sums_[i][c][1] += b;
            }
        }
        ++pairs_;
    }

    /// Of images with the same wavelengths, the mean over wavelengths, pixels and channels.
    double path_variance() const { return squares_ / (values() * pairs_); }

    /// Of what images of the same wavelengths average to: the covariance of first and second images, whose paths are
    /// independent. Clamped at zero, below which it may fall by chance.
    double wavelength_variance() const {
        double of_sums = 0.0;
        for (const auto& pixel : sums_) {
            for (const auto& [a, b] : pixel)
                of_sums += a * b;
        }
        return std::max(0.0, (products_ - of_sums / pairs_) / (values() * (pairs_ - 1.0)));
    }

  private:
    double values() const { return 3.0 * static_cast<double>(sums_.size()); }

    std::vector<std::array<std::array<double, 2>, 3>> sums_; ///< per pixel and channel, of first and second images
    double squares_ = 0.0;
    double products_ = 0.0;
    double pairs_ = 0.0;
};

class Trials {
  public:
    Trials(std::shared_ptr<const DeviceScene> scene, const RenderOptions& options, const Device& device,
           const RenderBudget& budget)
        : scene_(std::move(scene)), options_(options), device_(device), budget_(budget) {
        options_.auto_method = false;
    }

    /// Tries the method; whether it is worthwhile over the best so far, and then chosen.
    bool operator()(const Method& method) {
        options_.method = method;
        Renderer renderer(scene_, options_, device_);
        if (choice.trials.empty())
            fix_budget(renderer);
        MethodTrial& trial = choice.trials.emplace_back(measure(renderer));
        trial.predicted_error = error_of(trial);
        const bool better = trial.predicted_error < worthwhile * least_error_;
        if (better) {
            least_error_ = trial.predicted_error;
            choice.method = method;
        }
        return better;
    }

    bool affordable() const { return choice.seconds < most_trial_share * choice.budget_seconds; }

    /// Whether twice the wavelengths of `wide` may be worthwhile: at best theirs no longer vary, a pass takes as long,
    /// and paths vary as they did for half as many, `half`, and `wide`, by a term as 1/C.
    bool doubling_may_pay(const MethodTrial& half, MethodTrial wide) const {
        wide.wavelength_variance = 0.0;
        wide.path_variance = std::max(0.0, 1.5 * wide.path_variance - 0.5 * half.path_variance);
        return error_of(wide) < worthwhile * least_error_;
    }

    MethodChoice choice;

  private:
    /// Seconds of the whole render, and the pass whose search radius is typical of it, from a first pass.
    void fix_budget(Renderer& renderer) {
        renderer.render_pass(0);
        const double pass_seconds = renderer.statistics().render_seconds;
        choice.seconds += pass_seconds;
        choice.budget_seconds = budget_.seconds.value_or(std::numeric_limits<double>::infinity());
        if (budget_.passes)
            choice.budget_seconds =
                std::min(choice.budget_seconds, static_cast<double>(*budget_.passes) * pass_seconds);
        typical_pass_ =
            static_cast<std::uint32_t>(std::min(0.5 * choice.budget_seconds / pass_seconds, last_typical_pass));
    }

    double error_of(const MethodTrial& trial) const {
        return trial.error_after(choice.budget_seconds / trial.pass_seconds, options_.random_sequence);
    }

    MethodTrial measure(Renderer& renderer) {
        MethodTrial trial{renderer.options().method, 0.0, 0.0, std::numeric_limits<double>::infinity()};
        const auto image = [&](std::uint32_t set, std::uint32_t seed) {
            renderer.reset();
            renderer.render_pass({set, seed, typical_pass_, options_.seed});
            const double seconds = renderer.statistics().render_seconds;
            trial.pass_seconds = std::min(trial.pass_seconds, seconds);
            choice.seconds += seconds;
            return xyz_image(renderer.film()).xyz;
        };
        const int sets = std::max(least_sets, narrow / trial.method.wavelengths());
        Pairs pairs;
        // The paths' seeds are those of no repeat of a bench: they count down from the complement.
        for (std::uint32_t set = 0; set < static_cast<std::uint32_t>(sets); ++set)
            pairs.add(image(set, ~options_.seed), image(set, ~options_.seed - 1));
        trial.path_variance = pairs.path_variance();
        trial.wavelength_variance = pairs.wavelength_variance();
        return trial;
    }

    std::shared_ptr<const DeviceScene> scene_;
    RenderOptions options_;
    const Device& device_;
    RenderBudget budget_;
    std::uint32_t typical_pass_ = 0;
    double least_error_ = std::numeric_limits<double>::infinity();
};

} // namespace

double MethodTrial::error_after(double passes, bool random_sequence) const {
    const double n = std::max(passes, 1.0);
    return std::sqrt(path_variance / n + wavelength_variance / (random_sequence ? n : n * n));
}

MethodChoice choose_method(const std::shared_ptr<const DeviceScene>& scene, const RenderOptions& options,
                           const Device& device, const RenderBudget& budget, const TrialCallback& may_try) {
    Trials trials(scene, options, device, budget);
    std::vector<MethodTrial>& tried = trials.choice.trials;
    const auto with = [](int count) { return Method{Method::Kind::IlluminantMixture, count}; };
    trials.choice.method = with(usual);
    const auto may = [&](int count) { return may_try(with(count)) && (tried.empty() || trials.affordable()); };
    if (!may(usual))
        return std::move(trials.choice);
    trials(with(usual));
    if (scene->effects().dispersion && (!may(1) || trials(with(1))))
        return std::move(trials.choice);
    if (!may(narrow) || trials(with(narrow)))
        return std::move(trials.choice);
    MethodTrial half = tried.back(), whole = tried.front();
    for (int count = 2 * usual; count <= widest && trials.doubling_may_pay(half, whole); count *= 2) {
        if (!may(count) || !trials(with(count)))
            break;
        half = std::exchange(whole, tried.back());
    }
    return std::move(trials.choice);
}

std::string describe(const MethodChoice& choice) {
    std::string text =
        fmt::format("auto: {:<24}{:>9}  {:>21}  {:>21}  {:>20}\n", "method", "ms/pass", "paths' variance",
                    "wavelengths' variance", fmt::format("RMS noise, {:.3g} s", choice.budget_seconds));
    for (const MethodTrial& trial : choice.trials)
        text += fmt::format("auto: {:<24}{:>9.1f}  {:>21.4g}  {:>21.4g}  {:>20.4g}\n", trial.method.name(),
                            1e3 * trial.pass_seconds, trial.path_variance, trial.wavelength_variance,
                            trial.predicted_error);
    return text + fmt::format(
                      "auto: chose {}, the least noise after {:.3g} s, or within 2 % of it; {:.2g} s of trial passes\n",
                      choice.method.name(), choice.budget_seconds, choice.seconds);
}

} // namespace tristim
