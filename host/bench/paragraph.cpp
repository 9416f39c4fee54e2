#include "bench/comparison.h"
#include "bench/readable.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tristim {
namespace {

/// Without repeats the scatter is unknown; runs this close count as equal then.
constexpr double close_without_repeats = 1.05;

/// A curve sqrt(b² + c²/t) that falls by less than t^-0.1 over its last decade is within 3.4 % of b at its end:
/// x = c²/(b²t) there has (1 + 10x) / (1 + x) < 10^0.2.
constexpr double flat_slope = 0.1;

/// A slope over less than this factor of time says nothing on where a curve goes.
constexpr double least_span_of_slope = 5.0;

/// First checkpoints this close in time count as simultaneous.
constexpr double same_start = 1.5;

/// A longer list is summed up.
constexpr std::size_t most_listed = 3;

/// Beyond it, sentences that are only nice to have are left out.
constexpr std::size_t many_sentences = 4;

class Paragraph {
  public:
    Paragraph(const SceneResults& scene, const RunGroup& group, std::size_t region, const Comparison& all)
        : scene_(scene), group_(group), region_(region), all_(all) {
        for (std::size_t i : all_.ranking)
            (cannot_be_told_apart(all_.ranking.front(), i) ? tied_ : others_).push_back(i);
    }

    std::string text() {
        if (all_.ranking.empty())
            return fmt::format("{} nothing has been measured.",
                               region_ == 0 ? "So far" : fmt::format("In the region {}", scene_.regions[region_].name));
        if (all_.ranking.size() == 1)
            say_alone();
        else if (tied_.size() == 1)
            say_winner();
        else
            say_tie();
        say_unmeasured();
        say_ahead();
        say_stuck();
        say_near_floor();
        say_slope();
        say_single_repeat();
        return fmt::format("{}", fmt::join(sentences_, " "));
    }

  private:
    const SceneResults& scene_;
    const RunGroup& group_;
    std::size_t region_;
    const Comparison& all_;
    std::vector<std::size_t> tied_;   ///< positions that cannot be told apart from the first of the ranking, with it
    std::vector<std::size_t> others_; ///< the rest of the ranking
    std::vector<std::string> sentences_;

    /// A label of several words, "65536 photons", stands in quotes, so that a sentence can be about it.
    std::string label(std::size_t i) const {
        const std::string& text = group_.labels.at(i);
        return text.find(' ') == std::string::npos ? text : '"' + text + '"';
    }

    double error(std::size_t i) const { return *all_.errors[i]; }
    std::size_t best() const { return all_.ranking.front(); }
    std::string when() const { return readable_seconds(*all_.equal_time); }
    std::string floor() const { return readable_number(all_.floor); }
    bool below_floor(std::size_t i) const { return all_.floor > 0.0 && error(i) <= all_.floor; }

    std::string labels(const std::vector<std::size_t>& positions) const {
        std::vector<std::string> names;
        for (std::size_t i : positions)
            names.push_back(label(i));
        return readable_list(names);
    }

    /// With digits enough to see the difference to the next.
    std::string error_text(std::size_t i, std::optional<std::size_t> next = {}) const {
        const bool close =
            next && std::max(error(i), error(*next)) < least_readable_factor * std::min(error(i), error(*next));
        return readable_number(error(i), close ? 3 : 2);
    }

    double low(std::size_t i) const { return *value_at(all_.curves[i].seconds, all_.curves[i].low, *all_.equal_time); }
    double high(std::size_t i) const {
        return *value_at(all_.curves[i].seconds, all_.curves[i].high, *all_.equal_time);
    }
    bool repeated(std::size_t i) const { return all_.curves[i].repeats > 1; }

    bool bands_overlap(std::size_t a, std::size_t b) const { return low(a) <= high(b) && low(b) <= high(a); }

    bool cannot_be_told_apart(std::size_t a, std::size_t b) const {
        if ((below_floor(a) && below_floor(b)) || bands_overlap(a, b))
            return true;
        return !(repeated(a) && repeated(b)) && error(b) < close_without_repeats * error(a);
    }

    /// Starts the paragraph's first sentence, which says what part of the image it's about.
    std::string opening(std::string sentence) const {
        if (region_ > 0)
            return fmt::format("In the region {}, {}", scene_.regions[region_].name, sentence);
        return sentence;
    }

