#pragma once

#include <map>
#include <string>
#include <string_view>

namespace tristim {

/// The kernel sources ("kernels/eye_pass.cl") and spectral tables ("host/spectra/data/glass-BK7.spd") that the build
/// put into the binary, by their path in the repository.
const std::map<std::string, std::string_view>& embedded_files();

} // namespace tristim
