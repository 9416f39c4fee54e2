#include "selftest/photon_oracle.h"

#include "render/sobol.h"

#include <cmath>

namespace tristim::selftest::photon {
namespace {

constexpr std::uint64_t modulus = std::uint64_t{1} << 32U;

/// log Γ(x) − (x − 1/2) log x + x − log √2π: Stirling's series.
long double stirling_rest(long double x) {
    const long double y = 1.0L / (x * x);
    return (1.0L / 12 - y * (1.0L / 360 - y * (1.0L / 1260 - y * (1.0L / 1680 - y * (1.0L / 1188))))) / x;
}

/// log(Γ(n + a) / Γ(n + 1)), written so that the large logarithms cancel on paper.
long double log_gamma_ratio(long double n, long double a) {
    const long double x = n + a;
    const long double z = n + 1.0L;
    return (x - 0.5L) * std::log1p((a - 1.0L) / z) + (a - 1.0L) * std::log(z) - (a - 1.0L) + stirling_rest(x) -
           stirling_rest(z);
}

} // namespace

std::array<std::uint32_t, 4> pcg4d(const std::array<std::uint32_t, 4>& v) {
    std::array<std::uint64_t, 4> s{};
    for (std::size_t i = 0; i < 4; ++i)
        s[i] = (std::uint64_t{v[i]} * 1664525U + 1013904223U) % modulus;
    const auto cross = [&s] {
        constexpr std::array<std::array<std::size_t, 3>, 4> steps{{{0, 1, 3}, {1, 2, 0}, {2, 0, 1}, {3, 1, 2}}};
        for (const auto& [to, a, b] : steps)
            s[to] = (s[to] + s[a] * s[b]) % modulus;
    };
    const auto fold = [&s] {
        for (std::uint64_t& x : s)
            x ^= x / 65536U;
    };
    cross();
    fold();
    cross();
    fold();
    std::array<std::uint32_t, 4> out{};
    for (std::size_t i = 0; i < 4; ++i)
        out[i] = static_cast<std::uint32_t>(s[i]);
    return out;
}

std::uint32_t step_hash(std::uint32_t key, std::uint32_t step) {
    std::uint64_t x = (key + step * std::uint64_t{0x9e3779b9U}) % modulus;
    for (const std::uint64_t factor : {0x7feb352dULL, 0x846ca68bULL}) {
        x ^= factor == 0x7feb352dULL ? x / 65536U : x / 32768U;
        x = x * factor % modulus;
    }
    return static_cast<std::uint32_t>(x ^ x / 65536U);
}

std::uint32_t scrambled_sobol(int dimension, std::uint32_t index, std::uint32_t scramble) {
    const std::vector<std::uint32_t> directions = sobol_direction_numbers(dimension);
    std::uint32_t x = 0;
    for (std::size_t bit = 0; bit < 32; ++bit)
        x ^= (index >> bit & 1U) != 0 ? directions[bit] : 0U;
    const auto reversed = [](std::uint32_t v) {
        std::uint32_t r = 0;
        for (int bit = 0; bit < 32; ++bit, v /= 2)
            r = 2 * r + v % 2;
        return r;
    };
    std::uint64_t y = (std::uint64_t{reversed(x)} + scramble) % modulus;
    for (const std::uint64_t factor : {0x6c50b47cULL, 0xb82f1e52ULL, 0xc7afe638ULL, 0x8d22f6e6ULL})
        y ^= y * factor % modulus;
    return reversed(static_cast<std::uint32_t>(y)) >> 8U;
}

double exact_radius_scale(std::uint32_t pass, double alpha) {
    constexpr std::uint32_t first_of_series = 40;
    const long double a = alpha;
    long double logarithm = 0.0L;
    for (std::uint32_t i = 1; i <= std::min(pass, first_of_series); ++i)
        logarithm += std::log((i + a) / (i + 1.0L));
    if (pass > first_of_series)
        logarithm += log_gamma_ratio(pass + 1.0L, a) - log_gamma_ratio(first_of_series + 1.0L, a);
    return static_cast<double>(std::exp(0.5L * logarithm));
}

Found gather_from_all(const VisiblePoint& point, const std::array<double, 3>& normal,
                      const std::vector<Photon>& photons, const std::vector<std::array<double, 3>>& normals,
                      std::uint32_t paths, double margin) {
    Found found;
    for (std::size_t i = 0; i < photons.size(); ++i) {
        const Photon& photon = photons[i];
        const double x = double{photon.x} - point.x;
        const double y = double{photon.y} - point.y;
        const double z = double{photon.z} - point.z;
        const double distance = std::sqrt(x * x + y * y + z * z);
        const double cosine = normal[0] * normals[i][0] + normal[1] * normals[i][1] + normal[2] * normals[i][2];
        if (cosine < 0.5 || distance > point.radius + margin)
            continue;
        const bool doubtful = distance > point.radius - margin;
        ++(doubtful ? found.doubtful_count : found.count);
        const std::array<double, 3> flux{photon.flux_x, photon.flux_y, photon.flux_z};
        for (std::size_t c = 0; c < 3; ++c)
            (doubtful ? found.doubtful : found.flux)[c] += flux[c] * point.throughput / paths;
    }
    return found;
}

} // namespace tristim::selftest::photon
