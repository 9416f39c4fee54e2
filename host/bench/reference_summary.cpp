#include "base/error.h"
#include "bench/reference.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace tristim {
namespace {

/// The mean of r²_i / r²_1 over the first passes of the global schedule: Knaus & Zwicker 2011, equation 15, summed by
/// Σ_{i=0}^{M} Γ(i+α)/Γ(i+1) = Γ(M+1+α) / (α Γ(M+1)).
double mean_squared_scale(double passes, double alpha) {
    const double sum =
        std::exp(std::lgamma(passes + 1.0 + alpha) - std::lgamma(passes + 1.0)) / alpha - std::tgamma(alpha);
    return sum / (std::tgamma(1.0 + alpha) * passes);
}

double alpha_of(const Reference& reference) {
    for (const auto& [name, value] : reference.settings) {
        if (name == "alpha")
            return std::strtod(value.c_str(), nullptr);
    }
    return radius_alpha;
}

/// Means over the pixels of a region and X, Y, Z.
struct RegionMeans {
    double squared_difference = 0.0; ///< of the two halves
    double product = 0.0; ///< of what separates the snapshot of a half from all its passes, of one half times the other
};

RegionMeans region_means(const Reference& reference, const Region& region) {
    const auto& [a, b] = reference.halves;
    RegionMeans sums;
    const Region& whole = reference.image.region;
    for (int y = region.y; y < region.y + region.height; ++y) {
        for (int x = region.x; x < region.x + region.width; ++x) {
            const auto i = static_cast<std::size_t>((y - whole.y) * whole.width + (x - whole.x));
            for (std::size_t c = 0; c < 3; ++c) {
                const double difference = static_cast<double>(a.xyz[i][c]) - b.xyz[i][c];
                sums.squared_difference += difference * difference;
                if (reference.snapshot_passes > 0)
                    sums.product += (static_cast<double>(a.snapshot[i][c]) - a.xyz[i][c]) *
                                    (static_cast<double>(b.snapshot[i][c]) - b.xyz[i][c]);
            }
        }
    }
    const double count = 3.0 * region.pixels();
    return {sums.squared_difference / count, sums.product / count};
}

} // namespace

ReferenceSummary summarise_reference(const Reference& reference, const std::vector<NamedRegion>& regions) {
    ReferenceSummary summary;
    summary.method = reference.method;
    summary.passes = reference.passes;
    summary.seconds = reference.seconds;
    summary.seed = reference.seed;
    // Density estimation blurs in proportion to r² (Knaus & Zwicker 2011, section 4), so a mean over passes is blurred
    // in proportion to its mean r², and the snapshot this much more than the image.
    const double alpha = alpha_of(reference);
    const auto passes = static_cast<double>(reference.passes);
    const double blur = reference.snapshot_passes == 0
                            ? 1.0
                            : mean_squared_scale(2.0 * static_cast<double>(reference.snapshot_passes), alpha) /
                                  mean_squared_scale(passes, alpha);
    // Weights of the halves in the image; Var(w_a a + w_b b) = w_a w_b Var(a − b), since variances are as 1/passes.
    const double weights = static_cast<double>(reference.halves[0].passes) / passes *
                           (static_cast<double>(reference.halves[1].passes) / passes);
    for (const NamedRegion& named : regions) {
        if (!contains(reference.image.region, named.region))
            fail("region \"{}\" is not inside the reference's", named.name);
        const RegionMeans means = region_means(reference, named.region);
        // The halves' noise is independent, so that it leaves the expectation of the product alone.
        const double bias = blur > 1.0 ? std::sqrt(std::max(means.product, 0.0)) / (blur - 1.0) : 0.0;
        summary.noise.push_back(std::sqrt(weights * means.squared_difference));
        summary.bias.push_back(bias);
        summary.floor.push_back(std::hypot(summary.noise.back(), bias));
    }
    return summary;
}

} // namespace tristim
