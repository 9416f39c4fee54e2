#pragma once

#include <map>
#include <string>
#include <string_view>

namespace tristim {

/// The kernel sources ("kernels/eye_pass.cl"), spectral tables ("host/spectra/data/glass-BK7.spd") and the plotting
/// script ("host/plot/plot.py") that the build put into the binary, by their path in the repository.
const std::map<std::string, std::string_view>& embedded_files();

} // namespace tristim
