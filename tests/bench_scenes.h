#pragma once
// Scenes whose image is known exactly, for tests of what a bench measures.

#include "bench/contestant.h"
#include "image/image.h"
#include "image_statistics.h"

#include <cmath>
#include <functional>

namespace tristim::test {

/// The share of a pixel that shines.
using Coverage = std::function<double(int x, int y)>;

/// In the middle of each of size × size pixels a square that covers this share of it, emits radiance 1 at every
/// wavelength and reflects nothing, before black.
inline Scene lattice(int size, const Coverage& coverage) {
    Scene scene;
    scene.path = "lattice";
    scene.camera = look_at({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 90.0);
    const int black = add_diffuse(scene, Spectrum::constant(0.0));
    const int light = add_area_light(scene, Spectrum::constant(1.0), 1.0);
    // At distance 1 the image spans [-1, 1]², and raster x runs along -y.
    const double pixel = 2.0 / size;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const double side = std::sqrt(coverage(x, y));
            const double margin = 0.5 * (1.0 - side);
            add_parallelogram(scene, {1.0, 1.0 - pixel * (x + margin), 1.0 - pixel * (y + 1.0 - margin)},
                              {0.0, -pixel * side, 0.0}, {0.0, 0.0, pixel * side}, black, light);
        }
    }
    return scene;
}

/// A lamp's light all around: no noise but that of the wavelengths, which all pixels share.
inline Scene lamp(const std::string& spectrum, double radiance) {
    Scene scene;
    scene.path = "lamp";
    scene.camera = look_at({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 40.0);
    scene.lights = {environment(Spectrum::named(spectrum))};
    scene.lights[0].scale = radiance;
    // Behind the camera: an empty scene is none.
    add_parallelogram(scene, {-5, -1, -1}, {0, 1, 0}, {0, 0, 1}, add_diffuse(scene, Spectrum::constant(0.5)));
    return scene;
}

/// The image whose pixels are multiples of one colour.
inline TestImage exact_image(int width, int height, const Xyz& colour, const Coverage& factor) {
    TestImage image{width, height, {}};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x)
            image.xyz.push_back({factor(x, y) * colour[0], factor(x, y) * colour[1], factor(x, y) * colour[2]});
    }
    return image;
}

inline Xyz equal_energy_white() {
    return integrate_xyz(Spectrum::constant(1.0), [](double) { return 1.0; });
}

inline XyzImage to_reference(const TestImage& image) {
    XyzImage reference{image.width, image.height, {0, 0, image.width, image.height}, {}};
    for (const Xyz& v : image.xyz)
        reference.xyz.push_back({static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])});
    return reference;
}

/// The paper's equation 12 and relMSE (Rousselle, Knaus & Zwicker 2011, ε = 0.01) of a film against an exact image.
struct TrueError {
    double rmse = 0.0;
    double rel_mse = 0.0;
};

inline TrueError true_error(const FilmImage& film, const TestImage& exact, const Region& region) {
    TrueError error;
    for (int y = region.y; y < region.y + region.height; ++y) {
        for (int x = region.x; x < region.x + region.width; ++x) {
            const auto& is =
                film.xyz.at(static_cast<std::size_t>((y - film.region.y) * film.region.width + x - film.region.x));
            const Xyz& should = exact.xyz.at(static_cast<std::size_t>(y * exact.width + x));
            for (std::size_t c = 0; c < 3; ++c) {
                const double square = std::pow(static_cast<double>(is[c]) - should[c], 2);
                error.rmse += square / (3.0 * region.pixels());
                error.rel_mse += square / (should[c] * should[c] + 0.01) / (3.0 * region.pixels());
            }
        }
    }
    error.rmse = std::sqrt(error.rmse);
    return error;
}

/// Root mean square of an image's values.
inline double root_mean_square(const TestImage& image, const Region& region) {
    const std::vector<std::array<float, 3>> black(image.xyz.size());
    return true_error({image.width, image.height, {0, 0, image.width, image.height}, black, {}, 0, 1}, image, region)
        .rmse;
}

/// A contestant that never reaches a checkpoint by itself: render(0) is one pass.
inline Contestant pass_by_pass(const Scene& scene, const RenderOptions& options) {
    return {Renderer(scene, options, test_device()), {1e9}};
}

/// A repeat measured after 1, 2, 4, … passes, up to 2^doublings.
inline Repeat measure_doublings(const Scene& scene, const RenderOptions& options, const XyzImage& reference,
                                const std::vector<NamedRegion>& regions, int doublings) {
    Contestant contestant = pass_by_pass(scene, options);
    int passes = 0;
    for (int k = 0; k <= doublings; ++k) {
        for (; passes < 1 << k; ++passes)
            contestant.render(0.0);
        contestant.measure(reference, regions);
    }
    return contestant.repeat();
}

/// The same repeat on a machine where every pass takes a millisecond, so that what follows does not depend on how busy
/// this one is.
inline Repeat with_steady_clock(Repeat repeat) {
    for (CurvePoint& checkpoint : repeat.checkpoints)
        checkpoint.seconds = 1e-3 * static_cast<double>(checkpoint.passes);
    return repeat;
}

} // namespace tristim::test
