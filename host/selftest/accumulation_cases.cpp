#include "selftest/photon_measures.h"

#include "opencl/buffer.h"
#include "render/film.h"
#include "render/radius_schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace tristim::selftest {
namespace accumulation {
namespace {

/// One size of work-groups for all: PoCL compiles a kernel for each.
constexpr std::size_t pixels = 16;

/// What kernels/selftest/accumulation.cl adds to a pixel; laid out as its Stream.
struct Stream {
    cl_int lowest, span, negative, photons, vary;
};

std::uint32_t mixed(std::uint32_t x) {
    x ^= x >> 16U;
    x *= 0x7feb352dU;
    x ^= x >> 15U;
    x *= 0x846ca68bU;
    return x ^ x >> 16U;
}

float stream_value(const Stream& stream, std::uint32_t pixel, std::uint32_t pass, std::uint32_t channel) {
    const std::uint32_t bits = mixed(pass * 3U + channel + pixel * 0x9e3779b9U);
    const std::uint32_t exponent = static_cast<std::uint32_t>(127 + stream.lowest) +
                                   (stream.span > 0 ? mixed(bits) % static_cast<std::uint32_t>(stream.span) : 0U);
    const std::uint32_t sign = stream.negative != 0 ? bits & 0x80000000U : 0U;
    return std::bit_cast<float>(sign | exponent << 23U | (stream.span > 0 ? bits >> 9U : 0x4ccccdU));
}

std::uint32_t photons_found(const Stream& stream, std::uint32_t pixel, std::uint32_t pass) {
    const auto most = static_cast<std::uint32_t>(stream.photons);
    return stream.vary != 0 ? mixed(pass ^ pixel * 0x632be5abU) % (most + 1U) : most;
}

/// A film on the device that passes of streams are added to.
class TestedFilm {
  public:
    TestedFilm(const Setting& setting, const ::cl::Program& program, const std::vector<Stream>& streams,
               const std::vector<FilmPixel>& film)
        : device_(setting.device), streams_(device_, "selftest streams", streams),
          film_(device_, "selftest film", film), add_(program, "add_passes") {}

    void add(std::uint32_t first, std::uint32_t last) {
        add_.setArg(0, streams_.cl());
        add_.setArg(3, static_cast<float>(radius_alpha));
        add_.setArg(4, film_.cl());
        // llvmpipe (Mesa 22.3) ends a kernel's loops after 65535 steps.
        constexpr std::uint32_t most = 8192;
        for (; first < last; first += std::min(most, last - first)) {
            add_.setArg(1, first);
            add_.setArg(2, std::min(last, first + most));
            device_.queue.enqueueNDRangeKernel(add_, ::cl::NullRange, ::cl::NDRange(pixels), ::cl::NDRange(pixels));
        }
    }

    std::vector<FilmPixel> read() const { return film_.read(device_); }

  private:
    const Device& device_;
    Buffer<Stream> streams_;
    Buffer<FilmPixel> film_;
    ::cl::Kernel add_;
};

std::vector<FilmPixel> empty_film() {
    FilmPixel pixel{};
    pixel.statistics_radius = 1.0F;
    return std::vector<FilmPixel>(pixels, pixel);
}

/// Calls visit(passes, pixels of the film) after 1, 10, … passes, 10^6 with the usual effort; advance(pixel, pass)
/// before, for the oracle to follow.
template <typename Advance, typename Visit>
void over_passes(const Setting& setting, const ::cl::Program& program, const std::vector<Stream>& streams,
                 Advance&& advance, Visit&& visit) {
    TestedFilm tested(setting, program, streams, empty_film());
    const auto last = static_cast<std::uint32_t>(inputs(setting, 1000000, 100));
    std::uint32_t done = 0;
    for (std::uint32_t next = 1; next <= last; next *= 10) {
        tested.add(done, next);
        for (; done < next; ++done) {
            for (std::uint32_t pixel = 0; pixel < pixels; ++pixel)
                advance(pixel, done);
        }
        visit(done, tested.read());
    }
}

std::string describe(const Stream& s) {
    return fmt::format("{} samples of 2^{}{}", s.negative != 0 ? "signed" : "positive", s.lowest,
                       s.span > 0 ? fmt::format(" to 2^{}", s.lowest + s.span) : " all alike");
}

/// Streams of many magnitudes: alike, near one another, and from 1e-12 to 1e12 in one pixel, of one sign and both.
std::vector<Stream> streams_of_samples() {
    std::vector<Stream> streams;
    for (const int negative : {0, 1}) {
        for (const auto& [lowest, span] : std::vector<std::pair<int, int>>{
                 {-4, 0}, {-40, 0}, {39, 0}, {-2, 4}, {-10, 20}, {-40, 80}, {-50, 10}, {36, 10}})
            streams.push_back({lowest, span, negative, 0, 0});
    }
    return streams;
}

/// Sums of samples^power, against the same in long double. Relative to the sum of absolute values: what signs cancel
/// is no one's.
Measurement sums_of_powers(const Setting& setting, const ::cl::Program& program, int power) {
    struct Sums {
        std::array<long double, 3> sum{}, size{};
    };
    const std::vector<Stream> streams = streams_of_samples();
    std::vector<Sums> exact(pixels);
    Measurement found;
    over_passes(
        setting, program, streams,
        [&](std::uint32_t pixel, std::uint32_t pass) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                const long double v = stream_value(streams[pixel], pixel, pass, c);
                exact[pixel].sum[c] += power == 1 ? v : v * v;
                exact[pixel].size[c] += power == 1 ? std::abs(v) : v * v;
            }
        },
        [&](std::uint32_t passes, const std::vector<FilmPixel>& film) {
            for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
                const std::array<double, 3> sums = power == 1 ? sample_sums(film[pixel]) : square_sums(film[pixel]);
                for (std::size_t c = 0; c < 3; ++c) {
                    const double error = static_cast<double>((sums[c] - exact[pixel].sum[c]) / exact[pixel].size[c]);
                    found.add(passes, std::abs(error),
                              [&] { return fmt::format("{} passes, {}", passes, describe(streams[pixel])); });
                }
            }
        });
    return found;
}

} // namespace

