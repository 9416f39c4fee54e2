#include "bench/reference_snapshots.h"

#include <cmath>
#include <utility>

namespace tristim {

void ReferenceSnapshots::add(HalfFilms films) {
    films_.push_back(std::move(films));
    forget(films_.back()[0].passes);
}

const HalfFilms* ReferenceSnapshots::best(std::uint64_t passes) {
    forget(passes);
    return films_.empty() || films_.front()[0].passes >= passes ? nullptr : &films_.front();
}

void ReferenceSnapshots::forget(std::uint64_t passes) {
    const double wanted = wanted_share * static_cast<double>(passes);
    const auto distance = [wanted](const HalfFilms& films) {
        return std::abs(std::log(static_cast<double>(films[0].passes) / wanted));
    };
    // The first ones fall behind as the wanted number grows.
    while (films_.size() > 1 && films_[1][0].passes < passes && distance(films_[1]) <= distance(films_[0]))
        films_.erase(films_.begin());
}

} // namespace tristim