    void say_alone() {
        const std::size_t i = best();
        std::string spread;
        if (repeated(i))
            spread = fmt::format(" ({} to {} over {} repeats)", readable_number(low(i), 3), readable_number(high(i), 3),
                                 all_.curves[i].repeats);
        std::string floor_note;
        if (below_floor(i))
            floor_note = fmt::format(", which is no more than the reference's own error, {}", floor());
        sentences_.push_back(
            opening(fmt::format("{} has an error of {}{} after {}{}.", label(i),
                                readable_number(error(i), repeated(i) ? 3 : 2), spread, when(), floor_note)));
        if (group_.runs.size() == 1)
            sentences_.push_back("There is no other run to compare it with.");
    }

    /// "1.6 times less than the next, B (0.0066), and 7.8 times less than the baseline, C (0.032)"
    std::string lead() const {
        const std::size_t next = all_.ranking[1];
        const auto than = [&](std::size_t i, const std::string& role) {
            return fmt::format("{} {}{} ({})", readable_less(error(i) / error(best())), role, label(i),
                               error_text(i, best()));
        };
        std::string text = than(next, others_.size() > 1 ? "the next, " : "");
        const auto baseline = std::find_if(others_.begin(), others_.end(),
                                           [&](std::size_t i) { return group_.runs[i] == group_.baseline; });
        if (baseline != others_.end() && *baseline != next)
            text += fmt::format(", and {}", than(*baseline, "the baseline, "));
        return text;
    }

    void say_winner() {
        const std::size_t next = all_.ranking[1];
        const std::string head = fmt::format("{} has the least error after {}", label(best()), when());
        if (error(best()) == 0.0)
            sentences_.push_back(
                opening(fmt::format("{}: none at all, against {} for {}.", head, error_text(next), label(next))));
        else if (below_floor(best()))
            sentences_.push_back(opening(fmt::format(
                "{}, {}, but that is no more than the reference's own error, {}: how far it is ahead of {} ({}) "
                "cannot be said.",
                head, error_text(best(), next), floor(), label(next), error_text(next, best()))));
        else
            sentences_.push_back(
                opening(fmt::format("{}: {}, {}{}.", head, error_text(best(), next), lead(), agreement(next))));
    }

    /// Bands apart means that each repeat of the best is ahead of each of the next.
    std::string agreement(std::size_t next) const {
        if (!repeated(best()) || !repeated(next))
            return "";
        if (all_.curves[best()].repeats != all_.curves[next].repeats)
            return ", in all repeats";
        return all_.curves[next].repeats == 2 ? ", in both repeats"
                                              : fmt::format(", in all {} repeats", all_.curves[next].repeats);
    }

    std::string reason_of_tie() const {
        const bool floored = std::all_of(tied_.begin(), tied_.end(), [&](std::size_t i) { return below_floor(i); });
        if (floored)
            return fmt::format("no more than the reference's own error, {}", floor());
        if (std::all_of(tied_.begin(), tied_.end(), [&](std::size_t i) { return error(i) == error(best()); }))
            return "the same";
        if (std::all_of(tied_.begin(), tied_.end(), [&](std::size_t i) { return repeated(i); }))
            return "within the scatter of the repeats";
        return "too close for a single repeat";
    }

    void say_tie() {
        std::vector<std::string> errors;
        for (std::size_t i : tied_)
            errors.push_back(error_text(i, i == best() ? tied_[1] : best()));
        const std::string these = errors.front() == errors.back() ? errors.front() + " each"
                                  : tied_.size() <= most_listed
                                      ? readable_list(errors)
                                      : fmt::format("{} to {}", errors.front(), errors.back());
        const std::string head =
            others_.empty()
                ? fmt::format("{} cannot be told apart after {}", labels(tied_), when())
                : fmt::format("{} have the least error after {} and cannot be told apart", labels(tied_), when());
        sentences_.push_back(opening(fmt::format("{}: their errors, {}, are {}.", head, these, reason_of_tie())));
        if (others_.empty() || error(best()) == 0.0 || below_floor(best()))
            return;
        const std::size_t next = others_.front();
        const auto behind = [&](std::size_t i) {
            return fmt::format("has {}, {} {}", error_text(i, best()), readable_more(error(i) / error(best())),
                               label(best()));
        };
        std::string rest = fmt::format("{} {}", label(next), behind(next));
        if (others_.size() > 1)
            rest = "Of the others, " + rest;
        const auto baseline = std::find_if(others_.begin() + 1, others_.end(),
                                           [&](std::size_t i) { return group_.runs[i] == group_.baseline; });
        if (baseline != others_.end())
            rest += fmt::format("; the baseline, {}, {}", label(*baseline), behind(*baseline));
        sentences_.push_back(rest + ".");
    }

