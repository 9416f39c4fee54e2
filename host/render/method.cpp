#include "render/method.h"

#include "base/error.h"
#include "base/parse_number.h"
#include "spectra/gauss_rule.h"
#include "spectra/spectrum.h"

#include <algorithm>
#include <array>
#include <vector>

namespace tristim {
namespace {

using Kind = Method::Kind;

constexpr std::array kinds{
    MethodKind{Kind::RgbBands, "rgb", nullptr, 3, 3, 1, false, "SAMPLER_RGB",
               "three bands, over which all spectra are integrated before rendering", "Takemura et al., section 4"},
    MethodKind{Kind::Spectral, "spectral", "400", lambda_bins, lambda_bins, 1, true, "SAMPLER_SPECTRAL",
               "one wavelength in every nanometre from 380 to 780", "Takemura et al., section 4"},
    MethodKind{Kind::Tristimulus, "tristimulus", "N", 1, 256, 3, true, "SAMPLER_TRISTIMULUS",
               "N sets of three wavelengths, drawn from x̄, ȳ and z̄", "Takemura et al."},
    MethodKind{Kind::Gauss, "gauss", "C", gauss_wavelengths_min, gauss_wavelengths_max, 1, false, "SAMPLER_GAUSS",
               "C fixed wavelengths, by Gaussian quadrature in an opponent space", "Meyer 1988"},
    MethodKind{Kind::Uniform, "uniform", "C", 1, 768, 1, true, "SAMPLER_UNIFORM",
               "C wavelengths anywhere from 380 to 780 nm", "baseline"},
    MethodKind{Kind::Cluster, "cluster", "C", 1, 768, 1, true, "SAMPLER_CLUSTER",
               "C wavelengths from a pdf near the eye's sensitivity, one of which steers the path",
               "Radziszewski et al. 2009"},
    MethodKind{Kind::Hero, "hero", "C", 1, 768, 1, true, "SAMPLER_HERO",
               "a uniform hero wavelength and C - 1 rotations of it", "Wilkie et al. 2014"},
    MethodKind{Kind::Visible, "visible", "C", 1, 768, 1, true, "SAMPLER_VISIBLE",
               "one sample and C - 1 rotations in the CDF of cluster's pdf", "pbrt-v4, Pharr et al. 2023"},
    MethodKind{Kind::Mixture, "mixture", "C", 1, 768, 1, true, "SAMPLER_MIXTURE",
               "C wavelengths from x̄ + ȳ + z̄, each of which feeds X, Y and Z", "ours"},
    MethodKind{Kind::Illuminant, "illuminant", "N", 1, 256, 3, true, "SAMPLER_ILLUMINANT",
               "N sets of three, drawn from x̄, ȳ and z̄ times the light that the scene emits", "ours; cf. Peters 2025"},
    MethodKind{Kind::IlluminantMixture, "illuminant-mixture", "C", 1, 768, 1, true, "SAMPLER_MIXTURE",
               "C wavelengths from x̄ + ȳ + z̄ times the light that the scene emits", "ours"},
};

const MethodKind& description(Kind kind) {
    return *std::find_if(kinds.begin(), kinds.end(), [kind](const MethodKind& k) { return k.kind == kind; });
}

} // namespace

std::span<const MethodKind> method_kinds() {
    return kinds;
}

std::string pattern(const MethodKind& kind) {
    return kind.count_name == nullptr ? kind.name : fmt::format("{}:{}", kind.name, kind.count_name);
}

int Method::wavelengths() const {
    return count * description(kind).wavelengths;
}

bool Method::unbiased() const {
    return description(kind).unbiased;
}

std::string Method::name() const {
    const MethodKind& of = description(kind);
    return of.count_name == nullptr ? of.name : fmt::format("{}:{}", of.name, count);
}

Method parse_method(const std::string& text) {
    const std::size_t colon = std::min(text.find(':'), text.size());
    const std::string name = text.substr(0, colon);
    const auto* const found =
        std::find_if(kinds.begin(), kinds.end(), [&name](const MethodKind& kind) { return kind.name == name; });
    if (found == kinds.end()) {
        std::vector<std::string> patterns;
        for (const MethodKind& kind : kinds)
            patterns.push_back(pattern(kind));
        fail("unknown method '{}': expected {}; or auto, to render or bench", text, fmt::join(patterns, ", "));
    }
    if (found->count_name == nullptr) {
        if (colon == text.size())
            return {found->kind, found->most};
        fail("bad method '{}': nothing may follow {}", text, name);
    }
    const std::optional<int> count = parse_number<int>(text.substr(std::min(colon + 1, text.size())));
    if (!count || *count < found->least || *count > found->most) {
        if (found->least == found->most)
            fail("bad method '{}': expected {}", text, pattern(*found));
        fail("bad method '{}': expected {} with {} from {} to {}", text, pattern(*found), found->count_name,
             found->least, found->most);
    }
    return {found->kind, *count};
}

WavelengthLayout wavelength_layout(const Method& method) {
    WavelengthLayout layout;
    layout.w = method.wavelengths();
    layout.lanes = layout.w <= 4 ? 4 : layout.w <= 8 ? 8 : 16;
    layout.blocks = (layout.w + layout.lanes - 1) / layout.lanes;
    return layout;
}

Macros method_macros(const Method& method, bool random_sequence) {
    const WavelengthLayout layout = wavelength_layout(method);
    return {{"W", std::to_string(layout.w)},
            {"LANES", std::to_string(layout.lanes)},
            {"BLOCKS", std::to_string(layout.blocks)},
            {"SAMPLER", description(method.kind).sampler},
            {"SEQUENCE_RANDOM", random_sequence ? "1" : "0"}};
}

} // namespace tristim
