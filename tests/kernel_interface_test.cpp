// scatter at smooth surfaces with films (kernels/interface.h), against double precision: what is reflected, transmitted
// and lost for each wavelength, and where to.

#include "interface_surfaces.h"
#include "microfacet_oracle.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

namespace tristim {
namespace {

using namespace kernel_test;

/// What is done with a share of u.x of paths is chosen evenly over [0, 1), so that sums over the middles of N pieces
/// are right to half a path.
void check_smooth(const InterfaceProgram& program, const CoatedSurface& surface, bool outside, double degrees,
                  int old_slot, bool radiance) {
    constexpr std::size_t count = 1 << 14;
    const auto [s, t] = tangents(normal);
    const double cosine = std::cos(degrees * std::numbers::pi / 180.0);
    const Vec3 along = std::sin(degrees * std::numbers::pi / 180.0) * (0.6 * s + 0.8 * t);
    const Vec3 direction = along + (outside ? -cosine : cosine) * normal;
    constexpr int slot = 3;
    std::vector<cl_float4> u;
    for (std::size_t i = 0; i < count; ++i)
        u.push_back({{(static_cast<float>(i) + 0.5F) / count, 0.0F, 0.0F, 0.0F}});
    const std::vector<ScatteredPath> paths = program.scatter(
        surface, std::vector<cl_float4>(count, float4_of(direction)), u, normal, s, old_slot, slot, radiance);

    const bool chooses_slot = surface.dispersive && old_slot == SLOT_ALL;
    const int kept = chooses_slot ? slot : old_slot;
    const std::string where = fmt::format("{}, from {}, {}°, slot {}{}", surface.name, outside ? "outside" : "inside",
                                          degrees, old_slot, radiance ? ", radiance" : "");
    const double eta = surface.n[static_cast<std::size_t>(std::max(kept, 0))];
    const double inverse_eta = outside ? 1.0 / eta : eta;
    const Vec3 reflection = direction - 2.0 * dot(direction, normal) * normal;
    const double sine2 = dot(along, along) * inverse_eta * inverse_eta;
    const Vec3 refraction =
        inverse_eta * along + (outside ? -1.0 : 1.0) * std::sqrt(std::max(0.0, 1.0 - sine2)) * normal;

    std::array<double, test_wavelengths> reflected{}, transmitted{};
    std::array<double, test_wavelengths> largest{};
    for (const ScatteredPath& path : paths) {
        if (!path.goes_on)
            continue;
        const bool up = (dot(vec3(path.direction), normal) >= 0.0) == outside;
        ASSERT_LT(length(vec3(path.direction) - (up ? reflection : refraction)), 4e-6) << where;
        ASSERT_EQ(path.pdf, 0.0F) << where;
        ASSERT_EQ(path.slot, kept) << where;
        for (std::size_t w = 0; w < test_wavelengths; ++w) {
            const double weight = path.weight(w);
            (up ? reflected : transmitted)[w] += weight / count;
            largest[w] = std::max(largest[w], weight);
        }
    }
    for (std::size_t w = 0; w < test_wavelengths; ++w) {
        if (kept >= 0 && kept != static_cast<int>(w))
            continue;
        const double before = old_slot >= 0 ? 1.0 : first_weights[w] * (chooses_slot ? test_wavelengths : 1.0);
        const double factor = radiance ? inverse_eta * inverse_eta : 1.0;
        const SharesOfPower shares = surface.shares(w, cosine, outside);
        const double tolerance = 0.5 / count * largest[w] + film_error * before * std::max(factor, 1.0);
        EXPECT_NEAR(reflected[w], before * shares.reflected, tolerance) << where << ", wavelength " << w;
        EXPECT_NEAR(transmitted[w], before * shares.transmitted * factor, tolerance) << where << ", wavelength " << w;
    }
}

TEST(KernelInterface, SmoothFilmsReflectTransmitAndAbsorbTheOraclesShares) {
    const InterfaceProgram program;
    for (const CoatedSurface& surface : smooth_surfaces()) {
        for (const double degrees : {0.5, 30.0, 41.0, 42.5, 60.0, 85.0}) { // glass reflects totally from 41.8° on
            for (const int old_slot : {SLOT_ALL, 4}) {
                check_smooth(program, surface, true, degrees, old_slot, false);
                if (surface.kind == MATERIAL_CONDUCTOR)
                    continue;
                check_smooth(program, surface, true, degrees, old_slot, true);
                check_smooth(program, surface, false, degrees, old_slot, false);
                check_smooth(program, surface, false, degrees, old_slot, true);
            }
        }
    }
}

/// A conductor has no inside: a sheet shows the same film from both sides, as without one.
TEST(KernelInterface, ConductorsReflectAlikeFromBothSides) {
    const InterfaceProgram program;
    const auto [s, t] = tangents(normal);
    for (const CoatedSurface& surface : smooth_surfaces()) {
        if (surface.kind != MATERIAL_CONDUCTOR)
            continue;
        for (const double degrees : {5.0, 50.0, 80.0}) {
            const double cosine = std::cos(degrees * std::numbers::pi / 180.0);
            const Vec3 direction = std::sqrt(1.0 - cosine * cosine) * t + cosine * normal;
            const ScatteredPath path = program.scatter(surface, {float4_of(direction)}, {{{0.5F, 0.0F, 0.0F, 0.0F}}},
                                                       normal, s, SLOT_ALL, 0, true)[0];
            ASSERT_TRUE(path.goes_on) << surface.name << ", " << degrees << "°";
            for (std::size_t w = 0; w < test_wavelengths; ++w)
                EXPECT_NEAR(path.weight(w), first_weights[w] * surface.shares(w, cosine, true).reflected,
                            film_error * first_weights[w])
                    << surface.name << ", " << degrees << "°, wavelength " << w;
        }
    }
}

} // namespace
} // namespace tristim
