#pragma once

#include "render/renderer.h"

#include "image/write_image.h"
#include "spectra/colour.h"
#include "test_scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace tristim::test {

/// XYZ of every pixel, in rows from the top.
struct TestImage {
    int width = 0;
    int height = 0;
    std::vector<Xyz> xyz;
};

/// Renders of one scene that differ in the seed alone. A render's passes use low-discrepancy sequences, so only whole
/// renders are independent samples of the image.
struct RenderSet {
    std::vector<TestImage> images;
};

inline TestImage render_image(const Scene& scene, const RenderOptions& options, int passes) {
    Renderer renderer(scene, options, test_device());
    for (int pass = 0; pass < passes; ++pass)
        renderer.render_pass(static_cast<std::uint32_t>(pass));
    const FilmImage film = renderer.film();
    EXPECT_EQ(film.rejected_samples, 0U) << "samples that are not finite";
    TestImage image{film.region.width, film.region.height, {}};
    for (const auto& [x, y, z] : film.xyz)
        image.xyz.push_back({x, y, z});
    return image;
}

inline RenderSet render_seeds(const Scene& scene, RenderOptions options, int passes, int runs,
                              std::uint32_t first_seed = 1) {
    RenderSet set;
    for (int run = 0; run < runs; ++run) {
        options.seed = first_seed + static_cast<std::uint32_t>(run);
        set.images.push_back(render_image(scene, options, passes));
    }
    return set;
}

/// Means over blocks of block × block pixels, which must tile the image.
inline TestImage block_means(const TestImage& image, int block) {
    TestImage result{image.width / block, image.height / block, {}};
    result.xyz.resize(static_cast<std::size_t>(result.width * result.height));
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            for (std::size_t c = 0; c < 3; ++c)
                result.xyz[static_cast<std::size_t>(y / block * result.width + x / block)][c] +=
                    image.xyz[static_cast<std::size_t>(y * image.width + x)][c] / (block * block);
        }
    }
    return result;
}

/// I_x(a, b), the regularised incomplete beta function, by its continued fraction (DLMF 8.17.22) evaluated from its
/// tail.
inline double regularised_beta(double x, double a, double b) {
    if (x <= 0.0 || x >= 1.0)
        return x <= 0.0 ? 0.0 : 1.0;
    if (x > (a + 1.0) / (a + b + 2.0))
        return 1.0 - regularised_beta(1.0 - x, b, a);
    double fraction = 1.0;
    for (int n = 400; n >= 1; --n) {
        const double m = n / 2;
        const double d = n % 2 == 0 ? m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
                                    : -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        fraction = 1.0 + d / fraction;
    }
    const double log_factor =
        a * std::log(x) + b * std::log1p(-x) + std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b);
    return std::exp(log_factor) / (a * fraction);
}

/// P(|T| > |t|) of Student's t distribution.
inline double student_p_value(double t, double degrees_of_freedom) {
    return regularised_beta(degrees_of_freedom / (degrees_of_freedom + t * t), 0.5 * degrees_of_freedom, 0.5);
}

/// Sample mean and its squared standard error.
struct Estimate {
    double mean = 0.0;
    double squared_error = 0.0;
};

inline Estimate estimate(const std::vector<double>& samples) {
    const double n = static_cast<double>(samples.size());
    Estimate e;
    for (const double sample : samples)
        e.mean += sample / n;
    for (const double sample : samples)
        e.squared_error += (sample - e.mean) * (sample - e.mean) / (n * (n - 1.0));
    return e;
}

/// How many false alarms a family of tests may have: three in ten thousand.
inline constexpr double family_error = 3e-4;

/// Two samples' means (Welch's t-test), or one sample's and an exact value (b without error). `tolerance` is the
/// difference that rounding explains. Empty `samples_b` counts: 0.
struct Comparison {
    Estimate a, b;
    double t = 0.0;
    double p = 1.0;
};

inline Comparison compare_estimates(const Estimate& a, std::size_t samples_a, const Estimate& b, std::size_t samples_b,
                                    double tolerance) {
    Comparison c{a, b, 0.0, 1.0};
    const double excess = std::abs(a.mean - b.mean) - tolerance;
    if (std::isfinite(excess) && excess <= 0.0)
        return c;
    const double squared = a.squared_error + b.squared_error;
    c.t = excess / std::sqrt(squared);
    if (!(squared > 0.0) || !std::isfinite(c.t)) {
        c.p = 0.0;
        return c;
    }
    // Welch & Satterthwaite's degrees of freedom.
    double denominator = a.squared_error * a.squared_error / static_cast<double>(samples_a - 1);
    if (samples_b > 1)
        denominator += b.squared_error * b.squared_error / static_cast<double>(samples_b - 1);
    c.p = student_p_value(c.t, squared * squared / denominator);
    return c;
}

