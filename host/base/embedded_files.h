#pragma once

#include <map>
#include <string>
#include <string_view>

namespace tristim {

/// The kernel sources ("kernels/eye_pass.cl"), spectral tables ("host/spectra/data/glass-BK7.spd"), plotting scripts
/// ("host/plot/plot.py") and parts of reports ("host/report/report.js") that the build put into the binary, by their
/// path in the repository; and the Chart.js library as "chart.min.js".
const std::map<std::string, std::string_view>& embedded_files();

} // namespace tristim
