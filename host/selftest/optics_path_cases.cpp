// What smooth, coated and rough interfaces do to paths: choices, weights and directions, where one wavelength of a pass
// is totally reflected and another is not.

#include "opencl/buffer.h"
#include "selftest/optics_cases.h"
#include "shared_types.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace tristim::selftest {
namespace {

using namespace optics;

constexpr std::size_t wavelengths = 4;
constexpr float last_number = 1.0F - 0x1p-24F;

using PerWavelength = std::array<float, wavelengths>;
constexpr PerWavelength lambda{430.0F, 500.0F, 570.0F, 640.0F};

/// Materials and the rows of the pass's table that they need.
class Surfaces {
  public:
    Surfaces() {
        add_row(lambda);
        for (int weights = 0; weights < 3; ++weights)
            add_row({1.0F, 1.0F, 1.0F, 1.0F});
        zero_ = add_spectrum({});
    }

    int add_dielectric(const PerWavelength& eta, float alpha = 0.0F) {
        SurfaceMaterial material{};
        material.kind = MATERIAL_DIELECTRIC;
        material.eta = add_spectrum(eta);
        material.k = zero_;
        material.dispersive = std::count(eta.begin(), eta.end(), eta[0]) < 4 ? 1 : 0;
        material.film_texture = -1;
        material.alpha_u = material.alpha_v = alpha;
        materials_.push_back(material);
        return static_cast<int>(materials_.size()) - 1;
    }

    /// On the material added last.
    void add_film(float thickness, const PerWavelength& eta) {
        materials_.back().film = static_cast<int>(layers_.size());
        materials_.back().film_layers = 1;
        layers_.push_back({thickness, add_spectrum(eta), zero_, 0});
    }

    std::vector<cl_float4> scatter(const Setting& setting, const ::cl::Program& program,
                                   const std::vector<cl_float4>& in) const {
        std::vector<SceneFilmLayer> layers = layers_;
        layers.resize(std::max<std::size_t>(layers.size(), 1));
        const Buffer<float> table(setting.device, "selftest table", table_);
        const Buffer<SurfaceMaterial> materials(setting.device, "selftest materials", materials_);
        const Buffer<SceneFilmLayer> films(setting.device, "selftest films", layers);
        return run(setting, program, "scatter_path", in, 2, 3, {table.cl(), materials.cl(), films.cl()});
    }

  private:
    void add_row(const PerWavelength& row) { std::copy(row.begin(), row.end(), std::back_inserter(table_)); }
    int add_spectrum(const PerWavelength& row) {
        add_row(row);
        return static_cast<int>(table_.size() / wavelengths) - 1 - PASS_TABLE_SPECTRA;
    }

    std::vector<float> table_;
    std::vector<SurfaceMaterial> materials_;
    std::vector<SceneFilmLayer> layers_;
    int zero_ = 0;
};

/// A path as scatter left it.
struct Scattered {
    Vector direction;
    bool goes_on;
    Real scale;
    int slot;
    Real pdf;
    cl_float4 spectrum;

    explicit Scattered(const cl_float4* out)
        : direction(vector_of(out[0])), goes_on(out[0].s[3] > 0.0F), scale(out[1].s[0]),
          slot(static_cast<int>(out[1].s[1])), pdf(out[1].s[2]), spectrum(out[2]) {}

    Real weight(std::size_t w) const {
        return slot < 0 ? scale * spectrum.s[w] : slot == static_cast<int>(w) ? scale : 0.0L;
    }
};

/// A direction towards z = 0 from above or, `inside`, from below, at a cosine.
cl_float4 towards_plane(double cosine, bool inside, int material) {
    const double sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));
    return float4_of(0.6 * sine, 0.8 * sine, inside ? cosine : -cosine, material);
}

std::string describe(const cl_float4& direction, const cl_float4& numbers) {
    return fmt::format("direction ({:.9g}, {:.9g}, {:.9g}), material {}, u = ({:.9g}, {:.9g}, {:.9g}), slot {}",
                       direction.s[0], direction.s[1], direction.s[2], direction.s[3], numbers.s[0], numbers.s[1],
                       numbers.s[2], numbers.s[3]);
}

