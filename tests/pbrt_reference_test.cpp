// The image of a scene against pbrt-v4's own, at the same absolute scale (tests/data/README.md).

#include "image/read_image.h"
#include "image/write_image.h"
#include "render/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tristim {
namespace {

constexpr int side = 256;
constexpr int block = 8;

/// RMS difference of block means between two pbrt renders.
constexpr double stated_block_noise = 6.4e-4;

/// For every block and channel the mean difference over its standard error: the stated noise of the reference and, from
/// the scatter of the block's 64 differences, the noise of the pixels, ours and pbrt's own colour errors at edges
/// included.
std::vector<double> block_z_scores(const XyzImage& image, const XyzImage& reference, double scale) {
    std::vector<double> scores;
    for (int corner_y = 0; corner_y < side; corner_y += block) {
        for (int corner_x = 0; corner_x < side; corner_x += block) {
            for (std::size_t channel = 0; channel < 3; ++channel) {
                double sum = 0.0, squares = 0.0;
                for (int i = 0; i < block * block; ++i) {
                    const auto pixel = static_cast<std::size_t>((corner_y + i / block) * side + corner_x + i % block);
                    const double d = scale * image.xyz[pixel][channel] - reference.xyz[pixel][channel];
                    sum += d;
                    squares += d * d;
                }
                constexpr double n = block * block;
                const double mean = sum / n;
                const double variance_of_mean = std::max(squares / n - mean * mean, 0.0) / (n - 1.0);
                scores.push_back(mean / std::sqrt(variance_of_mean + stated_block_noise * stated_block_noise));
            }
        }
    }
    return scores;
}

double largest(const std::vector<double>& scores) {
    double most = 0.0;
    for (const double score : scores)
        most = std::max(most, std::abs(score));
    return most;
}

TEST(PbrtReference, DispersionImageAgreesInBlockMeans) {
    const std::string folder = std::string(TRISTIM_SOURCE_DIR) + "/tests/data/";
    const XyzImage reference = read_exr(folder + "dispersion-icosahedron.exr");
    const Scene scene = load_scene(folder + "dispersion-icosahedron.pbrt");
    RenderOptions options = options_from_scene(scene.settings);
    Renderer renderer(scene, options, open_device(""));
    constexpr std::uint32_t passes = 160;
    for (std::uint32_t pass = 0; pass < passes; ++pass)
        renderer.render_pass(pass);
    const FilmImage film = renderer.film();
    const XyzImage image = xyz_image(film);
    ASSERT_EQ(reference.xyz.size(), image.xyz.size());

    // Normal deviates beyond this have probability 0.01 in all 3,072 together (Šidák).
    constexpr double critical = 4.65;
    const double most = largest(block_z_scores(image, reference, 1.0));
    RecordProperty("largest_z_score", std::to_string(most));
    EXPECT_LT(most, critical);
    if (most >= critical) {
        const std::string path = testing::TempDir() + "dispersion-icosahedron-failed.exr";
        write_exr(path, image, ColourSpace::Srgb, {});
        ADD_FAILURE() << "the image is in " << path;
    }
    // The test would notice an error of 1 % in scale.
    EXPECT_GT(largest(block_z_scores(image, reference, 1.01)), critical);
    EXPECT_GT(largest(block_z_scores(image, reference, 0.99)), critical);
    EXPECT_EQ(film.rejected_samples, 0U);
}

} // namespace
} // namespace tristim
