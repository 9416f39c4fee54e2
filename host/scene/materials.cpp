#include "scene/materials.h"

#include <algorithm>
#include <cmath>

namespace tristim {

namespace {

void require_smooth(ParameterList& parameters) {
    for (const char* name : {"roughness", "uroughness", "vroughness"}) {
        if (parameters.number(name, 0.0) != 0.0)
            fail_at(parameters.where(name), "\"{}\" of {} must be 0: rough surfaces are not supported", name,
                    parameters.owner());
    }
    parameters.boolean("remaproughness", true);
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

Material make_material(const std::string& kind, ParameterList& parameters, const PathResolver& resolve) {
    Material material;
    material.name = kind;
    if (kind == "diffuse") {
        material.kind = Material::Kind::Diffuse;
        if (const auto reflectance = reflectance_parameter(parameters, "reflectance", resolve))
            material.reflectance = *reflectance;
    } else if (kind == "dielectric") {
        material.kind = Material::Kind::Dielectric;
        if (parameters.is_type("eta", "float")) {
            const double eta = parameters.number("eta", 1.5);
            if (eta <= 0.0)
                fail_at(parameters.where("eta"), "the refractive index \"eta\" is {}, but it must be positive", eta);
            material.eta = Spectrum::constant(eta);
        } else if (const auto eta = index_parameter(parameters, "eta", false, resolve)) {
            material.eta = *eta;
        }
        require_smooth(parameters);
    } else if (kind == "conductor") {
        material.kind = Material::Kind::Conductor;
        set_conductor(material, parameters, resolve);
        require_smooth(parameters);
    } else {
        fail_at(parameters.where(), "the material \"{}\" is not supported", kind);
    }
    parameters.finish();
    return material;
}

} // namespace tristim