Macros film_macros() {
    return {{"RADIUS_STATISTICS", "1"}};
}

::cl::Program build_film(const Setting& setting) {
    return build({setting.device, false}, "accumulation.cl", film_macros());
}

Measurement sums(const Setting& setting, const ::cl::Program& program) {
    return sums_of_powers(setting, program, 1);
}

Measurement squares(const Setting& setting, const ::cl::Program& program) {
    return sums_of_powers(setting, program, 2);
}

/// The mean and error of pixels of all magnitudes in one image, from a thousand passes of samples within a factor
/// of 16. Developed as an image is.
Measurement magnitudes(const Setting& setting, const ::cl::Program& program) {
    Measurement found;
    const auto passes = static_cast<std::uint32_t>(inputs(setting, 1000, 20));
    for (int lowest = -110; lowest <= 90; lowest += 2 * static_cast<int>(pixels)) {
        std::vector<Stream> streams;
        for (std::size_t i = 0; i < pixels; ++i)
            streams.push_back({std::min(lowest + 2 * static_cast<int>(i), 90), 4, 0, 0, 0});
        TestedFilm tested(setting, program, streams, empty_film());
        tested.add(0, passes);
        const FilmImage image = develop_film(tested.read(), 4, 4, {0, 0, 4, 4});
        for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                long double sum = 0.0L, squares = 0.0L;
                for (std::uint32_t pass = 0; pass < passes; ++pass)
                    sum += stream_value(streams[pixel], pixel, pass, c);
                const long double mean = sum / passes;
                for (std::uint32_t pass = 0; pass < passes; ++pass) {
                    const long double from_mean = stream_value(streams[pixel], pixel, pass, c) - mean;
                    squares += from_mean * from_mean;
                }
                double error = static_cast<double>(std::abs(image.xyz[pixel][c] / mean - 1.0L));
                const long double variance = squares / passes / (passes - 1.0L);
                // Squares are normal floats from 2^-63 to 2^47, between which the variance counts too.
                if (streams[pixel].lowest >= -50 && streams[pixel].lowest <= 40)
                    error = std::max(error, static_cast<double>(std::abs(image.variance[pixel][c] / variance - 1.0L)));
                const double magnitude = std::ldexp(1.0, streams[pixel].lowest);
                found.add(magnitude, error, [&] { return fmt::format("samples of {:.1e}", magnitude); });
            }
        }
    }
    return found;
}

/// A sample that is not finite, or so large that its sum or square would not be: the image keeps the others.
Measurement large_samples(const Setting& setting, const ::cl::Program& program) {
    Measurement found;
    std::vector<Stream> streams(pixels, {0, 0, 0, 0, 0});
    // The last pass's samples are 2^127 and beyond, or too large to square, in the second half of the pixels.
    TestedFilm tested(setting, program, streams, empty_film());
    tested.add(0, 10);
    std::vector<FilmPixel> film = tested.read();
    for (std::size_t i = 0; i < pixels; ++i)
        streams[i].lowest = i < pixels / 2 ? 96 + 3 * static_cast<int>(i) : 48 + 3 * static_cast<int>(i - pixels / 2);
    TestedFilm large(setting, program, streams, film);
    large.add(10, 11);
    film = large.read();
    const FilmImage image = develop_film(film, 4, 4, {0, 0, 4, 4});
    for (std::uint32_t i = 0; i < pixels; ++i) {
        const bool left_out = i < pixels / 2;
        const double sample = stream_value(streams[i], i, 10, 0);
        const double small = stream_value({0, 0, 0, 0, 0}, i, 0, 0);
        const double mean = left_out ? small : (10.0 * small + sample) / 11.0;
        double error = std::abs(image.xyz[i][0] / mean - 1.0);
        const bool marked = std::isinf(image.variance[i][0]);
        if (film[i].rejected != (left_out ? 1U : 0U) || marked == left_out)
            error = std::numeric_limits<double>::infinity();
        found.add(sample, error, [&] { return fmt::format("a sample of {:.1e} after ten of 1.6", sample); });
    }
    return found;
}

