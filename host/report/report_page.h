#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace tristim {

/// Writes `folder`/report.html: one page that holds its data, images and code, and opens from disk with no network.
/// `results` is the whole of results.json (bench/results.h) with scenes[i]["summary"] (bench/analysis.h); its images
/// are PNG files relative to `folder`. The page is replaced as a whole or not at all. Throws Error if an image is
/// missing or no PNG file, or if the page cannot be written.
void write_report_page(const nlohmann::ordered_json& results, const std::string& folder);

} // namespace tristim