/// Four wavelengths in dispersive glass, from inside, at angles around all of their critical ones: the share of random
/// numbers that reflects a path must be the slot's own reflectance, and its weight W. Numbers next to the share, on
/// both sides, show where the choice turns; the error is how far from the share a wrong one lies.
Measurement dispersion(const Setting& setting, const ::cl::Program& program) {
    const PerWavelength etas{1.53F, 1.52F, 1.51F, 1.5F};
    Surfaces surfaces;
    const int glass = surfaces.add_dielectric(etas);
    std::vector<double> angles_of_interest;
    for (const float eta : etas) {
        const double critical = std::sqrt(1.0 - 1.0 / (static_cast<double>(eta) * eta));
        for (const float step : ratio_steps(1e-7, 1e-2, 10))
            angles_of_interest.insert(angles_of_interest.end(), {critical - step, critical + step});
    }
    std::vector<cl_float4> in;
    std::vector<Real> share;
    for (const double cosine : angles_of_interest) {
        for (std::size_t slot = 0; slot < wavelengths; ++slot) {
            const cl_float4 direction = towards_plane(cosine, true, glass);
            const Real reflected = reflectance(direction.s[2], 1.0L / static_cast<Real>(etas[slot]));
            for (const float step : ratio_steps(1e-7, 0.9, 12)) {
                for (const float sign : {-1.0F, 1.0F}) {
                    const Real u = reflected + sign * step;
                    if (u < 0.0L || u >= 1.0L)
                        continue;
                    in.push_back(direction);
                    in.push_back(
                        float4_of(std::min(static_cast<float>(u), last_number), 0.5, 0.5, static_cast<double>(slot)));
                    share.push_back(reflected);
                }
            }
        }
    }
    const std::vector<cl_float4> out = surfaces.scatter(setting, program, in);
    Measurement found;
    for (std::size_t i = 0; i < share.size(); ++i) {
        const Scattered path(out.data() + 3 * i);
        const cl_float4& numbers = in[2 * i + 1];
        const auto slot = static_cast<std::size_t>(numbers.s[3]);
        const bool reflected = path.direction[2] < 0.0L;
        // What the rounding of eta leaves open is no fault.
        const Real cosine = in[2 * i].s[2], n = 1.0L / static_cast<Real>(etas[slot]), u = numbers.s[0];
        Real error = reflected == (u < share[i]) ? 0.0L : reflectance_error(u, cosine, n, 2.0L);
        if (!path.goes_on || path.weight(slot) != 4.0L || !(std::abs(length(path.direction) - 1.0L) < 1e-5L))
            error = INFINITY;
        found.add(static_cast<double>(cosine), static_cast<double>(error),
                  [&] { return describe(in[2 * i], numbers); });
    }
    return found;
}

/// What all wavelengths of a path have in common is chosen by chance, what they have not is in their weights: chance
/// times weight must be each one's share. The film evanesces at some of the wavelengths and not at others. Reflected
/// paths are drawn by u = 0, transmitted ones by u → 1.
Measurement films(const Setting& setting, const ::cl::Program& program) {
    struct Coated {
        float base;
        PerWavelength film;
        float thickness;
    };
    const std::vector<Coated> coats{{1.5F, {0.93F, 0.96F, 0.99F, 1.02F}, 300.0F},
                                    {1.5F, {1.4F, 1.5F, 1.6F, 1.7F}, 450.0F},
                                    {1.0F, {1.3F, 1.32F, 1.34F, 1.36F}, 200.0F},
                                    {0.95F, {1.5F, 1.5F, 1.5F, 1.5F}, 0.0F},
                                    {1.5F, {1.5F, 1.5F, 1.5F, 1.5F}, 1000.0F}};
    Surfaces surfaces;
    std::vector<cl_float4> in;
    for (const Coated& coat : coats) {
        const int material = surfaces.add_dielectric({coat.base, coat.base, coat.base, coat.base});
        surfaces.add_film(coat.thickness, coat.film);
        std::vector<float> list = cosines();
        std::erase_if(list, [](float c) { return c < 1e-4F; });
        for (const float n : coat.film) { // sines at which the film begins to evanesce
            for (const float step : ratio_steps(1e-6, 1e-2, 8)) {
                for (const float sign : {-1.0F, 1.0F}) {
                    const double from_outside = 1.0 - std::pow(n + sign * step, 2),
                                 from_inside = 1.0 - std::pow((n + sign * step) / coat.base, 2);
                    for (const double c2 : {from_outside, from_inside}) {
                        if (c2 > 1e-8 && c2 < 1.0)
                            list.push_back(static_cast<float>(std::sqrt(c2)));
                    }
                }
            }
        }
        for (const float cosine : list) {
            for (const bool inside : {false, true}) {
                for (const float u : {0.0F, last_number}) {
                    in.push_back(towards_plane(cosine, inside, material));
                    in.push_back(float4_of(u, 0.5, 0.5, 0.0));
                }
            }
        }
    }
    const std::vector<cl_float4> out = surfaces.scatter(setting, program, in);
    Measurement found;
    for (std::size_t i = 0; i < in.size() / 2; ++i) {
        const Scattered path(out.data() + 3 * i);
        const cl_float4 &direction = in[2 * i], &numbers = in[2 * i + 1];
        const Coated& coat = coats[static_cast<std::size_t>(direction.s[3])];
        const bool inside = direction.s[2] > 0.0F, reflected = (path.direction[2] < 0.0L) == inside;
        const Real cosine = std::abs(direction.s[2]), n0 = inside ? coat.base : 1.0F, n2 = inside ? 1.0F : coat.base;
        std::array<Shares, wavelengths> shares{};
        Real all_reflected = 0.0L, all = 0.0L;
        for (std::size_t w = 0; w < wavelengths; ++w) {
            shares[w] = film_shares(cosine, coat.film[w] / n0, n0 * coat.thickness / lambda[w], n2 / n0);
            all_reflected += shares[w].reflected;
            all += shares[w].reflected + shares[w].transmitted;
        }
        const Real chance = reflected ? all_reflected / all : 1.0L - all_reflected / all;
        Real error = 0.0L;
        for (std::size_t w = 0; w < wavelengths; ++w) {
            const Real share = reflected ? shares[w].reflected : shares[w].transmitted;
            // Nothing goes on where nothing is transmitted.
            const Real weight = path.goes_on ? path.weight(w) : 0.0L;
            error = std::max(error, std::isfinite(weight) ? std::abs(weight * chance - share) : INFINITY);
        }
        found.add(static_cast<double>(cosine), static_cast<double>(error),
                  [&] { return describe(direction, numbers); });
    }
    return found;
}

