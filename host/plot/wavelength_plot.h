#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace tristim {

/// Draws what `bench-wavelengths --json` prints to a PNG file: for each scene RMSE against passes, both logarithmic, a
/// curve per method with its standard error. Throws Error as write_plot() does.
void write_wavelength_plot(const nlohmann::ordered_json& results, const std::string& png_path);

} // namespace tristim