    void say_unmeasured() {
        std::vector<std::size_t> missing;
        for (std::size_t i = 0; i < group_.runs.size(); ++i)
            if (!all_.errors[i])
                missing.push_back(i);
        if (!missing.empty())
            sentences_.push_back(fmt::format("Of {} nothing has been measured by then.", labels(missing)));
    }

    void say_ahead() {
        std::vector<std::pair<double, std::size_t>> crossings;
        std::vector<std::size_t> throughout;
        for (std::size_t i : others_) {
            const double first = all_.curves[best()].seconds.front();
            const double other_first = all_.curves[i].seconds.front();
            if (std::max(first, other_first) >= *all_.equal_time || !all_.ahead_from[i])
                continue;
            // Where the best had no image yet the other was ahead, in a way.
            if (*all_.ahead_from[i] > std::max(first, other_first) || first > same_start * other_first)
                crossings.emplace_back(*all_.ahead_from[i], i);
            else
                throughout.push_back(i);
        }
        std::sort(crossings.rbegin(), crossings.rend());
        const std::string who = tied_.size() == 1 ? "It" : label(best());
        const std::string the_others = tied_.size() == 1 ? "all others" : "all but these";
        if (crossings.size() > most_listed) {
            sentences_.push_back(fmt::format("{} is ahead of {} from {} on, last of {}.", who, the_others,
                                             readable_seconds(crossings.front().first),
                                             label(crossings.front().second)));
            return;
        }
        std::vector<std::string> parts;
        for (const auto& [time, i] : crossings)
            parts.push_back(fmt::format("of {} from {} on", label(i), readable_seconds(time)));
        if (!throughout.empty())
            parts.push_back(fmt::format("of {} from the first measurement on", throughout.size() <= most_listed
                                                                                   ? labels(throughout)
                                                                               : crossings.empty() ? the_others
                                                                                                   : "the others"));
        if (!parts.empty())
            sentences_.push_back(fmt::format("{} is ahead {}.", who, readable_list(parts)));
    }

    bool near_floor(std::size_t i) const { return all_.floor > 0.0 && error(i) <= near_floor_factor * all_.floor; }

    bool stuck(std::size_t i) const {
        const Curve& curve = all_.curves[i];
        const auto slope = fitted_slope(curve);
        return slope && std::abs(*slope) <= flat_slope && !near_floor(i) && error(i) > 0.0 &&
               curve.seconds.back() >= least_span_of_slope * curve.seconds.front();
    }

    void say_stuck() {
        std::vector<std::string> flat;
        for (std::size_t i : all_.ranking)
            if (stuck(i))
                flat.push_back(fmt::format("{}{} at {}", label(i), flat.empty() ? " is stuck" : "", error_text(i)));
        if (!flat.empty())
            sentences_.push_back(fmt::format("{}: what is left there is most likely bias, which more time does not "
                                             "remove.",
                                             readable_list(flat)));
    }

    void say_near_floor() {
        std::vector<std::string> near;
        for (std::size_t i : all_.ranking) {
            if (!near_floor(i) || below_floor(i)) // the first sentence has told of those below
                continue;
            const auto from = near_floor_from(all_.curves[i], scene_.reference, region_);
            near.push_back(fmt::format("{} (from {} on)", label(i), readable_seconds(from.value_or(*all_.equal_time))));
        }
        if (!near.empty())
            sentences_.push_back(fmt::format("{} {} within a factor of three of the reference's own error, {}, so "
                                             "ratios with {} are rough.",
                                             readable_list(near), near.size() == 1 ? "is" : "are", floor(),
                                             near.size() == 1 ? "it" : "them"));
    }

    void say_slope() {
        if (sentences_.size() >= many_sentences || near_floor(best()) || stuck(best()) || error(best()) == 0.0)
            return;
        const auto slope = fitted_slope(all_.curves[best()]);
        if (!slope) {
            sentences_.push_back("The curves are too short yet to say how the error falls with time.");
            return;
        }
        const auto halving = time_to_halve(slope);
        if (halving && *slope < -flat_slope)
            sentences_.push_back(fmt::format("Halving the error of {} takes {} times the time.", label(best()),
                                             readable_number(*halving)));
    }

    void say_single_repeat() {
        if (all_.ranking.size() > 1 && tied_.size() == 1 &&
            std::any_of(all_.ranking.begin(), all_.ranking.end(), [&](std::size_t i) { return !repeated(i); }))
            sentences_.push_back("There is a single repeat, so how far chance moves these numbers is not known.");
    }
};

} // namespace

std::string describe(const SceneResults& scene, const RunGroup& group, std::size_t region,
                     const Comparison& comparison) {
    return Paragraph(scene, group, region, comparison).text();
}

} // namespace tristim