inline std::vector<double> samples_of(const RenderSet& set, std::size_t pixel, std::size_t channel) {
    std::vector<double> samples;
    for (const TestImage& image : set.images)
        samples.push_back(image.xyz[pixel][channel]);
    return samples;
}

/// The mean over all pixels in each image of a set.
inline std::vector<double> mean_samples(const RenderSet& set, std::size_t channel) {
    std::vector<double> samples;
    for (const TestImage& image : set.images) {
        double sum = 0.0;
        for (const Xyz& xyz : image.xyz)
            sum += xyz[channel];
        samples.push_back(sum / static_cast<double>(image.xyz.size()));
    }
    return samples;
}

inline TestImage mean_image(const RenderSet& set) {
    TestImage mean{set.images.front().width, set.images.front().height, {}};
    mean.xyz.resize(set.images.front().xyz.size());
    for (const TestImage& image : set.images) {
        for (std::size_t i = 0; i < mean.xyz.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                mean.xyz[i][c] += image.xyz[i][c] / static_cast<double>(set.images.size());
        }
    }
    return mean;
}

inline RenderSet block_means(const RenderSet& set, int block) {
    RenderSet result;
    for (const TestImage& image : set.images)
        result.images.push_back(block_means(image, block));
    return result;
}

/// Writes image, reference and their difference as EXR files in XYZ and returns a sentence that says where.
inline std::string write_failure(const std::string& name, const TestImage& image, const TestImage& reference) {
    TestImage error = image;
    for (std::size_t i = 0; i < error.xyz.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            error.xyz[i][c] -= reference.xyz[i][c];
    }
    std::string stem = name;
    std::replace_if(
        stem.begin(), stem.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '-');
    stem = failure_folder() + "/" + stem;
    const auto write = [&stem](const char* suffix, const TestImage& what) {
        XyzImage out{what.width, what.height, {0, 0, what.width, what.height}, {}};
        for (const Xyz& v : what.xyz)
            out.xyz.push_back({static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])});
        write_exr(stem + suffix, out, ColourSpace::CieXyz, {});
    };
    write("-image.exr", image);
    write("-reference.exr", reference);
    write("-error.exr", error);
    return "see " + stem + "-{image,reference,error}.exr";
}

/// The pixel and channel with the smallest p-value, and the whole image's mean, of a comparison.
class ImageTest {
  public:
    ImageTest(std::string name, int width) : name_(std::move(name)), width_(width) {}

    void add_pixel(std::size_t pixel, std::size_t channel, const Comparison& c) {
        ++pixel_tests_;
        if (c.p < worst_.p) {
            worst_ = c;
            worst_pixel_ = pixel;
            worst_channel_ = channel;
        }
    }

    void add_mean(std::size_t channel, const Comparison& c) { means_[channel] = c; }

    /// Fails the test if pixels or means differ more than chance allows (Šidák-corrected); shows the images then.
    void judge(const TestImage& image, const TestImage& reference) const {
        const double pixel_level = 1.0 - std::pow(1.0 - family_error, 1.0 / static_cast<double>(pixel_tests_));
        bool failed = false;
        if (!(worst_.p >= pixel_level)) {
            failed = true;
            ADD_FAILURE() << name_ << ": pixel (" << worst_pixel_ % static_cast<std::size_t>(width_) << ", "
                          << worst_pixel_ / static_cast<std::size_t>(width_) << ") "
                          << "XYZ"[worst_channel_] << " " << describe(worst_) << ", Šidák level " << pixel_level
                          << " for " << pixel_tests_ << " tests";
        }
        const double mean_level = 1.0 - std::pow(1.0 - family_error, 1.0 / 3.0);
        for (std::size_t c = 0; c < 3; ++c) {
            if (means_[c].p >= mean_level)
                continue;
            failed = true;
            ADD_FAILURE() << name_ << ": image mean of "
                          << "XYZ"[c] << " " << describe(means_[c]) << ", Šidák level " << mean_level;
        }
        if (failed)
            ADD_FAILURE() << name_ << ": " << write_failure(name_, image, reference);
    }

