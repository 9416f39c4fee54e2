// The error that a reference states of itself: the bookkeeping exactly, and the statement against what is true.
#include "base/error.h"
#include "bench/reference.h"
#include "bench/reference_snapshots.h"
#include "image_statistics.h"
#include "scene_folder.h"

#include <cmath>
#include <random>

namespace tristim::test {
namespace {

FilmImage film_of_passes(const std::vector<std::vector<std::array<float, 3>>>& passes, std::size_t begin,
                         std::size_t end) {
    FilmImage film{2, 1, {0, 0, 2, 1}, {}, {}, 0, end - begin};
    const auto n = static_cast<double>(end - begin);
    for (std::size_t i = 0; i < 2; ++i) {
        film.xyz.emplace_back();
        film.variance.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            double mean = 0.0;
            double squares = 0.0;
            for (std::size_t p = begin; p < end; ++p)
                mean += passes[p][i][c] / n;
            for (std::size_t p = begin; p < end; ++p)
                squares += (passes[p][i][c] - mean) * (passes[p][i][c] - mean);
            film.xyz[i][c] = static_cast<float>(mean);
            film.variance[i][c] = n > 1.0 ? static_cast<float>(squares / (n - 1.0) / n) : 0.0F;
        }
    }
    return film;
}

/// Two sets of passes merged have the mean and the variance of all of them, whatever their sizes.
TEST(FilmMerge, IsTheFilmOfAllPasses) {
    std::mt19937 engine(3);
    std::normal_distribution<float> normal(5.0F, 2.0F);
    std::vector<std::vector<std::array<float, 3>>> passes(40, std::vector<std::array<float, 3>>(2));
    for (auto& pass : passes) {
        for (auto& pixel : pass)
            pixel = {normal(engine), 100.0F + normal(engine), 0.01F * normal(engine)};
    }
    const FilmImage all = film_of_passes(passes, 0, passes.size());
    for (const std::size_t cut : {0U, 1U, 2U, 13U, 39U, 40U}) {
        FilmImage first = film_of_passes(passes, 0, cut);
        first.rejected_samples = 2;
        FilmImage second = film_of_passes(passes, cut, passes.size());
        second.rejected_samples = 5;
        const FilmImage both = merge(first, second);
        EXPECT_EQ(both.passes, passes.size());
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                // Three roundings to float; a variance also takes those of the means, of 100 ± 2 at most, into account.
                EXPECT_NEAR(both.xyz[i][c], all.xyz[i][c], 3e-7 * all.xyz[i][c]) << cut;
                EXPECT_NEAR(both.variance[i][c], all.variance[i][c], 2e-5 * all.variance[i][c]) << cut;
            }
        }
        const std::uint64_t rejected = cut == 0 ? 5 : cut == passes.size() ? 2 : 7; // of films that have passes
        EXPECT_EQ(both.rejected_samples, rejected);
    }
}

HalfFilms films_of(std::uint64_t passes) {
    FilmImage film;
    film.passes = passes;
    return {film, film};
}

TEST(ReferenceSnapshots, KeepTheOneNearestToAnEighth) {
    ReferenceSnapshots powers;
    EXPECT_EQ(powers.best(5), nullptr);
    for (std::uint64_t passes = 1, added = 1; passes <= 5000; ++passes) {
        if (passes == added) {
            powers.add(films_of(added));
            added *= 2;
        }
        if (passes % 7 != 0)
            continue;
        const HalfFilms* best = powers.best(passes);
        ASSERT_NE(best, nullptr) << passes;
        const double ratio = 8.0 * static_cast<double>((*best)[0].passes) / static_cast<double>(passes);
        EXPECT_LE(std::abs(std::log2(ratio)), passes < 8 ? 1.1 : 0.5 + 1e-9) << passes;
    }
}

TEST(ReferenceSnapshots, AreNeverOfAllPasses) {
    ReferenceSnapshots snapshots;
    snapshots.add(films_of(10));
    EXPECT_EQ(snapshots.best(10), nullptr);
    ASSERT_NE(snapshots.best(11), nullptr);
    // Continued from a file of 100 passes with a snapshot of 10: those of the file's own passes serve from 253 on.
    snapshots.add(films_of(100));
    EXPECT_EQ((*snapshots.best(100))[0].passes, 10U);
    EXPECT_EQ((*snapshots.best(252))[0].passes, 10U); // √(10 · 100) = 252.98 / 8
    EXPECT_EQ((*snapshots.best(253))[0].passes, 100U);
}

