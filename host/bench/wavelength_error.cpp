#include "bench/wavelength_error.h"

#include "image/compare_images.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tristim {
namespace {

/// Passes one after the other; the numbers of the paths' and the wavelengths' seeds are independent.
void render(Renderer& renderer, std::uint64_t from, std::uint64_t to, std::uint32_t seed,
            std::uint32_t wavelength_seed) {
    for (std::uint64_t i = from; i < to; ++i) {
        const auto pass = static_cast<std::uint32_t>(i);
        renderer.render_pass({pass, seed, pass, wavelength_seed});
    }
}

/// Two renders of `passes` passes.
std::array<FilmImage, 2> render_two(std::shared_ptr<const DeviceScene> scene, const RenderOptions& options,
                                    const Device& device, std::uint64_t passes,
                                    const std::array<std::uint32_t, 2>& seeds,
                                    const std::array<std::uint32_t, 2>& wavelength_seeds) {
    std::array<FilmImage, 2> films;
    for (std::size_t i = 0; i < 2; ++i) {
        Renderer renderer(scene, options, device);
        render(renderer, 0, passes, seeds[i], wavelength_seeds[i]);
        films[i] = renderer.film();
    }
    return films;
}

double difference(const std::array<FilmImage, 2>& films) {
    return compare_images(xyz_image(films[0]), xyz_image(films[1])).rmse;
}

} // namespace

ExactImage exact_image(std::shared_ptr<const DeviceScene> scene, RenderOptions options, const Device& device,
                       std::uint64_t passes) {
    options.method = parse_method("spectral:400");
    const std::uint32_t seed = options.seed;
    const auto halves = render_two(std::move(scene), options, device, passes, {seed, seed}, {seed, ~seed});
    // The mean of two with independent errors of σ each errs by σ/√2, and they differ by √2 σ.
    return {xyz_image(merge(halves[0], halves[1])), 0.5 * difference(halves)};
}

double geometric_noise(std::shared_ptr<const DeviceScene> scene, const RenderOptions& options, const Device& device,
                       std::uint64_t passes) {
    const std::uint32_t seed = options.seed;
    return difference(render_two(std::move(scene), options, device, passes, {seed, ~seed}, {seed, seed}));
}

std::vector<std::uint64_t> doublings(std::uint64_t passes) {
    std::vector<std::uint64_t> list;
    for (std::uint64_t i = 1; i < passes; i *= 2)
        list.push_back(i);
    list.push_back(passes);
    return list;
}

WavelengthCurve wavelength_error(std::shared_ptr<const DeviceScene> scene, const RenderOptions& options,
                                 const Device& device, const XyzImage& exact, std::uint64_t passes, int repeats) {
    WavelengthCurve curve{doublings(passes), {}, {}};
    std::vector<double> squares(curve.passes.size()), fourth_powers(curve.passes.size());
    Renderer renderer(std::move(scene), options, device);
    for (int repeat = 0; repeat < repeats; ++repeat) {
        renderer.reset();
        std::uint64_t rendered = 0;
        for (std::size_t i = 0; i < curve.passes.size(); ++i) {
            render(renderer, rendered, curve.passes[i], options.seed,
                   options.seed + static_cast<std::uint32_t>(repeat));
            rendered = curve.passes[i];
            const double square = std::pow(compare_images(xyz_image(renderer.film()), exact).rmse, 2);
            squares[i] += square / repeats;
            fourth_powers[i] += square * square / repeats;
        }
    }
    for (std::size_t i = 0; i < squares.size(); ++i) {
        const double variance = std::max(fourth_powers[i] - squares[i] * squares[i], 0.0) / std::max(repeats - 1, 1);
        const double rmse = std::sqrt(squares[i]);
        curve.rmse.push_back(rmse);
        curve.standard_error.push_back(rmse > 0.0 ? 0.5 * std::sqrt(variance) / rmse : 0.0);
    }
    return curve;
}

} // namespace tristim
