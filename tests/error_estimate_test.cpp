// Errors told without a reference: noise from the spread of groups of passes, bias from two radii, and
// what the command makes of them.
#include "child_process.h"
#include "error_groups.h"
#include "image_statistics.h"
#include "render/error_estimate.h"
#include "render/error_trend.h"
#include "scene_folder.h"

#include <OpenImageIO/imageio.h>

#include <cmath>
#include <functional>

namespace tristim::test {
namespace {

constexpr const char* scene_path = TRISTIM_SOURCE_DIR "/meshes/box/scene.pbrt";

/// The sums of passes whose samples are given by pixel and pass.
RenderSums sums_of(const PassRanges& passes, std::size_t pixels,
                   const std::function<double(std::size_t, std::uint32_t)>& sample) {
    RenderSums sums;
    sums.passes = passes;
    sums.film.resize(pixels);
    sums.error.resize(ERROR_PLANES * pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        FilmPixel& pixel = sums.film[i];
        double sum = 0.0, squares = 0.0;
        for (const PassRanges::Range& range : passes.ranges()) {
            for (std::uint32_t pass = range.begin; pass < range.end; ++pass) {
                const double value = sample(i, pass);
                sum += value;
                squares += value * value;
                ++pixel.samples;
                for (int level = 0; level < ERROR_LEVELS; ++level) {
                    const std::size_t plane =
                        3 * (static_cast<std::size_t>(level) * ERROR_GROUPS + group_at(pass, level));
                    for (std::size_t c = 0; c < 3; ++c)
                        sums.error[(plane + c) * pixels + i] += static_cast<float>(value);
                }
            }
        }
        for (std::size_t c = 0; c < 3; ++c) {
            pixel.sum_high[c] = static_cast<float>(sum);
            pixel.sum_middle[c] = static_cast<float>(sum - pixel.sum_high[c]);
            pixel.square_high[c] = static_cast<float>(squares);
            pixel.square_low[c] = static_cast<float>(squares - pixel.square_high[c]);
        }
    }
    return sums;
}

constexpr int side = 30;
constexpr std::size_t pixels = side * side;

/// Numbers in [0, 1) that depend on pixel and pass alone.
double random_number(std::size_t pixel, std::uint32_t pass) {
    // SplitMix64 (Steele, Lea & Flood 2014).
    std::uint64_t z = ((std::uint64_t{pixel} << 32U) + pass + 1) * 0x9e3779b97f4a7c15ULL;
    z = (z ^ z >> 30U) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ z >> 27U) * 0x94d049bb133111ebULL;
    return static_cast<double>((z ^ z >> 31U) >> 11U) * 0x1p-53;
}

/// The bits of the pass mirrored at the binary point, with a random digital shift for each pixel.
double stratified_number(std::size_t pixel, std::uint32_t pass) {
    std::uint32_t mirrored = static_cast<std::uint32_t>(random_number(pixel, 0xffffffffU) * 0x1p32);
    for (std::uint32_t bit = 0; bit < 32; ++bit)
        mirrored ^= (pass >> bit & 1U) << (31U - bit);
    return mirrored * 0x1p-32;
}

/// The RMSE that an estimate states should be within a fifth of the truth (what README promises).
void expect_near(double stated, double truth) {
    EXPECT_GT(stated, truth / 1.2);
    EXPECT_LT(stated, truth * 1.2);
}

TEST(ErrorEstimate, IndependentPassesHaveTheNoiseOfTheirSpread) {
    const auto sample = [](std::size_t i, std::uint32_t pass) { return 0.5 + random_number(i, pass); };
    for (const PassRanges& passes : {PassRanges(0, 10), PassRanges(0, 256), PassRanges(37, 333),
                                     PassRanges::parse("0:61,70:100,128:300,1000:1100")}) {
        SCOPED_TRACE(passes.text());
        const ErrorEstimate estimate = estimate_error(sums_of(passes, pixels, sample), side);
        EXPECT_TRUE(estimate.complete);
        // A uniform number has the variance 1/12; the mean is 1.
        expect_near(estimate.noise, std::sqrt(1.0 / 12.0 / static_cast<double>(passes.count())));
        EXPECT_EQ(estimate.bias, 0.0);
        EXPECT_EQ(estimate.rmse, estimate.noise);
    }
}

TEST(ErrorEstimate, SeesHowFarPassesAreStratified) {
    // Stratified numbers have a variance of n^-2/12 after powers of two and more between these, random ones one of 1/n.
    for (const std::uint32_t count : {24U, 50U, 100U, 160U, 256U, 500U, 1024U}) {
        SCOPED_TRACE(count);
        RenderSums sums = sums_of(PassRanges(0, count), pixels, [](std::size_t i, std::uint32_t pass) {
            return 0.5 + stratified_number(i, pass) + 0.1 * (random_number(i, pass) - 0.5);
        });
        double squares = 0.0;
        for (const FilmPixel& pixel : sums.film)
            squares += std::pow(sample_sums(pixel)[1] / count - 1.0, 2) / pixels;
        const double truth = std::sqrt(squares);
        expect_near(estimate_error(sums, side).noise, truth);
        sums.error.clear();
        const ErrorEstimate plain = estimate_error(sums, side);
        EXPECT_FALSE(plain.complete);
        EXPECT_GT(plain.noise, 2.5 * truth) << "then grouping would not be needed";
        EXPECT_NE(describe(plain).find("noise at most"), std::string::npos);
    }
}

TEST(ErrorEstimate, DoesNotDependOnHowPassesAreSharedOut) {
    const auto sample = [](std::size_t i, std::uint32_t pass) { return 0.5 + random_number(i, pass); };
    const RenderSums whole = sums_of(PassRanges(0, 128), pixels, sample);
    std::vector<std::uint32_t> mine, others;
    for (std::uint32_t pass = 0; pass < 128; ++pass)
        (random_number(7, pass) < 0.3 ? mine : others).push_back(pass);
    RenderSums added = sums_of(PassRanges::of(mine), pixels, sample);
    add(added, sums_of(PassRanges::of(others), pixels, sample));
    const ErrorEstimate a = estimate_error(whole, side), b = estimate_error(added, side);
    // Sums of 32 floats differ by some 2^-23 of themselves, 4e-6 of a group's deviation from the mean.
    EXPECT_NEAR(a.noise, b.noise, 1e-4 * a.noise);
    for (std::size_t i = 0; i < pixels; ++i)
        EXPECT_NEAR(a.pixel_noise[i][0], b.pixel_noise[i][0], 1e-3 * a.pixel_noise[i][0]);

    RenderSums without = sums_of(PassRanges(200, 210), pixels, sample);
    without.error.clear();
    add(added, without);
    EXPECT_FALSE(estimate_error(added, side).complete);
}

TEST(ErrorEstimate, OfABlackImageAndOfOnePassIsANumber) {
    const auto sums = [](std::uint32_t passes, double value) {
        return sums_of(PassRanges(0, passes), pixels, [value](std::size_t, std::uint32_t) { return value; });
    };
    for (const ErrorEstimate& estimate : {estimate_error(sums(1, 0.5), side), estimate_error(sums(64, 0.0), side),
                                          estimate_error(sums(64, 0.5), side)}) {
        EXPECT_FALSE(std::isnan(estimate.rmse));
        for (const auto& pixel : estimate.pixel_noise)
            EXPECT_FALSE(std::isnan(pixel[1]));
    }
    EXPECT_EQ(estimate_error(sums(64, 0.5), side).rmse, 0.0);
}

/// A plane under a point light, by photons alone: irradiance E(p) = h/|p - l|³, whose mean over a disc of radius r is E
/// + r² ∇²E / 8 + O(r⁴), so that two radii show the bias r² ∇²E / 8.
TEST(ErrorEstimate, BiasIsThatOfTheSearchRadius) {
    constexpr int small = 6;
    constexpr double radius = 0.5;
    constexpr std::uint32_t passes = 16;
    constexpr std::uint32_t seeds = 24;
    const Scene scene = plane_under_point_light({0.1, -0.1, 1.5}, 25.0);
    const Light& light = scene.lights.front();
    RenderOptions options = small_render("tristimulus:4", small, small, 8192, radius, 4);
    options.direct_photons = true;
    options.error_estimate = true;

    const double squared_radius = mean_squared_radius(radius, passes);
    const auto radiance_at = [&](const V3d& p) {
        return [&, p](double dx, double dy) { return plane_radiance(light, p + V3d(dx, dy, 0.0)); };
    };
    double expected = 0.0, truth = 0.0;
    for (int i = 0; i < small * small; ++i) {
        expected += pixel_mean(scene.camera, small, small, i % small, i / small, [&](const CameraRay& ray) {
            const auto radiance = radiance_at(at_height(ray, 0.0));
            return 2.0 * (disc_mean(squared_radius, radiance) - disc_mean(0.5 * squared_radius, radiance));
        });
        truth += pixel_mean(scene.camera, small, small, i % small, i / small, [&](const CameraRay& ray) {
            const auto radiance = radiance_at(at_height(ray, 0.0));
            return disc_mean(squared_radius, radiance) - radiance(0.0, 0.0);
        });
    }
    expected /= small * small;
    truth /= small * small;
    EXPECT_NEAR(expected, truth, 0.15 * std::abs(truth)) << "the light is not smooth enough over a search radius";

    std::vector<double> stated;
    Renderer renderer(scene, options, test_device());
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        renderer.reset();
        for (std::uint32_t pass = 0; pass < passes; ++pass)
            renderer.render_pass({pass, seed, pass, seed});
        const std::vector<float> sums = renderer.error_sums();
        constexpr std::size_t count = small * small;
        double mean = 0.0;
        for (std::size_t i = 0; i < count; ++i)
            mean += sums[(ERROR_BIAS_PLANE + 1) * count + i] / static_cast<double>(passes * count);
        stated.push_back(mean);
    }
    const Estimate e = estimate(stated);
    const double error = std::sqrt(e.squared_error);
    RecordProperty("bias", fmt::format("{} +- {}, expected {}", e.mean, error, expected));
    // Student's t, 23 degrees of freedom: 1 chance in 1,000.
    EXPECT_NEAR(e.mean, expected, 3.77 * error);
    EXPECT_LT(3.77 * error, 0.5 * std::abs(expected)) << "too few renders to tell";
}

