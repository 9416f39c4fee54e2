// scatter and evaluate_rough at rough surfaces with films (kernels/interface.h), against double precision: what is
// reflected, transmitted and lost for each wavelength, where to, and with which pdf.

#include "interface_surfaces.h"
#include "microfacet_oracle.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace kernel_test;

std::vector<CoatedSurface> rough_surfaces() {
    std::vector<CoatedSurface> rough;
    std::vector<CoatedSurface> smooth = smooth_surfaces();
    for (const std::size_t i : {0U, 2U, 3U, 4U}) {
        rough.push_back(smooth[i]);
        rough.back().alpha = i == 0 ? cl_float2{{0.3F, 0.3F}} : cl_float2{{0.15F, 0.4F}};
    }
    rough.push_back(smooth[0]);
    rough.back().name = "bare glass";
    rough.back().layers.clear();
    rough.back().alpha = {{0.1F, 0.1F}};
    return rough;
}

/// The frame in which `program.scatter` and `evaluate` see a surface: the tangent, across it, and the normal on one
/// side.
struct RoughFrame {
    Vec3 s, t, n;
    explicit RoughFrame(bool outside) : s(tangents(normal)[0]), n((outside ? 1.0 : -1.0) * normal) { t = cross(n, s); }
    Vec3 to_world(const Vec3& v) const { return v[0] * s + v[1] * t + v[2] * n; }
    Vec3 from_world(const Vec3& v) const { return {dot(v, s), dot(v, t), dot(v, n)}; }
};

/// A surface's shares of power as functions of the cosine, tabulated: the oracle is slow.
class TabulatedShares {
  public:
    TabulatedShares(const CoatedSurface& surface, bool outside) {
        for (std::size_t i = 0; i <= steps; ++i) {
            for (std::size_t w = 0; w < test_wavelengths; ++w)
                table_.push_back(surface.shares(w, static_cast<double>(i) / steps, outside));
        }
    }
    SharesOfPower at(std::size_t w, double cosine) const {
        const double x = std::clamp(cosine, 0.0, 1.0) * steps;
        const auto i = std::min(static_cast<std::size_t>(x), steps - 1);
        const double f = x - static_cast<double>(i);
        const SharesOfPower& a = table_[i * test_wavelengths + w];
        const SharesOfPower& b = table_[(i + 1) * test_wavelengths + w];
        return {a.reflected + f * (b.reflected - a.reflected), a.transmitted + f * (b.transmitted - a.transmitted)};
    }

  private:
    static constexpr std::size_t steps = 2000;
    std::vector<SharesOfPower> table_;
};

/// As the next one, tabulated.
double reflection_probability(const TabulatedShares& shares, int slot, double cosine) {
    double reflected = 0.0, transmitted = 0.0;
    for (std::size_t w = 0; w < test_wavelengths; ++w) {
        const double weight = slot < 0 ? first_weights[w] : slot == static_cast<int>(w) ? 1.0 : 0.0;
        const SharesOfPower s = shares.at(w, cosine);
        reflected += weight * s.reflected;
        transmitted += weight * s.transmitted;
    }
    return reflected / (reflected + transmitted);
}

Vec3 refracted(const Vec3& wo, const Vec3& m, double inverse_eta) {
    const double cosine = dot(wo, m);
    const double cos2_t = 1.0 - (1.0 - cosine * cosine) * inverse_eta * inverse_eta;
    return -inverse_eta * wo + (inverse_eta * cosine - std::sqrt(std::max(0.0, cos2_t))) * m;
}

/// One wavelength's, or for SLOT_ALL the path's, probability of reflection.
double reflection_probability(const CoatedSurface& surface, bool outside, int slot, double cosine) {
    double reflected = 0.0, transmitted = 0.0;
    for (std::size_t w = 0; w < test_wavelengths; ++w) {
        if (slot >= 0 && slot != static_cast<int>(w))
            continue;
        const double weight = slot < 0 ? first_weights[w] : 1.0;
        const SharesOfPower s = surface.shares(w, std::min(cosine, 1.0), outside);
        reflected += weight * s.reflected;
        transmitted += weight * s.transmitted;
    }
    return reflected / (reflected + transmitted);
}

