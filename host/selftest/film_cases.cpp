#include "selftest/film_cases.h"

#include "selftest/film_inputs.h"
#include "selftest/film_means.h"

#include <limits>
#include <memory>

namespace tristim::selftest {

std::vector<Case> film_cases(FilmKernels::Builder builder) {
    const auto kernels = std::make_shared<FilmKernels>(std::move(builder));
    constexpr const char* shares = "shares of power, absolute";
    constexpr double finite_only = std::numeric_limits<double>::infinity();
    const auto films = [kernels](auto inputs_of, FilmError error) {
        return [kernels, inputs_of, error](const Setting& setting) {
            return measure_films(*kernels, setting, inputs_of(setting), error);
        };
    };
    const auto thickness = [](double low, double high) {
        return [low, high](const Setting& setting) { return thickness_inputs(setting, low, high); };
    };
    const auto absorption = [](double low, double high) {
        return [low, high](const Setting& setting) { return absorption_inputs(setting, low, high); };
    };
    const auto inside = [kernels](const InternalFilms& f) {
        return [kernels, f](const Setting& setting) { return internal_reflectance(*kernels, setting, f); };
    };
    // Bounds: phases are right to 1e-7 up to 1 mm, and what is left are some dozens of float roundings. They grow where
    // the film resonates: near grazing and total reflection, over weak absorbers, and by the power that a stack of many
    // layers stores. With --math fast a phase loses its low half, so that its error grows with the thickness, and so
    // does the angle in a layer, until near grazing a thick layer that matches what lies above may reflect all.
    return {
        {"film", "thickness 0 to 2 µm", "thickness / nm", shares, 5e-6, 1e-3,
         films(thickness(0.0, 2e3), absolute_error)},
        {"film", "thickness 2 µm to 1 mm", "thickness / nm", shares, 5e-6, 0.1,
         films(thickness(2e3, 1e6), absolute_error)},
        {"film", "angle 0 to 89.9999° and 90°", "90° - angle / degrees", shares, 5e-5, 5e-4,
         films(angle_inputs, absolute_error)},
        {"film", "total reflection ±1e-8 to ±1e-2", "sine over critical sine - 1", shares, 1e-5, finite_only,
         films(total_reflection_inputs, absolute_error)},
        {"film", "matched indices, 0 to 1e-3 apart", "relative difference", shares, 2e-5, finite_only,
         films(matched_inputs, absolute_error)},
        {"film", "absorption k 1e-6 to 10", "k", shares, 1e-5, 1e-2, films(absorption(1e-6, 10.0), absolute_error)},
        {"film", "conductors k 10 to 1e6", "k", shares, 2e-6, 1e-2, films(absorption(10.0, 1e6), absolute_error)},
        {"film", "stacks of 1 to 100 layers, 2 µm", "layers", shares, 5e-5, 2e-4,
         films(random_stack_inputs, absolute_error)},
        {"film", "1 to 100 quarter waves", "layers", shares, 5e-4, 5e-4, films(quarter_wave_inputs, absolute_error)},
        {"film", "power in 1 to 100 layers up to 1 mm", "layers", "R + T - 1, or its excess over 0", 1e-4, 1e-4,
         films(thick_stack_inputs, power_error)},
        {"film", "guided modes behind opaque gaps", "ulps of the cosine from the mode", shares, 1e-6, 1e-6,
         films(guided_mode_inputs, absolute_error)},
        {"film", "mean over wavelengths, 1 µm to 1 mm", "thickness / nm", "mean reflectance, standard errors", 5.0, 5.0,
         [kernels](const Setting& setting) { return mean_over_wavelengths(*kernels, setting); }},
        {"film", "diffuse light under films to 2 µm", "thickness / nm", "reflectance, absolute", 5e-6, 1e-5,
         inside({0.0, 2e3, false, 48})},
        {"film", "diffuse light under films to 1 mm", "thickness / nm", "reflectance, absolute", 2e-3, 2e-3,
         inside({2e3, 1e6, false, 4096})},
        {"film", "diffuse light under absorbing films", "thickness / nm", "reflectance, absolute", 5e-3, 5e-3,
         inside({0.0, 1e6, true, 4096})},
    };
}

std::vector<Case> film_cases() {
    return film_cases([](const Setting& setting, const Macros& macros) { return build(setting, "film.cl", macros); });
}

} // namespace tristim::selftest
