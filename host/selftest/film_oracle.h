#pragma once

// Thin films in extended precision, straight from Maxwell's equations: slow, without a root, a sine or a case that a
// fast implementation would have.

#include <vector>

namespace tristim::oracle {

/// A homogeneous layer of index n + ik (fields e^{-iωt}, k ≥ 0).
struct Layer {
    double thickness = 0.0; ///< nm, ≥ 0
    double n = 1.0;
    double k = 0.0;
};

/// Shares of the incident power, for each polarisation.
struct FilmOptics {
    double reflected_s = 0.0, reflected_p = 0.0;
    double transmitted_s = 0.0, transmitted_p = 0.0; ///< what enters the other side, just below its surface
};

/// Layers (the outermost first) between an outside of real index n0 and a base of index base_n + i base_k, for light of
/// vacuum wavelength lambda (nm) that comes from outside or from the base (base_k must then be 0). cos_i in [0, 1] is
/// the cosine in the medium that the light comes from; 0 stands for the limit of grazing incidence.
FilmOptics film(double n0, const std::vector<Layer>& layers, double base_n, double base_k, double lambda, double cos_i,
                bool from_outside);

} // namespace tristim::oracle
