// Reflected and refracted directions, frames, packed normals, and the maps from the unit square.

#include "selftest/optics_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tristim::selftest {
namespace {

using namespace optics;

std::string describe(const char* what, const cl_float4& v) {
    return fmt::format("{} ({:.9g}, {:.9g}, {:.9g}, {:.9g})", what, v.s[0], v.s[1], v.s[2], v.s[3]);
}

/// Rays at every cosine to a random normal, with 1/eta in the fourth component of the direction, and the normals.
struct Rays {
    std::vector<cl_float4> in;
    std::vector<float> eta, cosine;
};

Rays make_rays(const Setting& setting, std::uint32_t seed) {
    Random random(seed);
    Rays rays;
    const std::size_t repeats = inputs(setting, 4);
    for (const float eta : relative_indices()) {
        for (const float cosine : cosines()) {
            for (std::size_t i = 0; i < repeats; ++i) {
                const Vector n = random.direction();
                const Vector across = normalized(cross(n, random.direction()));
                const Real sine = std::sqrt((1.0L - cosine) * (1.0L + cosine));
                rays.in.push_back(float4_of(sine * across - static_cast<Real>(cosine) * n, 1.0F / eta));
                rays.in.push_back(float4_of(n));
                rays.eta.push_back(eta);
                rays.cosine.push_back(cosine);
            }
        }
    }
    return rays;
}

/// The part of a vector that lies across the unit vector n.
Vector across(const Vector& v, const Vector& n) {
    return v - dot(v, n) * n;
}

/// Of both directions the part along the surface, which Snell's law gives without a critical angle's singularity. It
/// scales by 1/eta, and so do the roundings of the direction.
Measurement tangential(const Setting& setting, const ::cl::Program& program) {
    const Rays rays = make_rays(setting, 1);
    const std::vector<cl_float4> out = run(setting, program, "bend", rays.in, 2, 2);
    Measurement found;
    for (std::size_t i = 0; i < rays.eta.size(); ++i) {
        const Vector d = normalized(vector_of(rays.in[2 * i])), n = normalized(vector_of(rays.in[2 * i + 1]));
        const Real inverse = rays.in[2 * i].s[3];
        const Vector along = across(d, n), bent = vector_of(out[2 * i + 1]), mirrored = vector_of(out[2 * i]);
        const Real of_reflection = length(mirrored - (along - dot(d, n) * n));
        Real of_refraction = length(across(bent, n) - inverse * along) / (1.0L + inverse);
        if (out[2 * i + 1].s[3] <= 0.0F)
            of_refraction = 0.0L; // total reflection: nobody takes it
        else if (dot(bent, n) > 1e-6L)
            of_refraction = INFINITY; // back to where it came from
        found.add(rays.cosine[i], static_cast<double>(std::max(of_reflection, of_refraction)), [&] {
            return describe("direction and 1/eta", rays.in[2 * i]) + describe(", normal", rays.in[2 * i + 1]);
        });
    }
    return found;
}

/// What the direction's length is off by grows by 1/eta², as its sine is magnified.
Measurement lengths(const Setting& setting, const ::cl::Program& program) {
    const Rays rays = make_rays(setting, 2);
    const std::vector<cl_float4> out = run(setting, program, "bend", rays.in, 2, 2);
    Measurement found;
    for (std::size_t i = 0; i < rays.eta.size(); ++i) {
        const Real inverse = rays.in[2 * i].s[3];
        const bool refracts = out[2 * i + 1].s[3] > 0.0F;
        const Real of_refraction =
            refracts ? std::abs(length(vector_of(out[2 * i + 1])) - 1.0L) / (1.0L + inverse * inverse) : 0.0L;
        const Real of_reflection = std::abs(length(vector_of(out[2 * i])) - 1.0L);
        found.add(rays.eta[i], static_cast<double>(std::max(of_reflection, of_refraction)), [&] {
            return describe("direction and 1/eta", rays.in[2 * i]) + describe(", normal", rays.in[2 * i + 1]);
        });
    }
    return found;
}

/// On the way out of each slab what the squared cosine within is off by grows by eta², and adds up.
Measurement slabs(const Setting& setting, const ::cl::Program& program) {
    Random random(3);
    std::vector<cl_float4> in;
    for (const float eta : relative_indices()) {
        for (std::size_t i = 0; eta >= 1.0F && i < inputs(setting, 64, 2); ++i) {
            const Vector n = random.direction();
            Vector d = random.direction();
            d = dot(d, n) > 0.0L ? -1.0L * d : d;
            in.push_back(float4_of(d, eta));
            in.push_back(float4_of(n));
        }
    }
    const std::vector<cl_float4> out = run(setting, program, "slabs", in, 2, 1);
    Measurement found;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const Real eta = in[2 * i].s[3], cosine = std::abs(dot(vector_of(in[2 * i]), vector_of(in[2 * i + 1])));
        const Real error = length(vector_of(out[i]) - vector_of(in[2 * i])) * cosine / (eta * eta);
        found.add(in[2 * i].s[3], static_cast<double>(error),
                  [&] { return describe("direction and eta", in[2 * i]) + describe(", normal", in[2 * i + 1]); });
    }
    return found;
}

