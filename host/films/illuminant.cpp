#include "films/illuminant.h"

#include "base/error.h"
#include "spectra/colour.h"
#include "spectra/near_matches.h"

#include <algorithm>

namespace tristim {
namespace {

std::vector<std::string> illuminant_names() {
    std::vector<std::string> names = named_spectra();
    std::erase_if(names, [](const std::string& name) { return !is_illuminant(name); });
    return names;
}

Spectrum read_illuminant(const std::string& path) {
    const Spectrum spectrum = Spectrum::read_spd(path);
    if (spectrum.minimum(lambda_min_nm, lambda_max_nm) < 0.0)
        fail("the illuminant \"{}\" is negative at some visible wavelength", path);
    if (!(spectrum_to_xyz(spectrum)[1] > 0.0))
        fail("the illuminant \"{}\" is dark at all visible wavelengths", path);
    return spectrum;
}

} // namespace

Illuminant find_illuminant(const std::string& name) {
    if (name.ends_with(".spd"))
        return {name, read_illuminant(name)};
    const std::vector<std::string> names = illuminant_names();
    for (const char* prefix : {"", "stdillum-", "illum-"}) {
        const std::string full = prefix + name;
        if (std::find(names.begin(), names.end(), full) != names.end())
            return {full, Spectrum::named(full)};
    }
    fail("unknown illuminant \"{}\"; did you mean {}?", name, near_matches(name, names));
}

} // namespace tristim