Reference plain_reference(std::uint64_t first, std::uint64_t second) {
    Reference reference;
    reference.image = {4, 2, {0, 0, 4, 2}, std::vector<std::array<float, 3>>(8)};
    reference.passes = first + second;
    reference.halves[0] = {first, reference.image.xyz, {}};
    reference.halves[1] = {second, reference.image.xyz, {}};
    reference.settings = {{"alpha", "0.6666666666666666"}};
    return reference;
}

TEST(ReferenceSummary, NoiseIsThatOfTheWeightedHalves) {
    Reference reference = plain_reference(30, 10);
    for (std::size_t i = 0; i < 8; ++i)
        reference.halves[0].xyz[i] = i % 4 < 2 ? std::array{0.3F, 0.0F, -0.4F} : std::array{0.0F, 1.0F, 0.0F};
    const NamedRegion left{"left", {0, 0, 2, 2}};
    const NamedRegion right{"right", {2, 0, 2, 1}};
    const ReferenceSummary summary = summarise_reference(reference, {left, right});
    // With variance v per pass: Var(a − b) = v/30 + v/10 = 16/3 · v/40, of which the image's is v/40.
    EXPECT_NEAR(summary.noise[0], std::sqrt(3.0 / 16.0 * (0.09 + 0.16) / 3.0), 1e-7);
    EXPECT_NEAR(summary.noise[1], std::sqrt(3.0 / 16.0 / 3.0), 1e-7);
    EXPECT_EQ(summary.bias, (std::vector<double>{0.0, 0.0}));
    EXPECT_EQ(summary.floor, summary.noise);
    EXPECT_EQ(error_of([&] {
                  summarise_reference(reference, {{"far", {3, 1, 2, 1}}});
              }),
              "region \"far\" is not inside the reference's");
}

TEST(ReferenceSummary, BiasFollowsTheMeanSquaredRadius) {
    Reference reference = plain_reference(40, 40);
    reference.snapshot_passes = 5;
    // Blur of 0.2 in a single channel of the image, in both halves alike, as it is after 80 passes.
    const double blur = mean_squared_radius(1.0, 10) / mean_squared_radius(1.0, 80);
    for (ReferenceHalf& half : reference.halves) {
        half.xyz.assign(8, {1.2F, 0.0F, 0.0F});
        half.snapshot.assign(8, {static_cast<float>(1.0 + 0.2 * blur), 0.0F, 0.0F});
    }
    const NamedRegion all{"image", {0, 0, 4, 2}};
    const ReferenceSummary blurred = summarise_reference(reference, {all});
    EXPECT_NEAR(blurred.bias[0], 0.2 / std::sqrt(3.0), 1e-6);
    EXPECT_NEAR(blurred.floor[0], blurred.bias[0], 1e-7);
    // What the snapshots do not have in common is noise.
    for (std::size_t i = 0; i < 8; ++i)
        reference.halves[1].snapshot[i][0] = i % 2 == 0 ? 1.1F : 1.3F;
    EXPECT_NEAR(summarise_reference(reference, {all}).bias[0], 0.0, 1e-4);
    // An estimate of a square below zero says that there is nothing to see.
    for (auto& pixel : reference.halves[1].snapshot)
        pixel[0] = 1.0F;
    EXPECT_EQ(summarise_reference(reference, {all}).bias[0], 0.0);
}

/// Passes of a scene as a reference, without writing more than a temporary file.
Reference reference_of(const Scene& scene, RenderOptions options, std::uint32_t seed, std::uint64_t passes) {
    const SceneFolder folder;
    options.seed = seed;
    return render_reference(scene, "scene.pbrt", options, test_device(), 1e9, folder.path("reference.exr"),
                            [passes](std::uint64_t done, double) { return done < passes; });
}

/// RMS² over pixels and channels.
double mean_square(const std::vector<std::array<float, 3>>& a, const std::vector<std::array<float, 3>>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            sum += (static_cast<double>(a[i][c]) - b[i][c]) * (static_cast<double>(a[i][c]) - b[i][c]);
    }
    return sum / (3.0 * static_cast<double>(a.size()));
}

