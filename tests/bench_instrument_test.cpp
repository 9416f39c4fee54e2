// Whether a bench measures what it says: error against exact images, bias, agreement of equals, time and fairness.
#include "base/stopwatch.h"
#include "bench/analysis.h"
#include "bench/race.h"
#include "bench_scenes.h"
#include "synthetic_runs.h"

#include <limits>
#include <numeric>

namespace tristim::test {
namespace {

constexpr int lattice_size = 24;

double lattice_coverage(int x, int y) {
    return 0.1 + 0.8 * (x + 0.5 * y) / (1.5 * lattice_size);
}

const std::vector<NamedRegion>& lattice_regions() {
    static const std::vector<NamedRegion> regions{{"image", {0, 0, lattice_size, lattice_size}},
                                                  {"dark", {0, 0, 9, 11}},
                                                  {"bright", {16, 5, 7, 19}},
                                                  {"pixel", {17, 3, 1, 1}}};
    return regions;
}

TestImage exact_lattice() {
    return exact_image(lattice_size, lattice_size, equal_energy_white(), lattice_coverage);
}

RenderOptions lattice_options(const std::string& method, std::uint32_t seed) {
    RenderOptions options = small_render(method, lattice_size, lattice_size, 64, 0.1, 2);
    options.seed = seed;
    return options;
}

/// Rounding the exact image to float moves a root mean square, which is a norm, by half a unit of its largest value at
/// most.
double rounding_of(const TestImage& exact) {
    double largest = 0.0;
    for (const Xyz& xyz : exact.xyz)
        largest = std::max({largest, xyz[0], xyz[1], xyz[2]});
    return largest * std::numeric_limits<float>::epsilon() / 2.0 + 1e-12;
}

/// Each checkpoint of a race against the error of the same passes rendered again, summed up here.
TEST(BenchInstrument, MeasuredErrorIsTheTrueOne) {
    const Scene scene = lattice(lattice_size, lattice_coverage);
    const TestImage exact = exact_lattice();
    const std::vector<RenderOptions> options{lattice_options("tristimulus:1", 3), lattice_options("rgb", 4)};
    std::vector<Contestant> contestants;
    for (const RenderOptions& of_one : options)
        contestants.emplace_back(Renderer(scene, of_one, test_device()), checkpoint_times(0.1));
    run_race(contestants, to_reference(exact), lattice_regions(), 0.01, [](double) { return true; });

    const double rounding = rounding_of(exact);
    for (std::size_t i = 0; i < contestants.size(); ++i) {
        const Repeat& repeat = contestants[i].repeat();
        EXPECT_TRUE(repeat.finished);
        EXPECT_EQ(repeat.seed, options[i].seed);
        ASSERT_FALSE(repeat.checkpoints.empty());
        Renderer renderer(scene, options[i], test_device());
        std::uint64_t passes = 0;
        for (const CurvePoint& checkpoint : repeat.checkpoints) {
            EXPECT_GT(checkpoint.passes, passes);
            EXPECT_EQ(checkpoint.photons, checkpoint.passes * 64);
            EXPECT_GT(checkpoint.memory, 0U);
            for (; passes < checkpoint.passes; ++passes)
                renderer.render_pass(static_cast<std::uint32_t>(passes));
            const FilmImage film = renderer.film();
            for (std::size_t r = 0; r < lattice_regions().size(); ++r) {
                const TrueError error = true_error(film, exact, lattice_regions()[r].region);
                EXPECT_NEAR(checkpoint.rmse.at(r), error.rmse, rounding) << lattice_regions()[r].name;
                // A relative error δ of b changes (a-b)²/(b²+ε) by less than 2δ (|a-b| b + (a-b)² b²/(b²+ε))/(b²+ε).
                EXPECT_NEAR(checkpoint.rel_mse.at(r), error.rel_mse, 1e-6 * (1.0 + error.rel_mse))
                    << lattice_regions()[r].name;
            }
        }
        EXPECT_GE(repeat.checkpoints.back().seconds, 0.1);
    }
}

/// A render of a part of the image is measured at the right pixels.
TEST(BenchInstrument, MeasuredErrorOfACroppedRenderIsTheTrueOne) {
    const Scene scene = lattice(lattice_size, lattice_coverage);
    const TestImage exact = exact_lattice();
    RenderOptions options = lattice_options("tristimulus:1", 5);
    options.region = {4, 2, 16, 21};
    const std::vector<NamedRegion> regions{{"image", options.region}, {"inner", {7, 9, 5, 3}}};
    const Repeat repeat = measure_doublings(scene, options, to_reference(exact), regions, 0);
    Renderer renderer(scene, options, test_device());
    renderer.render_pass(0);
    const FilmImage film = renderer.film();
    for (std::size_t r = 0; r < regions.size(); ++r)
        EXPECT_NEAR(repeat.checkpoints.at(0).rmse.at(r), true_error(film, exact, regions[r].region).rmse,
                    rounding_of(exact));
}

/// One pass takes one point of each pixel, so that a pixel of coverage p is white with probability p: the squared error
/// has mean p(1-p), and from p(1-p)⁴ + (1-p)p⁴ its variance. Sums over pixels and seeds are normal.
TEST(BenchInstrument, MeasuredNoiseIsTheExpectedOne) {
    constexpr int seeds = 4;
    const Scene scene = lattice(lattice_size, lattice_coverage);
    const XyzImage reference = to_reference(exact_lattice());
    const Xyz white = equal_energy_white();
    const double white_square = (white[0] * white[0] + white[1] * white[1] + white[2] * white[2]) / 3.0;
    std::vector<Repeat> repeats;
    for (std::uint32_t seed = 0; seed < seeds; ++seed)
        repeats.push_back(
            measure_doublings(scene, lattice_options("tristimulus:1", seed), reference, lattice_regions(), 0));
    constexpr std::size_t regions = 3; // one pixel is no normal sum
    // Two-sided, three regions, Šidák-corrected as in image_statistics.h: P(|z| > 3.89) = 1e-4.
    constexpr double largest_z = 3.89;
    for (std::size_t r = 0; r < regions; ++r) {
        const Region& region = lattice_regions()[r].region;
        double expected = 0.0;
        double variance = 0.0;
        for (int y = region.y; y < region.y + region.height; ++y) {
            for (int x = region.x; x < region.x + region.width; ++x) {
                const double p = lattice_coverage(x, y);
                const double mean = p * (1.0 - p);
                expected += seeds * mean;
                variance += seeds * (p * std::pow(1.0 - p, 4) + (1.0 - p) * std::pow(p, 4) - mean * mean);
            }
        }
        double measured = 0.0;
        for (const Repeat& repeat : repeats)
            measured += std::pow(repeat.checkpoints.at(0).rmse.at(r), 2) / white_square * region.pixels();
        const double z = (measured - expected) / std::sqrt(variance);
        RecordProperty("z-" + lattice_regions()[r].name, std::to_string(z));
        EXPECT_LT(std::abs(z), largest_z)
            << lattice_regions()[r].name << ": " << measured << " against " << expected << " ± " << std::sqrt(variance);
        EXPECT_LT(std::sqrt(variance), 0.1 * expected) << "too few pixels to show an error of the instrument";
    }
}

constexpr int lamp_doublings = 11;
const std::vector<NamedRegion>& lamp_regions() {
    static const std::vector<NamedRegion> regions{{"image", {0, 0, 8, 4}}, {"corner", {5, 1, 3, 2}}};
    return regions;
}

/// Errors over the last decade of time that lie within `factor` times the noise of `level`, so that their logarithms
/// are within w of its, have a fitted slope Σ (x-x̄) y / Σ (x-x̄)² of at most w Σ |x-x̄| / Σ (x-x̄)².
double largest_slope(const Curve& curve, const Curve& noise, double level, double factor) {
    std::vector<double> x;
    double w = 0.0;
    for (std::size_t i = 0; i < curve.seconds.size(); ++i) {
        if (curve.seconds[i] < 0.1 * curve.seconds.back())
            continue;
        x.push_back(std::log(curve.seconds[i]));
        w = std::max(w, -std::log(1.0 - factor * noise.high[i] / level));
    }
    const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
    double distances = 0.0;
    double squares = 0.0;
    for (const double value : x) {
        distances += std::abs(value - mean);
        squares += (value - mean) * (value - mean);
    }
    return w * distances / squares;
}

/// The same scene with its light 2 % stronger. Light is linear, so the biased film is 1.02 times the unbiased one of
/// the same seed and its error is 0.02 · exact + 1.02 · (unbiased error); by the triangle inequality its RMS is
/// within 1.02 times the unbiased one's of 0.02 times the image's RMS. 2e-5 is the rounding of image_statistics.h.
TEST(BenchInstrument, BiasOfTwoPercentIsSeenToFlatten) {
    constexpr double radiance = 2.5;
    constexpr double bias = 0.02;
    const Xyz lamp_colour = integrate_xyz(Spectrum::named("stdillum-D65"), [](double) { return radiance; });
    const TestImage exact = exact_image(8, 4, lamp_colour, [](int, int) { return 1.0; });
    const XyzImage reference = to_reference(exact);
    RenderOptions options = small_render("tristimulus:1", 8, 4, 64, 0.1, 2);
    std::vector<BenchRun> runs;
    for (const double factor : {1.0, 1.0 + bias}) {
        BenchRun run;
        run.id = run.label = factor == 1.0 ? "unbiased" : "biased";
        for (options.seed = 1; options.seed <= 2; ++options.seed)
            run.repeats.push_back(with_steady_clock(measure_doublings(lamp("stdillum-D65", factor * radiance), options,
                                                                      reference, lamp_regions(), lamp_doublings)));
        runs.push_back(run);
    }
    for (std::size_t r = 0; r < lamp_regions().size(); ++r) {
        const double rms = root_mean_square(exact, lamp_regions()[r].region);
        for (std::size_t k = 0; k < runs[0].repeats.size(); ++k) {
            for (std::size_t i = 0; i <= lamp_doublings; ++i) {
                const double unbiased = runs[0].repeats[k].checkpoints.at(i).rmse.at(r);
                const double biased = runs[1].repeats[k].checkpoints.at(i).rmse.at(r);
                EXPECT_NEAR(biased, bias * rms, (1.0 + bias) * unbiased + 2e-5 * rms);
            }
            // Noise large at first and gone at last, so that this shows a curve which falls and then stops.
            EXPECT_GT(runs[0].repeats[k].checkpoints.front().rmse.at(r), 2.0 * bias * rms);
            EXPECT_LT(runs[0].repeats[k].checkpoints.back().rmse.at(r), 0.1 * bias * rms);
        }
    }

    SceneResults scene = scene_of(runs);
    scene.regions = lamp_regions();
    scene.reference.noise = scene.reference.bias = scene.reference.floor = {0.0, 0.0};
    const auto summary = summarise(scene);
    for (std::size_t r = 0; r < lamp_regions().size(); ++r) {
        const double level = bias * root_mean_square(exact, lamp_regions()[r].region);
        const Curve biased = error_curve(runs[1], r);
        EXPECT_NEAR(biased.median.back(), level, 0.1 * level);
        const double slope = summary["curves"][1][r]["slope"].get<double>();
        EXPECT_LE(std::abs(slope), largest_slope(biased, error_curve(runs[0], r), level, 1.0 + bias));
        EXPECT_LT(largest_slope(biased, error_curve(runs[0], r), level, 1.0 + bias), 0.1);
        EXPECT_LT(summary["curves"][0][r]["slope"].get<double>(), -0.5);
        const std::string text = summary["groups"][0][r]["text"];
        EXPECT_NE(text.find("biased is stuck at"), std::string::npos) << text;
        EXPECT_EQ(text.find("unbiased is stuck"), std::string::npos) << text;
    }
}

/// Two groups of nine repeats that differ in the seed alone: at each time the 18 errors are in any order equally
/// likely, so that all of one group lie above all of the other with probability 2 · 9!²/18! = 4.1e-5, at one of seven
/// times with less than 2.9e-4. A third group with stronger light, whose bias outweighs the noise at the end, shows
/// that bands can part.
TEST(BenchInstrument, EqualMethodsAgreeWithinTheirBands) {
    constexpr int size = 8;
    constexpr int doublings = 6;
    const auto coverage = [](int x, int y) { return 0.2 + 0.08 * (x + 0.1 * y); };
    const Scene scene = lattice(size, coverage);
    Scene stronger = scene;
    stronger.lights[0].scale *= 1.2;
    const TestImage exact = exact_image(size, size, equal_energy_white(), coverage);
    const std::vector<NamedRegion> regions{{"image", {0, 0, size, size}}, {"half", {0, 0, size, size / 2}}};
    RenderOptions options = small_render("tristimulus:1", size, size, 64, 0.1, 2);
    const auto run = [&](const Scene& of, std::uint32_t first_seed, std::uint32_t repeats) {
        BenchRun result;
        for (options.seed = first_seed; options.seed < first_seed + repeats; ++options.seed)
            result.repeats.push_back(
                with_steady_clock(measure_doublings(of, options, to_reference(exact), regions, doublings)));
        return result;
    };
    const BenchRun a = run(scene, 0, 9);
    const BenchRun b = run(scene, 100, 9);
    const BenchRun other = run(stronger, 200, 2);
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const Curve of_a = error_curve(a, r);
        const Curve of_b = error_curve(b, r);
        const Curve of_other = error_curve(other, r);
        ASSERT_EQ(of_a.seconds, of_b.seconds);
        ASSERT_EQ(of_a.seconds.size(), std::size_t{doublings + 1});
        for (std::size_t i = 0; i < of_a.seconds.size(); ++i) {
            EXPECT_LT(of_a.low[i], of_a.high[i]) << "seeds must differ";
            EXPECT_LE(of_a.low[i], of_b.high[i]) << regions[r].name << " after " << (1 << i) << " passes";
            EXPECT_LE(of_b.low[i], of_a.high[i]) << regions[r].name << " after " << (1 << i) << " passes";
        }
        EXPECT_GT(of_other.low.back(), of_a.high.back());
        EXPECT_GT(of_other.low.back(), of_b.high.back());
    }
}

/// Measuring neither counts as rendering nor changes the render.
TEST(BenchInstrument, MeasuringCostsNoTimeOnTheCurveAndChangesNothing) {
    constexpr std::uint64_t passes = 12;
    const Scene scene = lattice(lattice_size, lattice_coverage);
    const XyzImage reference = to_reference(exact_lattice());
    const RenderOptions options = lattice_options("tristimulus:2", 7);

    const Stopwatch everything;
    Contestant watched = pass_by_pass(scene, options);
    EXPECT_GT(watched.repeat().build_seconds, 0.0);
    EXPECT_EQ(watched.seconds(), 0.0) << "building counts as rendering";
    double rendering = 0.0;
    for (std::uint64_t pass = 1; pass <= passes; ++pass) {
        const double before = watched.seconds();
        const Stopwatch one_pass;
        watched.render(0.0);
        rendering += one_pass.seconds();
        const double after = watched.seconds();
        EXPECT_GT(after, before);
        const double compared = watched.repeat().compare_seconds;
        watched.measure(reference, lattice_regions());
        EXPECT_EQ(watched.seconds(), after) << "comparing counts as rendering";
        EXPECT_GT(watched.repeat().compare_seconds, compared) << "the time of comparing is not told";
        EXPECT_EQ(watched.repeat().checkpoints.back().seconds, after);
        EXPECT_EQ(watched.repeat().checkpoints.back().passes, pass);
    }
    const Repeat& repeat = watched.repeat();
    // The clocks' parts lie within one another.
    EXPECT_LE(watched.seconds(), rendering);
    EXPECT_LE(repeat.build_seconds + rendering + repeat.compare_seconds, everything.seconds());
    RecordProperty("overhead", fmt::format("comparing took {:.2g} of the rendering time at {} checkpoints",
                                           repeat.compare_seconds / watched.seconds(), repeat.checkpoints.size()));

    Contestant alone = pass_by_pass(scene, options);
    for (std::uint64_t pass = 0; pass < passes; ++pass)
        alone.render(0.0);
    EXPECT_EQ(alone.image().xyz, watched.image().xyz);
}

TEST(BenchInstrument, CheckpointTimesAreEightInADecadeUpToTheEnd) {
    const std::vector<double> times = checkpoint_times(20.0);
    EXPECT_EQ(times.back(), 20.0);
    for (std::size_t i = 1; i < times.size(); ++i)
        EXPECT_NEAR(std::log10(times[i] / times[i - 1]), 1.0 / 8.0, 1e-9);
    EXPECT_LE(times.front(), 0.01);
    EXPECT_GT(times[1], 0.01);
    EXPECT_EQ(checkpoint_times(1e-4), std::vector{1e-4});
}

/// Steps that are shorter than any pass: each turn is one pass, and is measured. The one that has rendered for the
/// shortest time has the turn, so no two that still race are ever further apart than one pass.
TEST(BenchInstrument, RaceGivesEveryoneTheSameTime) {
    constexpr double end = 0.1;
    std::vector<double> times;
    for (int i = 1; i <= 100000; ++i)
        times.push_back(end * i / 100000);
    const Scene scene = lattice(lattice_size, lattice_coverage);
    std::vector<Contestant> contestants;
    for (const char* method : {"tristimulus:1", "spectral:400", "tristimulus:20"})
        contestants.emplace_back(Renderer(scene, lattice_options(method, 1), test_device()), times);

    const auto seconds = [&] {
        std::vector<double> result;
        for (const Contestant& contestant : contestants)
            result.push_back(contestant.seconds());
        return result;
    };
    std::vector<double> before = seconds();
    std::vector<std::size_t> turns(contestants.size());
    double longest_pass = 0.0;
    std::size_t calls = 0;
    run_race(contestants, to_reference(exact_lattice()), lattice_regions(), 1.0, [&](double sum) {
        const std::vector<double> now = seconds();
        EXPECT_NEAR(sum, now[0] + now[1] + now[2], 1e-9);
        double spread = 0.0;
        for (std::size_t i = 0; i < now.size(); ++i) {
            if (now[i] != before[i]) {
                ++turns[i];
                longest_pass = std::max(longest_pass, now[i] - before[i]);
                EXPECT_EQ(before[i], *std::min_element(before.begin(), before.end())) << "not its turn";
                EXPECT_EQ(contestants[i].repeat().checkpoints.size(), turns[i]);
                EXPECT_EQ(contestants[i].repeat().checkpoints.back().passes, turns[i]);
                EXPECT_EQ(contestants[i].repeat().checkpoints.back().seconds, now[i]);
            }
            for (std::size_t j = 0; j < i; ++j)
                spread = std::max(spread, std::abs(now[i] - now[j]));
        }
        EXPECT_LE(spread, longest_pass);
        if (calls++ > 0) {
            EXPECT_EQ(turns[0] + turns[1] + turns[2], calls - 1) << "not one turn between two calls";
        }
        before = now;
        return true;
    });
    for (const Contestant& contestant : contestants) {
        EXPECT_TRUE(contestant.finished());
        EXPECT_GE(contestant.seconds(), end);
        EXPECT_LE(contestant.seconds(), end + longest_pass);
    }
}

/// A turn lasts as long as the slice says, unless a checkpoint comes first.
TEST(BenchInstrument, RaceGoesInSlices) {
    constexpr double slice = 0.004;
    const Scene scene = lattice(lattice_size, lattice_coverage);
    std::vector<Contestant> contestants;
    for (const std::uint32_t seed : {1U, 2U})
        contestants.emplace_back(Renderer(scene, lattice_options("tristimulus:1", seed), test_device()),
                                 std::vector{0.0201, 0.0501});
    std::vector<double> before{0.0, 0.0};
    run_race(contestants, to_reference(exact_lattice()), lattice_regions(), slice, [&](double) {
        for (std::size_t i = 0; i < 2; ++i) {
            const double now = contestants[i].seconds();
            const auto& checkpoints = contestants[i].repeat().checkpoints;
            if (now != before[i] && (checkpoints.empty() || checkpoints.back().seconds != now)) {
                EXPECT_GE(now - before[i], slice * (1.0 - 1e-9));
            }
            before[i] = now;
        }
        return true;
    });
    EXPECT_TRUE(contestants[0].finished() && contestants[1].finished());
}

TEST(BenchInstrument, RaceStopsWhenToldTo) {
    const Scene scene = lattice(lattice_size, lattice_coverage);
    std::vector<Contestant> contestants;
    contestants.emplace_back(Renderer(scene, lattice_options("tristimulus:1", 1), test_device()), std::vector{1e6});
    int turns = 0;
    run_race(contestants, to_reference(exact_lattice()), lattice_regions(), 1e-4, [&](double) { return turns++ < 3; });
    EXPECT_FALSE(contestants[0].finished());
    EXPECT_GT(contestants[0].seconds(), 0.0);
    EXPECT_TRUE(contestants[0].repeat().checkpoints.empty());
}

} // namespace
} // namespace tristim::test
