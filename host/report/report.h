#pragma once

#include <string>
#include <vector>

namespace tristim {

/// Draws all that can be drawn from a bench's results.json: the summaries in it, results.csv, plots/ and report.html.
/// Images that are missing, as where results.json alone was kept, are left out; returns their names. Throws Error if
/// the folder holds no bench or something cannot be written.
std::vector<std::string> write_report(const std::string& folder);

} // namespace tristim