/// Edges of bright squares, which the passes of a render meet in a stratified way: the references' stated noise is the
/// spread of references with other seeds, which the spread over passes overstates.
TEST(ReferenceNoise, IsTheSpreadOverSeeds) {
    constexpr int side = 12;
    constexpr std::size_t count = 16;
    Scene scene;
    scene.path = "squares";
    scene.camera = look_at({0, 0, 3}, {0.1, 0.2, 0}, {0, 1, 0}, 50.0);
    const int light = add_area_light(scene, Spectrum::named("stdillum-D65"), 1.0);
    for (int i = 0; i < 9; ++i)
        add_parallelogram(scene, {-1.37 + 0.9 * (i % 3), -1.29 + 0.9 * (i / 3), 0.0}, {0.41, 0.05, 0.0},
                          {-0.05, 0.41, 0.0}, add_diffuse(scene, Spectrum::constant(0.0)), light);
    RenderOptions options = small_render("spectral:400", side, side, 1, 0.1, 2);
    std::vector<Reference> references;
    for (std::uint32_t seed = 1; seed <= count; ++seed)
        references.push_back(reference_of(scene, options, seed, 64));

    std::vector<std::array<float, 3>> mean(side * side);
    for (const Reference& reference : references) {
        for (std::size_t i = 0; i < mean.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                mean[i][c] += reference.image.xyz[i][c] / static_cast<float>(count);
        }
    }
    std::vector<double> stated, from_passes, actual;
    for (const Reference& reference : references) {
        const double noise = summarise_reference(reference, {{"image", reference.image.region}}).noise[0];
        stated.push_back(noise * noise);
        double variance = 0.0;
        for (const auto& pixel : reference.variance)
            variance += (static_cast<double>(pixel[0]) + pixel[1] + pixel[2]) / (3.0 * side * side);
        from_passes.push_back(variance);
        actual.push_back(mean_square(reference.image.xyz, mean) * static_cast<double>(count) / (count - 1.0));
    }
    const Estimate truth = estimate(actual);
    const Estimate claim = estimate(stated);
    // Four standard errors: 1 chance in 10 000.
    const double margin = 4.0 * std::sqrt(truth.squared_error + claim.squared_error);
    EXPECT_NEAR(claim.mean, truth.mean, margin);
    RecordProperty("noise", fmt::format("{} stated, {} true, +- {}", claim.mean, truth.mean, margin));
    EXPECT_LT(margin, 0.5 * truth.mean) << "too few references to tell";
    EXPECT_GT(estimate(from_passes).mean, truth.mean + margin) << "then halves would not be needed";
}

/// A plane under a point light, by photons alone: the blur of the search radius is known from the light's formula.
TEST(ReferenceBias, IsTheBlurOfTheSearchRadius) {
    constexpr int side = 10;
    constexpr double radius = 0.6;
    constexpr int passes = 64;
    const Scene scene = plane_under_point_light({0.2, -0.1, 1.5}, 45.0);
    const Light& light = scene.lights.front();
    RenderOptions options = small_render("tristimulus:4", side, side, 8192, radius, 4);
    options.direct_photons = true;

    const double squared_radius = mean_squared_radius(radius, passes);
    const Xyz white = spectrum_to_xyz(light.emission);
    double expected = 0.0;
    for (int i = 0; i < side * side; ++i) {
        const double blur = pixel_mean(scene.camera, side, side, i % side, i / side, [&](const CameraRay& ray) {
            const V3d p = at_height(ray, 0.0);
            const auto radiance = [&](double dx, double dy) { return plane_radiance(light, p + V3d(dx, dy, 0.0)); };
            return disc_mean(squared_radius, radiance) - radiance(0.0, 0.0);
        });
        for (const double component : white)
            expected += blur * component * blur * component / (3.0 * side * side);
    }
    std::vector<double> squares;
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
        const Reference reference = reference_of(scene, options, seed, passes);
        const double bias = summarise_reference(reference, {{"image", reference.image.region}}).bias[0];
        squares.push_back(bias * bias);
    }
    const Estimate bias = estimate(squares);
    // The light's formula has terms of order r⁴ beyond the blur's r²; they are to the r² ones about as (r/2h)² = 1/25
    // in the mean. The snapshot's r² is twice the image's.
    const double margin = 4.0 * std::sqrt(bias.squared_error) + 0.1 * expected;
    EXPECT_NEAR(bias.mean, expected, margin);
    RecordProperty("bias", fmt::format("{} stated, {} true, +- {}", bias.mean, expected, margin));
    EXPECT_LT(margin, 0.5 * expected) << "too few references to tell";
}

} // namespace
} // namespace tristim::test
