#pragma once

// scatter and evaluate_rough of kernels/bsdf.h at surfaces with films, for tests.

#include "kernel_harness.h"
#include "selftest/film_oracle.h"
#include "shared_types.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace tristim::kernel_test {

constexpr std::size_t test_wavelengths = 6; ///< in two blocks of four: the last two are padding
constexpr std::size_t padded_wavelengths = 8;
using PerWavelength = std::array<float, test_wavelengths>;

constexpr std::array<double, test_wavelengths> test_lambda{420.0, 470.0, 520.0, 560.0, 610.0, 680.0};
/// What a path starts with.
constexpr std::array<double, test_wavelengths> first_weights{2.0, 3.0, 5.0, 1.0, 0.5, 4.0};

struct FilmOfTest {
    double thickness; ///< nm
    PerWavelength n, k;
};

struct SharesOfPower {
    double reflected, transmitted;
};

struct CoatedSurface {
    std::string name;
    int kind;
    bool dispersive;
    PerWavelength n, k;
    std::vector<FilmOfTest> layers;
    cl_float2 alpha;

    /// By the oracle, of unpolarised light.
    SharesOfPower shares(std::size_t w, double cosine, bool outside) const {
        std::vector<oracle::Layer> film;
        for (const FilmOfTest& layer : layers)
            film.push_back({layer.thickness, layer.n[w], layer.k[w]});
        const bool opaque = kind == MATERIAL_CONDUCTOR;
        const oracle::FilmOptics o =
            oracle::film(1.0, film, n[w], opaque ? k[w] : 0.0F, test_lambda[w], cosine, outside);
        return {0.5 * (o.reflected_s + o.reflected_p), opaque ? 0.0 : 0.5 * (o.transmitted_s + o.transmitted_p)};
    }
};

/// For kernels of tests, after kernels/bsdf.h: what is met, with what, and how the path fares.
inline const std::string path_source = R"(
Scene scene_of(const global float* pass_table, const global SceneFilmLayer* layers) {
    Scene scene;
    scene.pass_table = pass_table;
    scene.film_layers = layers;
    return scene;
}
Interaction surface_at(float3 normal, float3 tangent) {
    Interaction it;
    it.point = 0.0f;
    it.normal = it.shading_normal = normal;
    it.extent = 1.0f;
    it.material = 0;
    it.light = -1;
    it.uv = 0.0f;
    it.tangent = tangent;
    return it;
}
PathWeight first_weight(int slot) {
    PathWeight weight;
    weight.scale = 1.0f;
    weight.slot = slot;
    weight.spectrum.block[0] = (floatv)(2.0f, 3.0f, 5.0f, 1.0f);
    weight.spectrum.block[1] = (floatv)(0.5f, 4.0f, 0.0f, 0.0f);
    return weight;
}
void store_path(float state, float second, const PathWeight* weight, global float* out) {
    out[0] = state;
    out[1] = second;
    out[2] = weight->scale;
    for (int b = 0; b < BLOCKS; ++b)
        vstorev(weight->spectrum.block[b], b, out + 3);
}
)";

/// Rows of the pass table, where SceneFilmLayer and SurfaceMaterial of a CoatedSurface point: eta, k, two spare rows,
/// and eta and k of each layer.
constexpr int eta_row = 0, k_row = 1, reflectance_row = 2, internal_row = 3, first_layer_row = 4;

inline std::vector<float> pass_table_of(const CoatedSurface& surface, const PerWavelength& reflectance = {}) {
    std::vector<float> table;
    const auto add = [&table](const auto& row) {
        for (std::size_t w = 0; w < padded_wavelengths; ++w)
            table.push_back(static_cast<float>(row[std::min(w, test_wavelengths - 1)]));
    };
    add(test_lambda);
    for (int weights = 0; weights < 3; ++weights) {
        add(PerWavelength{1.0F, 1.0F, 1.0F, 1.0F, 1.0F, 1.0F});
        table[table.size() - 2] = table[table.size() - 1] = 0.0F;
    }
    add(surface.n);
    add(surface.k);
    add(reflectance);
    add(PerWavelength{});
    for (const FilmOfTest& layer : surface.layers) {
        add(layer.n);
        add(layer.k);
    }
    return table;
}

inline SurfaceMaterial material_of(const CoatedSurface& surface) {
    SurfaceMaterial m{};
    m.kind = surface.kind;
    m.reflectance = reflectance_row;
    m.eta = eta_row;
    m.k = k_row;
    m.dispersive = surface.dispersive ? 1 : 0;
    m.film_layers = static_cast<int>(surface.layers.size());
    m.film_texture = -1;
    m.alpha_u = surface.alpha.s[0];
    m.alpha_v = surface.alpha.s[1];
    m.internal_reflectance = internal_row;
    m.internal_rows = 1;
    m.internal_thickness = surface.layers.empty() ? 0.0F : static_cast<float>(surface.layers[0].thickness);
    return m;
}

inline std::vector<SceneFilmLayer> layers_of(const CoatedSurface& surface) {
    std::vector<SceneFilmLayer> layers;
    for (std::size_t i = 0; i < surface.layers.size(); ++i)
        layers.push_back({static_cast<float>(surface.layers[i].thickness), first_layer_row + 2 * static_cast<int>(i),
                          first_layer_row + 1 + 2 * static_cast<int>(i), 0});
    return layers;
}

