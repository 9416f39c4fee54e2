#include "base/embedded_files.h"
#include "base/error.h"
#include "spectra/colour.h"
#include "spectra/spd_file.h"
#include "spectra/spectrum.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <mutex>
#include <numeric>
#include <utility>

namespace tristim {

namespace {

constexpr std::string_view folder = "host/spectra/data/";
constexpr std::string_view extension = ".spd";

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// Insertions, deletions and replacements that turn one word into the other (Levenshtein 1966).
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
        }
    }
    return row[b.size()];
}

/// The three known names nearest to an unknown one, "a, b or c".
std::string near_matches(const std::string& unknown) {
    const std::string wanted = lower_case(unknown);
    std::vector<std::pair<std::size_t, std::string>> ranked;
    for (const std::string& name : named_spectra()) {
        const std::string candidate = lower_case(name);
        const bool contains = !wanted.empty() && candidate.find(wanted) != std::string::npos;
        ranked.emplace_back(contains ? 0 : edit_distance(wanted, candidate), name);
    }
    std::sort(ranked.begin(), ranked.end());
    return fmt::format("{}, {} or {}", ranked.at(0).second, ranked.at(1).second, ranked.at(2).second);
}

Spectrum load(const std::string& name) {
    const std::string path = fmt::format("{}{}{}", folder, name, extension);
    const auto file = embedded_files().find(path);
    if (file == embedded_files().end())
        fail("unknown spectrum \"{}\"; did you mean {}?", name, near_matches(name));
    const Spectrum spectrum = parse_spd(file->second, path);
    if (name.starts_with("stdillum-") || name.starts_with("illum-"))
        return spectrum.scaled(1.0 / spectrum_to_xyz(spectrum)[1]);
    return spectrum;
}

} // namespace

Spectrum Spectrum::named(const std::string& name) {
    static std::mutex mutex;
    static std::map<std::string, Spectrum> cache;
    {
        const std::lock_guard lock(mutex);
        const auto found = cache.find(name);
        if (found != cache.end())
            return found->second;
    }
    // Loading an illuminant asks for the colour matching functions by name, so the lock must not be held.
    const Spectrum spectrum = load(name);
    const std::lock_guard lock(mutex);
    return cache.emplace(name, spectrum).first->second;
}

std::vector<std::string> named_spectra() {
    std::vector<std::string> names;
    for (const auto& [path, text] : embedded_files()) {
        if (path.starts_with(folder) && path.ends_with(extension))
            names.push_back(path.substr(folder.size(), path.size() - folder.size() - extension.size()));
    }
    std::sort(names.begin(), names.end());
    return names;
}

} // namespace tristim