/// What the two radii differ by, in each pass, about a known bias; the image's mean is 1.
TEST(ErrorEstimate, BiasStandsOutFromItsOwnNoise) {
    constexpr std::uint32_t passes = 64;
    constexpr double spread = 0.1; // the error of the mean is 0.1/√12/√64 = 0.0036
    const auto stated = [](const std::function<double(std::size_t)>& bias) {
        RenderSums sums = sums_of(PassRanges(0, passes), pixels, [](std::size_t, std::uint32_t) { return 1.0; });
        for (std::size_t i = 0; i < pixels; ++i) {
            double sum = 0.0, squares = 0.0;
            for (std::uint32_t pass = 0; pass < passes; ++pass) {
                const double value = bias(i) + spread * (random_number(i, pass) - 0.5);
                sum += value;
                squares += value * value;
            }
            for (std::size_t c = 0; c < 3; ++c) {
                sums.error[(ERROR_BIAS_PLANE + c) * pixels + i] = static_cast<float>(sum);
                sums.error[(ERROR_BIAS_PLANE + 3 + c) * pixels + i] = static_cast<float>(squares);
            }
        }
        return estimate_error(sums, side);
    };
    const auto wave = [](std::size_t i) { return 0.02 * std::sin(static_cast<double>(i % side) / 3.0); };
    double squares = 0.0;
    for (std::size_t i = 0; i < pixels; ++i)
        squares += wave(i) * wave(i) / pixels;
    const ErrorEstimate biased = stated(wave);
    // Spread over 25 tiles, of which a tenth counts as chance: see significant_mean().
    EXPECT_NEAR(biased.bias, std::sqrt(squares), 0.1 * std::sqrt(squares));
    EXPECT_EQ(biased.rmse, biased.bias) << "the passes are all the same";
    for (std::size_t i = 0; i < pixels; ++i)
        EXPECT_NEAR(biased.pixel_bias[i][1], wave(i), 6.0 * 0.0036);
    EXPECT_LT(stated([](std::size_t) { return 0.0; }).bias, 0.5 * 0.0036);
}

