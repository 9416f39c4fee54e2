#pragma once

#include "shared_types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tristim::selftest::photon {

/// pcg4d as Jarzynski & Olano 2020, listing in section 5, print it, in 64-bit arithmetic modulo 2^32, with the mix that
/// kernels/rng.h adds at its end.
std::array<std::uint32_t, 4> pcg4d(const std::array<std::uint32_t, 4>& v);

/// Wellons 2018's lowbias32 of key + step 2^32/φ.
std::uint32_t step_hash(std::uint32_t key, std::uint32_t step);

/// A number of the Sobol' sequence in [0, 2^24): direction numbers combined bit by bit, then Burley 2020's permutation
/// of the reversed bits.
std::uint32_t scrambled_sobol(int dimension, std::uint32_t index, std::uint32_t scramble);

/// r²_i / r²_1 of Knaus & Zwicker 2011, equation 15, as a root: Γ(i+α) / (Γ(1+α) Γ(i+1)) in long double, by Stirling's
/// series, whose error is below 1e-18 from an argument of 40 on (Abramowitz & Stegun 1964, 6.1.41); below, the product.
double exact_radius_scale(std::uint32_t pass, double alpha);

/// What a visible point gathers of diffuse photons that carry XYZ, in double precision, by looking at all of them:
/// flux · throughput / paths, and their number. Photons whose distance is within `margin` of the radius may belong or
/// not.
struct Found {
    std::array<double, 3> flux{}, doubtful{};
    std::uint32_t count = 0, doubtful_count = 0;
};
Found gather_from_all(const VisiblePoint& point, const std::array<double, 3>& normal,
                      const std::vector<Photon>& photons, const std::vector<std::array<double, 3>>& normals,
                      std::uint32_t paths, double margin);

} // namespace tristim::selftest::photon
