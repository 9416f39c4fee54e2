#include "scene/spectrum_parameters.h"

#include "spectra/colour.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tristim {

namespace {

/// What an "rgb" triple stands for; pbrt's SpectrumType.
using RgbSpectrum = Spectrum (*)(const std::array<double, 3>&, RgbUpsampling);

/// A spectrum from its "wavelength value" pairs.
Spectrum from_pairs(const Parameter& parameter) {
    const std::vector<double>& numbers = parameter.numbers;
    if (numbers.empty() || numbers.size() % 2 != 0)
        fail_at(parameter.where, "the spectrum \"{}\" takes pairs of wavelength and value, but {} numbers are given",
                parameter.name, numbers.size());
    std::vector<double> lambda, values;
    for (std::size_t i = 0; i < numbers.size(); i += 2) {
        lambda.push_back(numbers[i]);
        values.push_back(numbers[i + 1]);
    }
    return Spectrum::piecewise_linear(std::move(lambda), std::move(values));
}

std::array<double, 3> rgb_of(const Parameter& parameter) {
    if (parameter.numbers.size() != 3)
        fail_at(parameter.where, "the colour \"{}\" takes three numbers, but {} are given", parameter.name,
                parameter.numbers.size());
    return {parameter.numbers[0], parameter.numbers[1], parameter.numbers[2]};
}

Spectrum to_spectrum(const Parameter& parameter, RgbSpectrum of_rgb, RgbUpsampling upsampling,
                     const PathResolver& resolve) {
    return with_location(parameter.where, [&] {
        if (parameter.type == "rgb")
            return of_rgb(rgb_of(parameter), upsampling);
        if (parameter.type == "blackbody") {
            if (parameter.numbers.size() != 1)
                fail("the blackbody \"{}\" takes one temperature, but {} numbers are given", parameter.name,
                     parameter.numbers.size());
            return Spectrum::blackbody(parameter.numbers[0]);
        }
        if (parameter.strings.empty())
            return from_pairs(parameter);
        if (parameter.strings.size() != 1 || !parameter.numbers.empty())
            fail("the spectrum \"{}\" takes one name or pairs of numbers", parameter.name);
        const std::string& name = parameter.strings.front();
        return is_spectrum_file(name) ? Spectrum::read_spd(resolve(name, parameter.where)) : Spectrum::named(name);
    });
}

/// The first bin, as a wavelength in nm, where the spectrum breaks a condition.
template <typename Condition>
std::optional<double> first_violation(const Spectrum& spectrum, Condition holds) {
    const auto bins = spectrum.bins();
    const auto bad = std::find_if_not(bins.begin(), bins.end(), holds);
    if (bad == bins.end())
        return std::nullopt;
    return lambda_min_nm + 0.5 + static_cast<double>(bad - bins.begin());
}

} // namespace

bool is_spectrum_file(const std::string& name) {
    return name.ends_with(".spd") || name.find('/') != std::string::npos;
}

void check_index(const Spectrum& spectrum, const std::string& name, bool may_be_zero, const SourceLocation& where) {
    const auto [from, to] = spectrum.range_nm();
    if (from > lambda_min_nm || to < lambda_max_nm)
        fail_at(where, "the spectrum \"{}\" covers only {} to {} nm, not all of {} to {} nm", name, from, to,
                lambda_min_nm, lambda_max_nm);
    const auto allowed = [may_be_zero](double value) {
        return std::isfinite(static_cast<float>(value)) && (may_be_zero ? value >= 0.0 : value > 0.0);
    };
    if (const auto nm = first_violation(spectrum, allowed))
        fail_at(where, "the spectrum \"{}\" is {} at {} nm, where it must be {}", name, spectrum(*nm), *nm,
                may_be_zero ? "at least 0 and finite" : "positive and finite");
}

std::optional<Spectrum> reflectance_parameter(ParameterList& parameters, const std::string& name,
                                              const PathResolver& resolve) {
    const Parameter* parameter = parameters.spectrum(name);
    if (!parameter)
        return std::nullopt;
    Spectrum spectrum = to_spectrum(*parameter, &Spectrum::rgb_albedo, parameters.rgb_upsampling(), resolve);
    // A sigmoid of a saturated colour may round to just above 1.
    constexpr double rounding = 1e-9;
    if (const auto nm = first_violation(spectrum, [](double r) { return r >= -rounding && r <= 1.0 + rounding; }))
        fail_at(parameter->where, "the reflectance \"{}\" is {} at {} nm, outside [0, 1]", name, spectrum(*nm), *nm);
    return spectrum;
}

std::optional<Spectrum> index_parameter(ParameterList& parameters, const std::string& name, bool may_be_zero,
                                        const PathResolver& resolve) {
    const Parameter* parameter = parameters.spectrum(name);
    if (!parameter)
        return std::nullopt;
    Spectrum spectrum = to_spectrum(*parameter, &Spectrum::rgb_unbounded, parameters.rgb_upsampling(), resolve);
    check_index(spectrum, name, may_be_zero, parameter->where);
    return spectrum;
}

Spectrum emission_parameter(ParameterList& parameters, const std::string& name, const PathResolver& resolve) {
    const Parameter* parameter = parameters.spectrum(name);
    const Spectrum raw = parameter
                             ? to_spectrum(*parameter, &Spectrum::rgb_illuminant, parameters.rgb_upsampling(), resolve)
                             : Spectrum::named("stdillum-D65");
    const SourceLocation where = parameters.where(name);
    if (const auto nm = first_violation(raw, [](double value) { return value >= 0.0; }))
        fail_at(where, "the emission \"{}\" is negative at {} nm", name, *nm);
    const bool is_rgb = parameter && parameter->type == "rgb";
    const double y = spectrum_to_xyz(raw)[1];
    const double reference = is_rgb ? spectrum_to_xyz(Spectrum::rgb_illuminant_white())[1] : y;
    if (!(y > 0.0))
        fail_at(where, "the emission \"{}\" is zero over all visible wavelengths", name);
    const Spectrum result = raw.scaled(1.0 / reference);
    if (first_violation(result, [](double value) { return std::isfinite(static_cast<float>(value)); }))
        fail_at(where, "the emission \"{}\" is too weak: its luminous part is {}", name, y);
    return result;
}

} // namespace tristim