Measurement mirrors(const Setting& setting, const ::cl::Program& program) {
    Random random(4);
    std::vector<cl_float4> in;
    for (std::size_t i = 0; i < inputs(setting, 4096, 16); ++i) {
        // Two mirrors, every fourth time parallel ones, and every eighth hit along their normal.
        const Vector n = random.direction();
        const Vector d = i % 8 == 0 ? -1.0L * n : random.direction();
        in.push_back(float4_of(d));
        in.push_back(float4_of(n));
        in.push_back(float4_of(i % 4 == 0 ? -1.0L * n : random.direction()));
    }
    const std::vector<cl_float4> out = run(setting, program, "mirrors", in, 3, 5);
    Measurement found;
    for (std::size_t i = 0; i < out.size(); ++i)
        found.add(2.0 * std::pow(4.0, static_cast<double>(i % 5)),
                  static_cast<double>(std::abs(length(vector_of(out[i])) - 1.0L)),
                  [&] { return describe("direction", in[3 * (i / 5)]) + describe(", normal", in[3 * (i / 5) + 1]); });
    return found;
}

Measurement frames(const Setting& setting, const ::cl::Program& program) {
    Random random(5);
    std::vector<cl_float4> in;
    std::vector<double> above; // 1 + n.z
    std::vector<float> steps = ratio_steps(1e-15, 2.0, 60);
    steps.insert(steps.end(), {0.0F, 1.0F});
    for (const float step : steps) {
        for (std::size_t i = 0; i < inputs(setting, 64, 2); ++i) {
            const Real z = static_cast<Real>(step) - 1.0L, sine = std::sqrt(step * (2.0L - step));
            const Real phi = i < 2 ? 0.5L * pi * i : 2.0L * pi * random();
            in.push_back(
                float4_of(Vector{sine * std::cos(phi), sine * std::sin(phi), i == 2 && z == 0.0L ? -0.0L : z}));
            in.push_back(float4_of(random.direction()));
            above.push_back(step);
        }
    }
    const std::vector<cl_float4> out = run(setting, program, "frames", in, 2, 3);
    Measurement found;
    for (std::size_t i = 0; i < above.size(); ++i) {
        const Vector n = vector_of(in[2 * i]), s = vector_of(out[3 * i]), t = vector_of(out[3 * i + 1]);
        const Real error = std::max({std::abs(dot(s, s) - 1.0L), std::abs(dot(t, t) - 1.0L), std::abs(dot(s, t)),
                                     std::abs(dot(s, n)), std::abs(dot(t, n)), length(cross(s, t) - n),
                                     length(vector_of(out[3 * i + 2]) - vector_of(in[2 * i + 1]))});
        // max() passes over a NaN that is not its first argument.
        found.add(above[i], static_cast<double>(std::isfinite(dot(s, t)) ? error : INFINITY),
                  [&] { return describe("normal", in[2 * i]); });
    }
    return found;
}

Measurement octahedral(const Setting& setting, const ::cl::Program& program) {
    Random random(6);
    std::vector<cl_float4> in;
    std::vector<double> height;
    for (int step = -32; step <= 32; ++step) {
        for (std::size_t i = 0; i < inputs(setting, 512, 10); ++i) {
            // Heights between the steps too, the folds at quarter turns and the diagonals of the octahedron's faces.
            const Real z = std::clamp((step + (i < 8 ? 0.0L : random() - 0.5L)) / 32.0L, -1.0L, 1.0L);
            const Real phi = i < 8 ? 0.25L * pi * i : 2.0L * pi * random();
            const Real sine = std::sqrt((1.0L - z) * (1.0L + z));
            in.push_back(float4_of(Vector{sine * std::cos(phi), sine * std::sin(phi), z}));
            height.push_back(step / 32.0);
        }
    }
    const std::vector<cl_float4> out = run(setting, program, "octahedral", in, 1, 1);
    Measurement found;
    for (std::size_t i = 0; i < in.size(); ++i) {
        const Vector n = normalized(vector_of(in[i])), unpacked = vector_of(out[i]);
        const Real angle = std::atan2(length(cross(n, unpacked)), dot(n, unpacked));
        found.add(height[i], static_cast<double>(angle), [&] { return describe("normal", in[i]); });
    }
    return found;
}