/// Passes and rays counted from just below 2^24 and 2^32 on.
Measurement counts(const Setting& setting, const ::cl::Program& program) {
    Measurement found;
    constexpr std::uint32_t passes = 100;
    std::vector<FilmPixel> film = empty_film();
    std::vector<std::uint64_t> before;
    for (std::size_t i = 0; i < pixels; ++i) {
        before.push_back(i % 2 == 0 ? (std::uint64_t{1} << 24U) - 3 * i : (std::uint64_t{1} << 32U) - 10 * i - 100);
        film[i].samples = static_cast<std::uint32_t>(before[i]);
        film[i].camera_rays = film[i].shadow_rays = film[i].samples;
    }
    TestedFilm tested(setting, program, std::vector<Stream>(pixels, {0, 0, 0, 0, 0}), film);
    tested.add(0, passes);
    film = tested.read();
    for (std::size_t i = 0; i < pixels; ++i) {
        const auto check = [&](const char* what, std::uint64_t value, std::uint64_t expected) {
            const double error = std::abs(static_cast<double>(value) - static_cast<double>(expected));
            found.add(static_cast<double>(before[i]), error,
                      [&] { return fmt::format("{} from {} on", what, before[i]); });
        };
        const FilmPixel& p = film[i];
        check("passes", p.samples, before[i] + passes);
        check("camera rays", p.camera_rays | std::uint64_t{p.ray_carries & 0xffffU} << 32U, before[i] + 3 * passes);
        check("shadow rays", p.shadow_rays | std::uint64_t{p.ray_carries >> 16U} << 32U, before[i] + 2 * passes);
    }
    return found;
}

/// --radius statistics: r² = Π (N + αM)/(N + M) over the passes, N = α Σ M of those before (Hachisuka et al. 2008).
Measurement statistics_radius(const Setting& setting, const ::cl::Program& program) {
    std::vector<Stream> streams;
    for (const int vary : {0, 1}) {
        for (const int photons : {1, 2, 5, 17, 100, 1000, 65536, 1 << 24})
            streams.push_back({0, 0, 0, photons, vary});
    }
    const auto alpha = static_cast<long double>(static_cast<float>(radius_alpha));
    std::vector<long double> logarithm(pixels, 0.0L); // of r²
    std::vector<std::uint64_t> photons(pixels, 0);
    Measurement found;
    over_passes(
        setting, program, streams,
        [&](std::uint32_t pixel, std::uint32_t pass) {
            const std::uint32_t m = photons_found(streams[pixel], pixel, pass);
            if (m > 0) {
                const long double n = alpha * static_cast<long double>(photons[pixel]);
                logarithm[pixel] += std::log1p(-(1.0L - alpha) * m / (n + m));
                photons[pixel] += m;
            }
        },
        [&](std::uint32_t passes, const std::vector<FilmPixel>& film) {
            for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
                const long double radius = std::exp(0.5L * logarithm[pixel]);
                const long double count = alpha * static_cast<long double>(photons[pixel]);
                double error = static_cast<double>(std::abs(film[pixel].statistics_radius / radius - 1.0L));
                if (count > 0.0L)
                    error = std::max(error, static_cast<double>(std::abs(film[pixel].statistics_count / count - 1.0L)));
                found.add(passes, error, [&] {
                    return fmt::format("{} passes, {} photons in {}", passes, streams[pixel].photons,
                                       streams[pixel].vary != 0 ? "the best" : "each");
                });
            }
        });
    return found;
}

} // namespace accumulation

std::vector<Case> accumulation_cases() {
    using namespace accumulation;
    const Programs film = built_once(build_film);
    const auto on = [film](Measurement (*measure)(const Setting&, const ::cl::Program&)) {
        return [=](const Setting& setting) { return measure(setting, film(setting)); };
    };
    // Films are built without relaxed math whatever a render asks for, so both bounds are the same. A float's rounding
    // is 6e-8.
    return {
        // Two floats hold 48 bits: with each sample 2^-48 of the sum is lost at most, up or down, √10^6 of that in all.
        {"accumulation", "sums of 1 to 10^6 samples of 1e-15 to 1e15", "passes", "sum, of the sum of sizes", 2e-11,
         2e-11, on(sums)},
        // And each square is rounded.
        {"accumulation", "sums of their squares", "passes", "relative", 7e-8, 7e-8, on(squares)},
        // Mean: its own rounding. Variance: the difference of mean squares that is a seventh of them or more.
        {"accumulation", "an image of 1e-33 to 1e27", "samples", "mean and variance, relative", 2e-7, 2e-7,
         on(magnitudes)},
        {"accumulation", "samples that would overflow", "sample", "mean, relative", 1e-7, 1e-7, on(large_samples)},
        {"accumulation", "counts past 2^24 and 2^32", "count before", "absolute", 0.0, 0.0, on(counts)},
        {"accumulation", "--radius statistics over 1 to 10^6 passes", "passes", "radius and count, relative", 4e-7,
         4e-7, on(statistics_radius)},
    };
}

} // namespace tristim::selftest
