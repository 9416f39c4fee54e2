#include "scene/materials.h"

#include "scene/films.h"

#include <algorithm>
#include <cmath>

namespace tristim {

namespace {

/// GGX's α along ∂p/∂u and across it from "uroughness" and "vroughness", as pbrt-v4 has them.
void set_roughness(Material& material, ParameterList& parameters) {
    const double both = parameters.number("roughness", 0.0);
    const bool remap = parameters.boolean("remaproughness", true);
    const auto alpha = [&](const char* name) {
        const double roughness = parameters.number(name, both);
        if (roughness < 0.0 || roughness > 1.0)
            fail_at(parameters.where(parameters.has(name) ? name : "roughness"),
                    "the roughness of {} is {}, but it must lie in [0, 1]", parameters.owner(), roughness);
        return remap ? std::sqrt(roughness) : roughness;
    };
    material.alpha_u = alpha("uroughness");
    material.alpha_v = alpha("vroughness");
    // pbrt's limits: below the first a surface is smooth, and lobes are not made narrower than the second.
    constexpr double smooth = 1e-3, narrowest = 1e-4;
    const bool is_smooth = std::max(material.alpha_u, material.alpha_v) < smooth;
    for (double* a : {&material.alpha_u, &material.alpha_v})
        *a = is_smooth ? 0.0 : std::max(*a, narrowest);
}

/// The real index "eta", 1.5 if it is not given.
Spectrum real_index(ParameterList& parameters, const PathResolver& resolve) {
    if (parameters.is_type("eta", "float")) {
        const double eta = parameters.number("eta", 1.5);
        if (eta <= 0.0)
            fail_at(parameters.where("eta"), "the refractive index \"eta\" is {}, but it must be positive", eta);
        return Spectrum::constant(eta);
    }
    return index_parameter(parameters, "eta", false, resolve).value_or(Spectrum::constant(1.5));
}

/// k of a conductor with eta = 1 that reflects r at normal incidence: r = k²/(4 + k²), so k = 2 √r / √(1 − r).
Spectrum k_of_reflectance(const Spectrum& reflectance) {
    std::vector<double> lambda, k;
    for (int i = 0; i <= lambda_bins; ++i) {
        // pbrt-v4 keeps r below 1 in the same way, for k would be infinite.
        const double r = std::clamp(reflectance(lambda_min_nm + i), 0.0, 0.9999);
        lambda.push_back(lambda_min_nm + i);
        k.push_back(2.0 * std::sqrt(r) / std::sqrt(1.0 - r));
    }
    return Spectrum::piecewise_linear(std::move(lambda), std::move(k));
}

void set_conductor(Material& material, ParameterList& parameters, const PathResolver& resolve) {
    if (parameters.has("reflectance")) {
        for (const char* name : {"eta", "k"}) {
            if (parameters.has(name))
                fail_at(parameters.where(name), "{} takes either \"reflectance\" or \"eta\" and \"k\", not both",
                        parameters.owner());
        }
        material.eta = Spectrum::constant(1.0);
        material.k = k_of_reflectance(*reflectance_parameter(parameters, "reflectance", resolve));
        return;
    }
    const auto eta = index_parameter(parameters, "eta", false, resolve);
    const auto k = index_parameter(parameters, "k", true, resolve);
    material.eta = eta ? *eta : Spectrum::named("metal-Cu-eta");
    material.k = k ? *k : Spectrum::named("metal-Cu-k");
}

} // namespace

Material make_material(const std::string& kind, ParameterList& parameters, const PathResolver& resolve,
                       TextureTable& textures) {
    Material material;
    material.name = kind;
    material.where = parameters.where();
    if (kind == "diffuse") {
        material.kind = Material::Kind::Diffuse;
        if (const auto reflectance = reflectance_parameter(parameters, "reflectance", resolve))
            material.reflectance = *reflectance;
    } else if (kind == "dielectric") {
        material.kind = Material::Kind::Dielectric;
        material.eta = real_index(parameters, resolve);
        set_roughness(material, parameters);
        if (material.alpha_u > 0.0 && material.eta.is_constant() &&
            material.eta.minimum(lambda_min_nm, lambda_max_nm) == 1.0)
            fail_at(parameters.where(), "{} is rough, and so its \"eta\" must not be 1", parameters.owner());
    } else if (kind == "conductor") {
        material.kind = Material::Kind::Conductor;
        set_conductor(material, parameters, resolve);
        set_roughness(material, parameters);
    } else {
        fail_at(parameters.where(), "the material \"{}\" is not supported", kind);
    }
    material.film = film_parameters(parameters, resolve, textures);
    if (material.kind == Material::Kind::Diffuse && parameters.has("eta")) {
        if (material.film.layers.empty())
            fail_at(parameters.where("eta"), "\"eta\" of {} is the index under a film, but it has no \"filmthickness\"",
                    parameters.owner());
        material.eta = real_index(parameters, resolve);
        if (material.eta.minimum(lambda_min_nm, lambda_max_nm) < 1.0)
            fail_at(parameters.where("eta"), "the index \"eta\" under the film of {} is {}, but it must be at least 1",
                    parameters.owner(), material.eta.minimum(lambda_min_nm, lambda_max_nm));
    }
    parameters.finish();
    return material;
}

} // namespace tristim