/// What the oracle says of two directions in the frame on wo's side.
struct Scattering {
    double value = 0.0;    ///< [1/sr], the BSDF that scatters flux
    double geometry = 0.0; ///< of which the facets' share of power is this times
    double pdf = 0.0;      ///< [1/sr], given the choice between reflection and refraction
};
Scattering scattering(const CoatedSurface& surface, bool outside, const Vec3& wo, const Vec3& wi, std::size_t w) {
    const Ggx ggx(surface.alpha);
    if (wi[2] > 0.0) {
        const double geometry = ggx.reflection(wo, wi);
        const double cosine = std::min(dot(wo, Ggx::reflecting(wo, wi)), 1.0);
        return {geometry * surface.shares(w, cosine, outside).reflected, geometry, ggx.reflection_pdf(wo, wi)};
    }
    const double eta = outside ? surface.n[w] : 1.0 / surface.n[w];
    const Vec3 m = Ggx::refracting(wo, wi, eta);
    if (surface.kind == MATERIAL_CONDUCTOR || !Ggx::refracts(wo, wi, m))
        return {};
    const double geometry = ggx.refraction(wo, wi, eta);
    return {geometry * surface.shares(w, std::min(dot(wo, m), 1.0), outside).transmitted, geometry,
            ggx.refraction_pdf(wo, wi, eta)};
}

/// The kernel's directions and half vectors are right to some 15 units (half_vector_units): what such a change of a
/// direction does to a value is granted.
constexpr double direction_error = 16.0 * unit_roundoff;

struct RoughCase {
    const CoatedSurface* surface;
    bool outside;
    double degrees;
    int slot; ///< the path's, before and after
};