TEST(ErrorTrend, FollowsAPowerLaw) {
    ErrorTrend trend;
    const auto error = [](double n) { return 3.0 * std::pow(n, -0.4); };
    trend.add(16, error(16));
    trend.add(20, error(20));
    EXPECT_FALSE(trend.passes_to(0.1));
    trend.add(25, error(25));
    const double n = std::pow(30.0, 2.5);
    ASSERT_TRUE(trend.passes_to(0.1));
    EXPECT_NEAR(*trend.passes_to(0.1), n, 1e-6 * n);
    // What was more than a factor of eight ago is forgotten.
    for (const std::uint64_t passes : {1000U, 1200U, 1500U})
        trend.add(passes, 2.0 * error(static_cast<double>(passes)));
    EXPECT_NEAR(*trend.passes_to(0.1), n * std::pow(2.0, 2.5), 1e-6 * n);
    ErrorTrend rising;
    for (const std::uint64_t passes : {10U, 20U, 30U})
        rising.add(passes, static_cast<double>(passes));
    EXPECT_FALSE(rising.passes_to(0.1));
}

std::unique_ptr<OIIO::ImageInput> open_exr(const std::string& path) {
    std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    EXPECT_TRUE(input) << OIIO::geterror();
    return input;
}

std::vector<float> channel(OIIO::ImageInput& input, const std::string& name) {
    const OIIO::ImageSpec spec = input.spec();
    const int index = spec.channelindex(name);
    EXPECT_GE(index, 0) << name;
    std::vector<float> values(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height));
    EXPECT_TRUE(input.read_image(0, 0, index, index + 1, OIIO::TypeDesc::FLOAT, values.data()));
    return values;
}