  private:
    static std::string describe(const Comparison& c) {
        return fmt::format("{:.6g} ± {:.2g}, expected {:.6g} ± {:.2g}: t = {:.2f}, p = {:.2g}", c.a.mean,
                           std::sqrt(c.a.squared_error), c.b.mean, std::sqrt(c.b.squared_error), c.t, c.p);
    }

    std::string name_;
    int width_;
    std::size_t pixel_tests_ = 0;
    Comparison worst_;
    std::size_t worst_pixel_ = 0;
    std::size_t worst_channel_ = 0;
    std::array<Comparison, 3> means_;
};

/// What a comparison with an exact image grants and demands.
struct Demands {
    double rounding = 2e-5;   ///< relative error of float arithmetic in a path of some dozens of operations (eps 6e-8)
    double resolution = 0.01; ///< the image mean's standard error must be below this fraction of it: errors of some
                              ///< multiples of it are sure to be seen
};

/// Compares a set of renders to the exact image.
inline void expect_exact(const std::string& name, const RenderSet& set, const TestImage& exact,
                         const Demands& demands = {}) {
    const std::size_t runs = set.images.size();
    const TestImage mean = mean_image(set);
    ASSERT_EQ(mean.xyz.size(), exact.xyz.size());
    ImageTest test(name, mean.width);
    for (std::size_t c = 0; c < 3; ++c) {
        double exact_mean = 0.0;
        for (std::size_t i = 0; i < exact.xyz.size(); ++i) {
            const double value = exact.xyz[i][c];
            exact_mean += value / static_cast<double>(exact.xyz.size());
            test.add_pixel(
                i, c,
                compare_estimates(estimate(samples_of(set, i, c)), runs, {value, 0.0}, 0, demands.rounding * value));
        }
        const Estimate whole = estimate(mean_samples(set, c));
        test.add_mean(c, compare_estimates(whole, runs, {exact_mean, 0.0}, 0, demands.rounding * exact_mean));
        EXPECT_LT(std::sqrt(whole.squared_error), demands.resolution * exact_mean)
            << name << ": too noisy to show errors of "
            << "XYZ"[c];
    }
    test.judge(mean, exact);
}

/// Compares two sets of renders, which must have the same expectation.
inline void expect_same(const std::string& name, const RenderSet& a, const RenderSet& b, const Demands& demands = {}) {
    const TestImage mean_a = mean_image(a);
    const TestImage mean_b = mean_image(b);
    ASSERT_EQ(mean_a.xyz.size(), mean_b.xyz.size());
    ImageTest test(name, mean_a.width);
    const auto compare = [&](const std::vector<double>& samples_a, const std::vector<double>& samples_b) {
        const Estimate of_a = estimate(samples_a);
        const Estimate of_b = estimate(samples_b);
        return compare_estimates(of_a, samples_a.size(), of_b, samples_b.size(),
                                 demands.rounding * std::abs(of_b.mean));
    };
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < mean_a.xyz.size(); ++i)
            test.add_pixel(i, c, compare(samples_of(a, i, c), samples_of(b, i, c)));
        const Comparison whole = compare(mean_samples(a, c), mean_samples(b, c));
        test.add_mean(c, whole);
        EXPECT_LT(std::sqrt(whole.a.squared_error + whole.b.squared_error), demands.resolution * whole.b.mean)
            << name << ": too noisy to show differences of "
            << "XYZ"[c];
    }
    test.judge(mean_a, mean_b);
}

/// XYZ of a spectrum given by its values at the middles of the 400 bins times bin means of an emission:
/// (1/k) Σ f_bin · emission_bin · value(λ_bin), the paper's equations 2 to 4 (1 nm steps: relative error below 1e-5
/// where value is smooth).
template <typename Function>
Xyz integrate_xyz(const Spectrum& emission, Function&& value) {
    const auto bins = emission.bins();
    Xyz xyz{};
    for (std::size_t i = 0; i < bins.size(); ++i) {
        const double v = bins[i] * value(lambda_min_nm + static_cast<double>(i) + 0.5) / cie_y_integral();
        for (std::size_t c = 0; c < 3; ++c)
            xyz[c] += cie_bins()[c][i] * v;
    }
    return xyz;
}

} // namespace tristim::test