/// Facets in 8×8 bins of the lune that wo sees, for reflection and for refraction, and one bin for paths that end.
void check_rough(const InterfaceProgram& program, const RoughCase& test) {
    constexpr std::size_t count = 1 << 16, bins = 8, points = 40;
    const CoatedSurface& surface = *test.surface;
    const std::string where = fmt::format("{}, from {}, {}°, slot {}", surface.name,
                                          test.outside ? "outside" : "inside", test.degrees, test.slot);
    const Ggx ggx(surface.alpha);
    const RoughFrame frame(test.outside);
    const TabulatedShares shares(surface, test.outside);
    const double n = surface.n[static_cast<std::size_t>(std::max(test.slot, 0))];
    const double eta = test.outside ? n : 1.0 / n;
    const cl_float4 direction = float4_of(-1.0 * frame.to_world(at_angle(test.degrees, 0.15)));
    const Vec3 wo = frame.from_world(-1.0 * vec3(direction)); // as rounded
    const Lune lune(wo, surface.alpha);

    std::vector<double> expected(2 * bins * bins + 1, 0.0);
    std::array<double, test_wavelengths> reflected{}, transmitted{};
    double total = 0.0;
    for (std::size_t i = 0; i < bins * points; ++i) {
        for (std::size_t j = 0; j < bins * points; ++j) {
            const auto [m, solid_angle] = lune.facet((static_cast<double>(i) + 0.5) / (bins * points),
                                                     (static_cast<double>(j) + 0.5) / (bins * points));
            const double cosine = dot(wo, m);
            const double share = ggx.visible_pdf(wo, m) * solid_angle / (bins * points * bins * points);
            total += share;
            const double probability = reflection_probability(shares, test.slot, cosine);
            const std::size_t bin = i / points * bins + j / points;
            const Vec3 mirrored = 2.0 * cosine * m - wo, through = refracted(wo, m, 1.0 / eta);
            const bool is_mirrored = mirrored[2] > 0.0, is_through = through[2] < 0.0;
            expected[bin] += is_mirrored ? probability * share : 0.0;
            expected[bins * bins + bin] += is_through ? (1.0 - probability) * share : 0.0;
            for (std::size_t w = 0; w < test_wavelengths; ++w) {
                const SharesOfPower s = shares.at(w, cosine);
                if (is_mirrored)
                    reflected[w] += share * s.reflected * ggx.masking_shadowing(wo, mirrored) / ggx.masking(wo);
                if (is_through)
                    transmitted[w] += share * s.transmitted * ggx.masking_shadowing(wo, through) / ggx.masking(wo);
            }
        }
    }
    ASSERT_NEAR(total, 1.0, 1e-3) << where << ": the quadrature";
    for (std::size_t bin = 0; bin < 2 * bins * bins; ++bin)
        expected.back() -= expected[bin];
    expected.back() = std::max(expected.back() + 1.0, 0.0);
    // The quadrature may miss the corner of a bin that is all but cut off by the horizon.
    const auto counted_bin = [&](std::size_t bin) { return expected[bin] * count < 1.0 ? expected.size() - 1 : bin; };

    std::vector<cl_float4> u = random_hypercubes(count, 71);
    const std::vector<ScatteredPath> paths =
        program.scatter(surface, std::vector<cl_float4>(count, direction), u, normal, frame.s, test.slot, 0, false);
    Histogram histogram(expected.size());
    std::array<Moments, test_wavelengths> reflected_weight, transmitted_weight;
    for (std::size_t i = 0; i < count; ++i) {
        const ScatteredPath& path = paths[i];
        const Vec3 wi = frame.from_world(vec3(path.direction));
        const bool up = wi[2] > 0.0;
        for (std::size_t w = 0; w < test_wavelengths; ++w) {
            const double weight = path.goes_on ? path.weight(w) / (test.slot < 0 ? first_weights[w] : 1.0) : 0.0;
            reflected_weight[w].add(up ? weight : 0.0);
            transmitted_weight[w].add(up ? 0.0 : weight);
        }
        if (!path.goes_on) {
            histogram.add(expected.size() - 1);
            continue;
        }
        const Vec3 m = up ? Ggx::reflecting(wo, wi) : Ggx::refracting(wo, wi, eta);
        const auto [x, y] = lune.square(m);
        histogram.add(counted_bin((up ? 0 : bins * bins) + Histogram::bin(std::clamp(x, 0.0, 1.0), bins) * bins +
                                  Histogram::bin(std::clamp(y, 0.0, 1.0), bins)));
        if (i >= 200)
            continue;
        const double before = test.slot < 0 ? first_weights[i % test_wavelengths] : 1.0;
        const std::size_t w = test.slot < 0 ? i % test_wavelengths : static_cast<std::size_t>(test.slot);
        const Scattering there = scattering(surface, test.outside, wo, wi, w);
        const double probability = reflection_probability(surface, test.outside, test.slot, dot(wo, m));
        const double pdf = there.pdf * (up ? probability : 1.0 - probability);
        double pdf_tolerance = 2e-5 * pdf, tolerance = 2e-5 * there.value;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Vec3 moved = wi;
            moved[axis] += direction_error;
            const Scattering changed = scattering(surface, test.outside, wo, moved, w);
            const Vec3 h = up ? Ggx::reflecting(wo, moved) : Ggx::refracting(wo, moved, eta);
            const double p = reflection_probability(surface, test.outside, test.slot, dot(wo, h));
            pdf_tolerance += std::abs(changed.pdf * (up ? p : 1.0 - p) - pdf);
            tolerance += std::abs(changed.value - there.value);
        }
        ASSERT_NEAR(path.pdf, pdf, pdf_tolerance + 2.0 * film_error * there.pdf) << where;
        const double cosine = std::abs(wi[2]);
        ASSERT_NEAR(path.weight(w) * path.pdf, before * there.value * cosine,
                    before *
                        (tolerance * cosine + there.value * direction_error + film_error * there.geometry * cosine))
            << where << ", wavelength " << w << (up ? ", reflected" : ", refracted");
    }
    histogram.expect_distribution(where, expected);
    for (std::size_t w = 0; w < test_wavelengths; ++w) {
        if (test.slot >= 0 && test.slot != static_cast<int>(w))
            continue;
        // 1e-4: midpoints of the quadrature across the border where directions come out on the wrong side.
        expect_mean(fmt::format("{}, reflected, wavelength {}", where, w), reflected_weight[w].mean(), reflected[w],
                    reflected_weight[w].standard_error(), 1e-4);
        expect_mean(fmt::format("{}, transmitted, wavelength {}", where, w), transmitted_weight[w].mean(),
                    transmitted[w], transmitted_weight[w].standard_error(), 1e-4);
    }
}

