#include "base/embedded_files.h"
#include "base/error.h"
#include "spectra/colour.h"
#include "spectra/near_matches.h"
#include "spectra/spd_file.h"
#include "spectra/spectrum.h"

#include <algorithm>
#include <map>
#include <mutex>

namespace tristim {

namespace {

constexpr std::string_view folder = "host/spectra/data/";
constexpr std::string_view extension = ".spd";

std::string path_of(const std::string& name) {
    return fmt::format("{}{}{}", folder, name, extension);
}

Spectrum load(const std::string& name) {
    const Spectrum spectrum = parse_spd(named_spectrum_text(name), path_of(name));
    return is_illuminant(name) ? spectrum.scaled(1.0 / spectrum_to_xyz(spectrum)[1]) : spectrum;
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

bool is_illuminant(const std::string& name) {
    return name.starts_with("stdillum-") || name.starts_with("illum-");
}

std::string_view named_spectrum_text(const std::string& name) {
    const auto file = embedded_files().find(path_of(name));
    if (file == embedded_files().end())
        fail("unknown spectrum \"{}\"; did you mean {}?", name, near_matches(name, named_spectra()));
    return file->second;
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
