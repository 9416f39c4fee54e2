#include "selftest/sequence_oracle.h"

#include "selftest/photon_oracle.h"

#include <array>
#include <cstddef>

namespace tristim::selftest {
namespace {

using Directions = std::array<std::uint32_t, 32>;

/// m_k of Bratley & Fox 1988, "Algorithm 659", for x⁵ + x³ + 1 with m = 1, 1, 5, 5, 5 to begin with:
/// m_k = 4 m_{k-2} ⊕ 32 m_{k-5} ⊕ m_{k-5}, divided by 2^{k+1}.
const Directions& directions() {
    static const Directions v = [] {
        std::array<std::uint64_t, 32> m{1, 1, 5, 5, 5};
        for (std::size_t k = 5; k < 32; ++k)
            m[k] = (m[k - 2] << 2U) ^ (m[k - 5] << 5U) ^ m[k - 5];
        Directions shifted{};
        for (std::size_t k = 0; k < 32; ++k)
            shifted[k] = static_cast<std::uint32_t>(m[k] << (31U - k));
        return shifted;
    }();
    return v;
}

std::uint32_t shift(std::uint32_t seed) {
    return photon::pcg4d({0U, 0x10000U, 0U, seed})[0];
}

} // namespace

std::uint32_t wavelength_position(std::uint32_t seed, std::uint32_t pass) {
    std::uint32_t x = shift(seed);
    for (std::size_t k = 0; k < 32; ++k)
        x ^= (pass >> k & 1U) != 0 ? directions()[k] : 0U;
    return x;
}

/// The lowest digit of direction number k is the (k + 1)-th: from the last on, each digit settles one of the pass.
std::uint32_t pass_of_wavelength_position(std::uint32_t seed, std::uint32_t position) {
    std::uint32_t rest = position ^ shift(seed);
    std::uint32_t pass = 0;
    for (std::size_t k = 32; k-- > 0;) {
        if ((rest >> (31U - k) & 1U) != 0) {
            pass |= 1U << k;
            rest ^= directions()[k];
        }
    }
    return pass;
}

std::uint32_t rotated(std::uint32_t position, std::uint32_t j, std::uint32_t n) {
    return static_cast<std::uint32_t>(((std::uint64_t{j} << 32U) + position) / n);
}

} // namespace tristim::selftest
