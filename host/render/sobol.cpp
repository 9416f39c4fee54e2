#include "render/sobol.h"

#include <array>
#include <cstddef>

namespace tristim {
namespace {

/// Degree s and inner coefficients a of a primitive polynomial, and the initial m_1 … m_s.
struct Polynomial {
    unsigned degree;
    std::uint32_t coefficients;
    std::array<std::uint32_t, 5> m;
};

constexpr std::array<Polynomial, sobol_dimensions - 1> polynomials{{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
}};

std::uint32_t reverse_bits(std::uint32_t x) {
    std::uint32_t reversed = 0;
    for (int bit = 0; bit < 32; ++bit)
        reversed |= (x >> bit & 1u) << (31 - bit);
    return reversed;
}

} // namespace

std::vector<std::uint32_t> sobol_direction_numbers(int dimension) {
    std::vector<std::uint32_t> v(32);
    if (dimension == 0) { // van der Corput
        for (std::size_t k = 0; k < 32; ++k)
            v[k] = 1u << (31 - k);
        return v;
    }
    const Polynomial& p = polynomials[static_cast<std::size_t>(dimension - 1)];
    for (std::size_t k = 0; k < 32; ++k) {
        if (k < p.degree) {
            v[k] = p.m[k] << (31 - k);
            continue;
        }
        v[k] = v[k - p.degree] ^ (v[k - p.degree] >> p.degree);
        for (unsigned i = 1; i < p.degree; ++i) {
            if ((p.coefficients >> (p.degree - 1 - i) & 1u) != 0)
                v[k] ^= v[k - i];
        }
    }
    return v;
}

std::vector<std::uint32_t> sobol_table() {
    std::vector<std::vector<std::uint32_t>> directions;
    for (int dimension = 0; dimension < sobol_dimensions; ++dimension)
        directions.push_back(sobol_direction_numbers(dimension));
    std::vector<std::uint32_t> table;
    for (std::size_t byte = 0; byte < 4; ++byte) {
        for (std::uint32_t value = 0; value < 256; ++value) {
            for (const std::vector<std::uint32_t>& v : directions) {
                std::uint32_t x = 0;
                for (std::size_t bit = 0; bit < 8; ++bit) {
                    if ((value >> bit & 1u) != 0)
                        x ^= v[8 * byte + bit];
                }
                table.push_back(reverse_bits(x));
            }
        }
    }
    return table;
}

} // namespace tristim