/// The maps of the unit square, at its edges and corners and within. Beside them, whether the results lie where they
/// must: on the sphere, above the plane, in the triangle.
Measurement square_maps(const Setting& setting, const ::cl::Program& program) {
    Random random(7);
    std::vector<float> edges{0.0F, 0x1p-24F, 0x1p-23F, 1e-6F, 1e-4F, 0.125F, 0.25F, 0.5F, 0.75F, 1.0F - 0x1p-12F};
    edges.insert(edges.end(), {0.5F - 0x1p-24F, 0.5F + 0x1p-24F, 1.0F - 0x1p-23F, 1.0F - 0x1p-24F});
    std::vector<cl_float4> in;
    for (const float x : edges) {
        for (const float y : edges)
            in.push_back(float4_of(x, y));
        for (std::size_t i = 0; i < inputs(setting, 512, 2); ++i)
            in.push_back(float4_of(x, random.unit_float()));
    }
    const std::vector<cl_float4> out = run(setting, program, "samples", in, 1, 3);
    Measurement found;
    for (std::size_t i = 0; i < in.size(); ++i) {
        const Real x = in[i].s[0], y = in[i].s[1], angle = 2.0L * pi * y;
        const Vector turned{std::cos(angle), std::sin(angle), 0.0L};
        const Vector disc = std::sqrt(x) * turned;
        const Vector hemisphere{disc[0], disc[1], std::sqrt(1.0L - x)};
        const Vector sphere = 2.0L * std::sqrt(x * (1.0L - x)) * turned + Vector{0.0L, 0.0L, 1.0L - 2.0L * x};
        const Vector triangle = x < y ? Vector{0.5L * x, y - 0.5L * x, 0.0L} : Vector{x - 0.5L * y, 0.5L * y, 0.0L};
        const Vector b{out[3 * i].s[2], out[3 * i].s[3], 0.0L};
        const Vector of_hemisphere = vector_of(out[3 * i + 1]), of_sphere = vector_of(out[3 * i + 2]);
        // sin² = 1 - cos² has the absolute error of the cosine's rounding: at the poles only the square is right.
        const Vector pole{of_sphere[0] - sphere[0], of_sphere[1] - sphere[1], 0.0L};
        const Real of_pole = length(pole) * (length(pole) + 2.0L * length(Vector{sphere[0], sphere[1], 0.0L}));
        const Real error = length(Vector{out[3 * i].s[0], out[3 * i].s[1], 0.0L} - disc) + length(b - triangle) +
                           length(of_hemisphere - hemisphere) + std::min(length(pole), of_pole) +
                           std::abs(of_sphere[2] - sphere[2]);
        const bool inside = of_hemisphere[2] >= 0.0L && b[0] >= 0.0L && b[1] >= 0.0L && b[0] + b[1] <= 1.0L;
        found.add(in[i].s[0], static_cast<double>(inside ? error : INFINITY), [&] { return describe("u =", in[i]); });
    }
    return found;
}

} // namespace

std::vector<Case> direction_cases(const Programs& cores) {
    const auto with = [&cores](Measurement (*measure)(const Setting&, const ::cl::Program&)) {
        return [cores, measure](const Setting& setting) { return measure(setting, cores(setting)); };
    };
    return {{"optics", "reflected and refracted rays, eta 0.1 to 10", "cos",
             "component along the surface / (1 + 1/eta)", 1e-6, 1e-6, with(tangential)},
            {"optics", "their length", "eta", "length / (1 + 1/eta²)", 1e-6, 1e-6, with(lengths)},
            {"optics", "through 64 slabs, eta 1 to 10", "eta", "direction · cos / eta²", 1e-5, 1e-5, with(slabs)},
            {"optics", "512 mirrors", "reflections", "length", 1.5e-4, 1.5e-4, with(mirrors)},
            {"optics", "frames, n.z -1 to 1", "1 + n.z", "orthonormality", 5e-7, 5e-7, with(frames)},
            {"optics", "packed normals", "n.z", "angle / rad", 6.5e-5, 6.5e-5, with(octahedral)},
            {"optics", "maps of the unit square, u 0 to 1 - 2^-24", "u.x", "position", 1e-6, 1e-6, with(square_maps)}};
}

} // namespace tristim::selftest
