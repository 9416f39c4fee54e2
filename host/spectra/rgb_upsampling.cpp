#include "spectra/rgb_upsampling.h"

#include "base/error.h"

#include <array>
#include <utility>

namespace tristim {

namespace {

constexpr std::array<std::pair<std::string_view, RgbUpsampling>, 2> forms{{
    {"jakob-hanika", RgbUpsampling::JakobHanika},
    {"meng", RgbUpsampling::Meng},
}};

D65Colour make_d65_colour() {
    D65Colour colour;
    const WavelengthBins d65 = Spectrum::rgb_illuminant_white().bins();
    for (std::size_t i = 0; i < d65.size(); ++i) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            // In each bin a reflectance that is linear between whole nanometres has the mean of its two ends.
            const double half = 0.5 * d65[i] * cie_bins()[channel][i] / cie_y_integral();
            colour.weights[i][channel] += half;
            colour.weights[i + 1][channel] += half;
            colour.white[channel] += 2.0 * half;
        }
    }
    colour.rgb_to_xyz = rgb_to_xyz_matrix(colour.white);
    return colour;
}

} // namespace

std::vector<std::string> rgb_upsampling_names() {
    std::vector<std::string> names;
    for (const auto& form : forms)
        names.emplace_back(form.first);
    return names;
}

RgbUpsampling parse_rgb_upsampling(std::string_view name) {
    for (const auto& form : forms) {
        if (form.first == name)
            return form.second;
    }
    fail("the RGB upsampling \"{}\" is not known: it may be \"{}\" or \"{}\"", name, forms[0].first, forms[1].first);
}

const D65Colour& d65_colour() {
    static const D65Colour colour = make_d65_colour();
    return colour;
}

} // namespace tristim