inline Macros interface_macros() {
    return {{"W", "6"},
            {"LANES", "4"},
            {"BLOCKS", "2"},
            {"HAS_DIELECTRIC", "1"},
            {"HAS_CONDUCTOR", "1"},
            {"HAS_DISPERSION", "1"},
            {"HAS_FILM", "1"},
            {"HAS_ABSORBING_FILM", "1"},
            {"HAS_ROUGH", "1"},
            {"HAS_ANISOTROPIC", "1"},
            {"HAS_UV", "1"},
            {"HAS_COATED_DIFFUSE", "1"}};
}

/// A path after scattering.
struct ScatteredPath {
    cl_float4 direction;
    float pdf;
    bool goes_on;
    int slot;
    float scale;
    std::array<float, test_wavelengths> spectrum;

    double weight(std::size_t w) const {
        if (slot >= 0)
            return slot == static_cast<int>(w) ? scale : 0.0;
        return double{scale} * spectrum[w];
    }
};

class InterfaceProgram {
  public:
    std::vector<ScatteredPath> scatter(const CoatedSurface& surface, const std::vector<cl_float4>& directions,
                                       const std::vector<cl_float4>& u, const Vec3& normal, const Vec3& tangent,
                                       int old_slot, int slot, bool radiance) const {
        const std::size_t count = directions.size();
        const Buffer<cl_float4> scattered = make_buffer<cl_float4>(count);
        const Buffer<float> weights = make_buffer<float>(count * (3 + padded_wavelengths));
        run(program_, "scatter_paths", count, upload(pass_table_of(surface)), upload(std::vector{material_of(surface)}),
            upload(layers(surface)), upload(directions), upload(u), float3_of(normal), float3_of(tangent), old_slot,
            slot, radiance ? 1 : 0, scattered, weights);
        const std::vector<cl_float4> d = scattered.read(test_device());
        const std::vector<float> values = weights.read(test_device());
        std::vector<ScatteredPath> paths;
        for (std::size_t i = 0; i < count; ++i) {
            const float* v = values.data() + i * (3 + padded_wavelengths);
            ScatteredPath path{d[i], d[i].s[3], v[0] > 0.0F, static_cast<int>(v[1]), v[2], {}};
            std::copy_n(v + 3, test_wavelengths, path.spectrum.begin());
            paths.push_back(path);
        }
        return paths;
    }

    /// The BSDF that scatters flux, at the wavelength of `slot`; directions are in the surface's frame on wo's side.
    /// evaluated is what the path keeps, SLOT_ALL or `slot`.
    std::vector<double> evaluate(const CoatedSurface& surface, const std::vector<cl_float4>& wo,
                                 const std::vector<cl_float4>& wi, bool reflection_outside, bool transmission_outside,
                                 int slot) const {
        const Buffer<float> values = make_buffer<float>(wo.size());
        run(program_, "evaluate", wo.size(), upload(pass_table_of(surface)), upload(std::vector{material_of(surface)}),
            upload(layers(surface)), upload(wo), upload(wi), reflection_outside ? 1 : 0, transmission_outside ? 1 : 0,
            slot, values);
        const std::vector<float> read = values.read(test_device());
        return {read.begin(), read.end()};
    }

  private:
    static std::vector<SceneFilmLayer> layers(const CoatedSurface& surface) {
        std::vector<SceneFilmLayer> all = layers_of(surface);
        if (all.empty())
            all.emplace_back();
        return all;
    }
    static cl_float3 float3_of(const Vec3& v) {
        return {{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])}};
    }

    static constexpr const char* source = R"(
kernel void scatter_paths(const global float* pass_table, const global SurfaceMaterial* material,
                          const global SceneFilmLayer* layers, const global float4* directions, const global float4* u,
                          float3 normal, float3 tangent, int old_slot, int slot, int radiance, global float4* scattered,
                          global float* weights) {
    const size_t i = get_global_id(0);
    const Scene scene = scene_of(pass_table, layers);
    const Interaction it = surface_at(normal, 3.0f * tangent + 0.5f * normal);
    PathWeight weight = first_weight(old_slot);
    float3 d = directions[i].xyz;
    float pdf;
    const bool goes_on = scatter(&scene, material, &it, &d, u[i].xyz, slot, radiance != 0, &weight, &pdf);
    scattered[i] = (float4)(d, pdf);
    store_path(goes_on ? 1.0f : 0.0f, (float)weight.slot, &weight, weights + i * (3 + W_PADDED));
}
kernel void evaluate(const global float* pass_table, const global SurfaceMaterial* material,
                     const global SceneFilmLayer* layers, const global float4* wo, const global float4* wi,
                     int reflection_outside, int transmission_outside, int slot, global float* values) {
    const size_t i = get_global_id(0);
    const Scene scene = scene_of(pass_table, layers);
    const bool reflects = wi[i].z > 0.0f;
    const bool outside = reflects ? reflection_outside : transmission_outside;
    const RoughScattering rough = evaluate_rough(&scene, material, layers->thickness, outside, wo[i].xyz, wi[i].xyz, slot);
    values[i] = 0.0f;
    if (rough.geometry > 0.0f)
        values[i] = rough.geometry * spectrum_at(reflects ? &rough.optics.reflected : &rough.optics.transmitted, slot);
}
)";

    const ::cl::Program program_ =
        build_test_program("#define PATH_SPECTRUM 1\n#include \"bsdf.h\"\n" + path_source + source, interface_macros());
};

} // namespace tristim::kernel_test
