#include "films/film_colour.h"

#include "base/error.h"
#include "image/tone_mapping.h"

#include <algorithm>
#include <cmath>

namespace tristim {
namespace {

constexpr double tolerance = 1e-5;    // of X, Y and Z
constexpr int samples_per_fringe = 4; // at first
constexpr int max_parts_per_nm = 8192;
constexpr int least_cells_per_nm = 64; // in which the light's mean wavelength is found
constexpr std::size_t responses_at_once = 1U << 21;

double largest_difference(const std::vector<FilmColour>& a, const std::vector<FilmColour>& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            largest = std::max({largest, std::abs(a[i].reflected[c] - b[i].reflected[c]),
                                std::abs(a[i].transmitted[c] - b[i].transmitted[c])});
        }
    }
    return largest;
}

} // namespace

FilmColours::FilmColours(const FilmEvaluator& evaluator, const Spectrum& light) : evaluator_(evaluator), light_(light) {
    check_stack_covers(evaluator.stack(), lambda_min_nm, lambda_max_nm);
}

const FilmColours::Nodes& FilmColours::nodes(int parts_per_nm) {
    const auto [found, is_new] = nodes_.try_emplace(parts_per_nm);
    Nodes& result = found->second;
    if (!is_new)
        return result;
    const std::array<Spectrum, 3> matching{Spectrum::named("cie-x"), Spectrum::named("cie-y"),
                                           Spectrum::named("cie-z")};
    const int cells_per_part = std::max(1, least_cells_per_nm / parts_per_nm);
    const double cell = 1.0 / (static_cast<double>(cells_per_part) * parts_per_nm);
    double sum_y = 0.0;
    for (int part = 0; part < lambda_bins * parts_per_nm; ++part) {
        double light = 0.0, moment = 0.0;
        for (int i = 0; i < cells_per_part; ++i) {
            const double from = lambda_min_nm + cell * (static_cast<double>(part) * cells_per_part + i);
            const double mean = light_.mean(from, from + cell);
            light += mean;
            moment += mean * (from + 0.5 * cell);
        }
        if (!(light > 0.0))
            continue;
        const double lambda = moment / light;
        Xyz weight{};
        for (std::size_t c = 0; c < 3; ++c)
            weight[c] = light * matching[c](lambda);
        sum_y += weight[1];
        result.lambda_nm.push_back(lambda);
        result.weights.push_back(weight);
    }
    for (Xyz& weight : result.weights) {
        for (double& w : weight)
            w /= sum_y;
    }
    return result;
}

Xyz FilmColours::white() const {
    const Xyz xyz = spectrum_to_xyz(light_);
    return {xyz[0] / xyz[1], 1.0, xyz[2] / xyz[1]};
}

std::vector<FilmColour> FilmColours::sums(int parts_per_nm, double angle_deg, std::optional<std::size_t> layer,
                                          const std::vector<double>& thicknesses) {
    const Nodes& quadrature = nodes(parts_per_nm);
    const std::size_t count = quadrature.lambda_nm.size();
    const std::size_t films_at_once = std::max<std::size_t>(1, responses_at_once / count);
    std::vector<FilmColour> result;
    for (std::size_t begin = 0; begin < thicknesses.size(); begin += films_at_once) {
        const std::vector<double> some(
            thicknesses.begin() + static_cast<std::ptrdiff_t>(begin),
            thicknesses.begin() + static_cast<std::ptrdiff_t>(std::min(begin + films_at_once, thicknesses.size())));
        const std::vector<FilmResponse> responses =
            layer ? evaluator_.evaluate(quadrature.lambda_nm, angle_deg, *layer, some)
                  : evaluator_.evaluate(quadrature.lambda_nm, angle_deg);
        for (std::size_t film = 0; film < some.size(); ++film) {
            FilmColour& colour = result.emplace_back();
            for (std::size_t i = 0; i < count; ++i) {
                const FilmResponse& response = responses[film * count + i];
                for (std::size_t c = 0; c < 3; ++c) {
                    colour.reflected[c] += quadrature.weights[i][c] * response.reflected();
                    colour.transmitted[c] += quadrature.weights[i][c] * response.transmitted();
                }
            }
        }
    }
    return result;
}

double FilmColours::fringes_per_nm(std::optional<std::size_t> layer, double thickness) const {
    double optical_path = 0.0; // Fringes of twice the path d·n over λ²; highest at the short end
    const FilmStack& stack = evaluator_.stack();
    for (std::size_t i = 0; i < stack.layers.size(); ++i)
        optical_path += stack.layers[i].index.eta(lambda_min_nm) * (i == layer ? thickness : stack.layers[i].thickness);
    return 2.0 * optical_path / (lambda_min_nm * lambda_min_nm);
}

std::vector<FilmColour> FilmColours::converged(double angle_deg, std::optional<std::size_t> layer,
                                               const std::vector<double>& thicknesses) {
    const double thickest = thicknesses.empty() ? 0.0 : *std::max_element(thicknesses.begin(), thicknesses.end());
    int parts = 1;
    while (parts < samples_per_fringe * fringes_per_nm(layer, thickest))
        parts *= 2;
    std::vector<FilmColour> coarse;
    for (; parts <= max_parts_per_nm; parts *= 2) {
        std::vector<FilmColour> fine = sums(parts, angle_deg, layer, thicknesses);
        if (!coarse.empty() && largest_difference(coarse, fine) <= tolerance)
            return fine;
        coarse = std::move(fine);
    }
    fail("the colour of the stack \"{}\" does not settle: its fringes are finer than 1/{} nm",
         evaluator_.stack().description(), max_parts_per_nm);
}

FilmColour FilmColours::colour(double angle_deg) {
    return converged(angle_deg, std::nullopt, {0.0}).front();
}

std::vector<FilmColour> FilmColours::colours(double angle_deg, std::size_t layer,
                                             const std::vector<double>& thicknesses) {
    // Thin films need fewer wavelengths than thick ones.
    constexpr std::size_t films_per_batch = 64;
    std::vector<FilmColour> result;
    for (std::size_t begin = 0; begin < thicknesses.size(); begin += films_per_batch) {
        const auto end = std::min(begin + films_per_batch, thicknesses.size());
        const std::vector<FilmColour> batch = converged(angle_deg, layer,
                                                        {thicknesses.begin() + static_cast<std::ptrdiff_t>(begin),
                                                         thicknesses.begin() + static_cast<std::ptrdiff_t>(end)});
        result.insert(result.end(), batch.begin(), batch.end());
    }
    return result;
}

std::string DisplayColour::hex() const {
    return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

DisplayColour display_colour(const Xyz& xyz) {
    constexpr double largest = 255.0;
    // Where a channel starts to round to -1: the sRGB curve's straight part has slope 12.92.
    constexpr double lowest_linear = -0.5 / largest / 12.92;
    DisplayColour colour;
    const Rgb rgb = xyz_to_rgb(xyz);
    for (std::size_t c = 0; c < 3; ++c) {
        const double encoded = largest * srgb_encode(std::max(rgb[c], 0.0));
        colour.clipped = colour.clipped || rgb[c] < lowest_linear || encoded >= largest + 0.5;
        colour.rgb[c] = static_cast<int>(std::lround(std::min(encoded, largest)));
    }
    return colour;
}

std::optional<std::array<double, 2>> chromaticity(const Xyz& xyz) {
    const double sum = xyz[0] + xyz[1] + xyz[2];
    if (!(sum > 0.0))
        return std::nullopt;
    return std::array{xyz[0] / sum, xyz[1] / sum};
}

} // namespace tristim
