#pragma once

#include "films/film_stack.h"
#include "opencl/device.h"

#include <vector>

namespace tristim {

/// Shares of the power: reflected, and transmitted into the base (for an absorbing base, just below its surface), for
/// light polarised across the plane of incidence (s) and in it (p).
struct FilmResponse {
    float reflected_s = 0, reflected_p = 0;
    float transmitted_s = 0, transmitted_p = 0;
    double reflected() const { return 0.5 * (double{reflected_s} + double{reflected_p}); }
    double transmitted() const { return 0.5 * (double{transmitted_s} + double{transmitted_p}); }
};

/// Evaluates a stack on a device, by the function of the kernels that renders films (kernels/thin_film.h).
class FilmEvaluator {
  public:
    /// Builds the program for wavelengths in [from_nm, to_nm]; the device must outlive the evaluator.
    FilmEvaluator(const Device& device, const FilmStack& stack, double from_nm, double to_nm, bool fast_math);

    const FilmStack& stack() const { return stack_; }

    /// At each wavelength in nm, for light that comes at `angle_deg` from the normal in [0, 90]; 90 is the limit of
    /// grazing light, of which any interface reflects all. `angle_deg` is counted in the first medium.
    std::vector<FilmResponse> evaluate(const std::vector<double>& lambda_nm, double angle_deg) const;

    /// The same for films that differ in the thickness, in nm, of layer `layer` (from 0): the first film at all the
    /// wavelengths, then the next.
    std::vector<FilmResponse> evaluate(const std::vector<double>& lambda_nm, double angle_deg, std::size_t layer,
                                       const std::vector<double>& thicknesses) const;

  private:
    std::vector<FilmResponse> evaluate_films(const std::vector<double>& lambda_nm, double angle_deg,
                                             const std::vector<std::vector<double>>& films) const;
    void evaluate_part(const std::vector<double>& lambda_nm, std::size_t begin, std::size_t end, double angle_deg,
                       const std::vector<std::vector<double>>& films, std::vector<FilmResponse>& results) const;
    std::vector<float> pass_tables(const std::vector<double>& lambda_nm, std::size_t begin, std::size_t end) const;
    std::size_t table_rows() const;

    const Device& device_;
    FilmStack stack_;
    mutable ::cl::Kernel kernel_;
};

} // namespace tristim