/// Rough glass whose index is nearly or just that of its surroundings, from both sides: weights are those of the
/// microfacets' masking, at most 1, and pdfs are finite and positive.
Measurement rough_paths(const Setting& setting, const ::cl::Program& program) {
    std::vector<float> etas = ratio_steps(0.1, 10.0, 8);
    for (const float step : ratio_steps(1e-7, 0.1, 12))
        etas.insert(etas.end(), {1.0F + step, 1.0F - step});
    etas.push_back(1.0F);
    Surfaces surfaces;
    Random random(9);
    std::vector<cl_float4> in;
    std::vector<std::pair<float, float>> eta_and_alpha;
    for (const float alpha : {1e-4F, 0.01F, 0.3F, 1.0F}) {
        for (const float eta : etas) {
            const int material = surfaces.add_dielectric({eta, eta, eta, eta}, alpha);
            eta_and_alpha.emplace_back(eta, alpha);
            for (const float cosine : {1.0F, 0.7F, 0.1F, 0.01F, 1e-4F, 1e-6F}) {
                for (std::size_t i = 0; i < inputs(setting, 24, 4); ++i) {
                    const double u = i % 4 < 2 ? random.unit_float() : i % 4 == 2 ? 0.0 : double{last_number};
                    in.push_back(towards_plane(cosine, i % 2 == 1, material));
                    in.push_back(float4_of(u, random.unit_float(), random.unit_float(), 0.0));
                }
            }
        }
    }
    const std::vector<cl_float4> out = surfaces.scatter(setting, program, in);
    Measurement found;
    for (std::size_t i = 0; i < in.size() / 2; ++i) {
        const Scattered path(out.data() + 3 * i);
        const auto [eta, alpha] = eta_and_alpha[static_cast<std::size_t>(in[2 * i].s[3])];
        Real error = 0.0L;
        if (path.goes_on) {
            const Ggx ggx{alpha, alpha};
            const Vector wo = -1.0L * vector_of(in[2 * i]);
            const Real exact = ggx.weight(wo, path.direction);
            // Where little is transmitted, its chance 1 - p has few digits, and so has the weight T/(1 - p); their
            // product has not, since random numbers are as coarse.
            const Real relative = wo[2] > 0.0L ? eta : 1.0L / eta;
            const bool refracted = wo[2] * path.direction[2] < 0.0L;
            const Vector m = normalized(wo + (refracted ? relative : 1.0L) * path.direction);
            const Real chance = refracted ? 1.0L - reflectance(std::abs(dot(wo, m)), relative) : 1.0L;
            const bool valid = std::isfinite(path.pdf) && path.pdf > 0.0L && std::isfinite(path.scale);
            for (std::size_t w = 0; w < wavelengths; ++w)
                error = std::max(error, valid ? chance * std::abs(path.weight(w) - exact) : INFINITY);
        }
        found.add(eta, static_cast<double>(error), [&] { return describe(in[2 * i], in[2 * i + 1]); });
    }
    return found;
}

} // namespace

std::vector<Case> path_cases(const Programs& paths) {
    const auto with = [&paths](Measurement (*measure)(const Setting&, const ::cl::Program&)) {
        return [paths, measure](const Setting& setting) { return measure(setting, paths(setting)); };
    };
    return {{"optics", "dispersive glass, critical angles", "cos", "share of paths beyond the roundings of eta", 1e-6,
             1e-6, with(dispersion)},
            {"optics", "films that evanesce at some wavelengths", "cos", "share of a wavelength, absolute", 1e-6, 1e-6,
             with(films)},
            {"optics", "rough paths, eta 0.1 to 10, 1 and near it", "eta", "chance · weight, absolute", 1e-6, 1e-6,
             with(rough_paths)}};
}

} // namespace tristim::selftest