TEST(ErrorCommand, WritesChannelsHeaderAndSummary) {
    const SceneFolder folder;
    const auto render = [&](const std::string& name, const std::vector<std::string>& more) {
        std::vector<std::string> words{"render", scene_path,  "--resolution",    "16x12",   "--photons",
                                       "2048",   "--outfile", folder.path(name), "--space", "xyz"};
        words.insert(words.end(), more.begin(), more.end());
        return run_tristim(words);
    };
    const ChildResult with = render("with.exr", {"--passes", "32", "--aov", "error,bias,count"});
    ASSERT_EQ(with.exit_code, 0) << with.standard_error;
    EXPECT_NE(with.standard_error.find("; estimated RMSE "), std::string::npos) << with.standard_error;
    const ChildResult without =
        render("without.exr", {"--passes", "32", "--checkpoint", folder.path("without-sums.exr")});
    EXPECT_NE(without.standard_error.find("; noise at most "), std::string::npos) << without.standard_error;
    const auto a = open_exr(folder.path("with.exr")), b = open_exr(folder.path("without.exr"));
    ASSERT_TRUE(a && b);
    EXPECT_EQ(b->spec().nchannels, 3);
    double noise = 0.0, mean_y = 0.0;
    for (const std::string c : {"X", "Y", "Z"}) {
        EXPECT_EQ(channel(*a, c), channel(*b, c)) << "estimates may not change the image";
        for (const float error : channel(*a, "error." + c))
            noise += double{error} * error / (3.0 * 16 * 12);
        channel(*a, "bias." + c);
    }
    for (const float y : channel(*a, "Y"))
        mean_y += y / (16.0 * 12);
    // Float rounding of the pixels' errors.
    EXPECT_NEAR(a->spec().get_float_attribute("tristim:estimated_noise"), std::sqrt(noise) / mean_y, 1e-4);
    const std::string sums = folder.path("sums.exr");
    EXPECT_EQ(render("half.exr", {"--passes", "16", "--aov", "bias", "--checkpoint", sums}).exit_code, 0);
    EXPECT_EQ(render("resumed.exr", {"--passes", "32", "--aov", "error,bias", "--resume", sums}).exit_code, 0);
    const auto resumed = open_exr(folder.path("resumed.exr"));
    ASSERT_TRUE(resumed);
    for (const std::string name : {"Y", "error.X", "error.Y", "bias.Z"})
        EXPECT_EQ(channel(*a, name), channel(*resumed, name)) << name << ": error sums go on too";
    const ChildResult refused =
        render("no.exr", {"--passes", "40", "--aov", "error", "--resume", folder.path("without-sums.exr")});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_NE(refused.standard_error.find("it was begun without --aov error"), std::string::npos)
        << refused.standard_error;
    EXPECT_EQ(channel(*a, "count"), std::vector<float>(16 * 12, 32.0F));

    // As few passes as there are estimates of, or not many more.
    const double target = 1.5 * a->spec().get_float_attribute("tristim:estimated_rmse");
    const ChildResult until = render("until.exr", {"--passes", "100000", "--error-target", fmt::format("{}", target)});
    ASSERT_EQ(until.exit_code, 0) << until.standard_error;
    EXPECT_NE(until.standard_error.find("under the target "), std::string::npos) << until.standard_error;
    const auto c = open_exr(folder.path("until.exr"));
    ASSERT_TRUE(c);
    EXPECT_GE(c->spec().get_int_attribute("tristim:passes"), 16);
    EXPECT_LT(c->spec().get_int_attribute("tristim:passes"), 100000);
    EXPECT_LT(c->spec().get_float_attribute("tristim:estimated_rmse"), 1.2 * target);
}