TEST(KernelInterface, RoughFilmsScatterAsTheOracleSays) {
    const InterfaceProgram program;
    for (const CoatedSurface& surface : rough_surfaces()) {
        for (const double degrees : {0.0, 40.0, 75.0}) {
            for (const bool outside : {true, false}) {
                if (surface.kind == MATERIAL_CONDUCTOR && !outside)
                    continue;
                for (const int slot : {SLOT_ALL, 4}) {
                    if (slot == SLOT_ALL && surface.dispersive)
                        continue;
                    check_rough(program, {&surface, outside, degrees, slot});
                }
            }
        }
    }
}

/// f(wo, wi) against the oracle for directions that nothing chose, and light that goes the other way: the same but for
/// η².
TEST(KernelInterface, RoughFilmsAreReciprocal) {
    const InterfaceProgram program;
    Random random(72);
    for (const CoatedSurface& surface : rough_surfaces()) {
        constexpr int slot = 2;
        std::vector<cl_float4> wo, wi, back_wo, back_wi;
        for (int i = 0; i < 400; ++i) {
            Vec3 a = random.direction(), b = random.direction();
            a[2] = std::abs(a[2]);
            if (surface.kind == MATERIAL_CONDUCTOR)
                b[2] = std::abs(b[2]);
            wo.push_back(float4_of(a));
            wi.push_back(float4_of(b));
            // The frame of the other side: half a turn about x leaves alpha's axes.
            const auto turned = [](const cl_float4& v) { return cl_float4{{v.s[0], -v.s[1], -v.s[2], 0.0F}}; };
            const bool reflects = b[2] > 0.0;
            back_wo.push_back(reflects ? wi.back() : turned(wi.back()));
            back_wi.push_back(reflects ? wo.back() : turned(wo.back()));
        }
        for (const bool outside : {true, false}) {
            if (surface.kind == MATERIAL_CONDUCTOR && !outside)
                continue;
            const std::vector<double> there = program.evaluate(surface, wo, wi, outside, outside, slot);
            const std::vector<double> back = program.evaluate(surface, back_wo, back_wi, outside, !outside, slot);
            const double n = surface.n[slot];
            const double eta = outside ? n : 1.0 / n;
            int scattered = 0;
            for (std::size_t i = 0; i < wo.size(); ++i) {
                const Vec3 a = vec3(wo[i]), b = vec3(wi[i]);
                const bool reflects = b[2] > 0.0;
                const Scattering f = scattering(surface, outside, a, b, slot);
                double tolerance = 2e-5 * f.value + film_error * f.geometry;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    Vec3 a_moved = a, b_moved = b;
                    a_moved[axis] += direction_error;
                    b_moved[axis] += direction_error;
                    tolerance += std::abs(scattering(surface, outside, a, b_moved, slot).value - f.value) +
                                 std::abs(scattering(surface, outside, a_moved, b, slot).value - f.value);
                }
                scattered += f.value > 0.0 ? 1 : 0;
                const std::string where =
                    fmt::format("{}, {}, pair {}", surface.name, outside ? "outside" : "inside", i);
                ASSERT_NEAR(there[i], f.value, tolerance) << where;
                ASSERT_NEAR(back[i] * (reflects ? 1.0 : eta * eta), f.value, 2.0 * tolerance) << where;
            }
            EXPECT_GT(scattered, 100) << surface.name;
        }
    }
}

} // namespace
} // namespace tristim
