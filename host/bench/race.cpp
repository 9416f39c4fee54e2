#include "bench/race.h"

#include <algorithm>

namespace tristim {

void run_race(std::vector<Contestant>& contestants, const XyzImage& reference, const std::vector<NamedRegion>& regions,
              double slice, const RaceProgress& progress) {
    const auto seconds = [&] {
        double sum = 0.0;
        for (const Contestant& contestant : contestants)
            sum += contestant.seconds();
        return sum;
    };
    while (progress(seconds())) {
        const auto next =
            std::min_element(contestants.begin(), contestants.end(), [](const Contestant& a, const Contestant& b) {
                return std::pair(a.finished(), a.seconds()) < std::pair(b.finished(), b.seconds());
            });
        if (next == contestants.end() || next->finished())
            return;
        next->render(slice);
        if (next->at_checkpoint())
            next->measure(reference, regions);
    }
}

} // namespace tristim