TEST(ErrorCommand, RefusesWhatMakesNoSense) {
    const SceneFolder folder;
    const auto expect_refusal = [&](const std::vector<std::string>& more, const std::string& words) {
        std::vector<std::string> all{"render", scene_path};
        all.insert(all.end(), more.begin(), more.end());
        const ChildResult result = run_tristim(all);
        EXPECT_NE(result.exit_code, 0);
        EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
    };
    expect_refusal({"--aov", "error", "--outfile", folder.path("a.png")}, "--aov adds channels to EXR files");
    expect_refusal({"--aov", "depth"}, "not in {error,bias,count}");
    expect_refusal({"--error-target", "0"}, "--error-target must be a positive number");
}

/// The walls of a box under its lamp, by many seeds: what renders state of themselves, against their spread about the
/// mean of all.
TEST(ErrorEstimate, IsTrueOfRenders) {
    if (!long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    const Scene scene = load_scene(scene_path);
    RenderOptions options = options_from_scene(scene.settings);
    options.method = parse_method("tristimulus:1");
    options.width = options.height = 40;
    options.region = {0, 0, 40, 40};
    options.photons_per_pass = 8192;
    options.error_estimate = true;
    constexpr std::uint32_t seeds = 16, passes = 256;
    std::vector<FilmImage> images;
    std::vector<ErrorEstimate> estimates;
    Renderer renderer(scene, options, test_device());
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        renderer.reset();
        for (std::uint32_t pass = 0; pass < passes; ++pass)
            renderer.render_pass({pass, seed, pass, seed});
        RenderSums sums = renderer.sums();
        sums.passes = PassRanges(0, passes);
        images.push_back(developed(sums, options));
        estimates.push_back(estimate_error(sums, options.width));
    }
    double covered = 0.0, count = 0.0;
    for (std::size_t i = 0; i < images[0].xyz.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            double mean = 0.0;
            for (const FilmImage& image : images)
                mean += image.xyz[i][c] / static_cast<double>(seeds);
            for (std::size_t s = 0; s < seeds; ++s) {
                // The mean holds the render itself: what separates them has less variance by 1/seeds.
                const double allowed = 1.96 * estimates[s].pixel_noise[i][c] * std::sqrt(1.0 - 1.0 / seeds);
                covered += std::abs(images[s].xyz[i][c] - mean) <= allowed ? 1.0 : 0.0;
                ++count;
            }
        }
    }
    RecordProperty("coverage", fmt::format("{}", covered / count));
    EXPECT_GT(covered / count, 0.93);
    EXPECT_LT(covered / count, 0.97);
}

} // namespace
} // namespace tristim::test
