#pragma once

#include "bench/results.h"
#include "render/options.h"

#include <string>
#include <vector>

namespace tristim {

/// A setting to measure.
struct Variant {
    std::string label;
    RenderOptions options;
};

/// Variants that one chart compares.
struct VariantGroup {
    std::string name, title; ///< as in RunGroup
    std::vector<Variant> variants;
    std::size_t baseline = 0; ///< index in variants
};

/// One group: a variant for each method of a list such as "rgb,tristimulus:1,tristimulus:1@random", where @random and
/// @stratified choose the sequence of wavelengths. Throws Error for methods that do not exist or come twice.
VariantGroup method_variants(const std::string& methods, const RenderOptions& base);

/// What one may turn about a render, each turned by itself: wavelengths per path, photons per pass, radius, alpha,
/// arithmetic, radius rule and direct light.
std::vector<VariantGroup> cost_variants(const RenderOptions& base);

/// All that distinguishes two variants, but for image size and seed.
nlohmann::ordered_json options_json(const RenderOptions& options);

} // namespace tristim
