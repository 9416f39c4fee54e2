#include "bench/contestant.h"

#include "base/error.h"
#include "base/read_file.h"
#include "base/stopwatch.h"
#include "image/compare_images.h"
#include "image/output_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numeric>

namespace tristim {
namespace {

constexpr int checkpoints_per_decade = 8;
constexpr double first_checkpoint = 0.01; // seconds; a pass rarely takes less

std::uint64_t device_memory(const RenderStatistics& statistics) {
    return std::accumulate(statistics.buffer_bytes.begin(), statistics.buffer_bytes.end(), std::uint64_t{0},
                           [](std::uint64_t sum, const auto& buffer) { return sum + buffer.second; });
}

} // namespace

std::vector<double> checkpoint_times(double seconds) {
    std::vector<double> times;
    for (int k = 0; k == 0 || times.back() > first_checkpoint; ++k)
        times.push_back(seconds * std::pow(10.0, -static_cast<double>(k) / checkpoints_per_decade));
    std::reverse(times.begin(), times.end());
    return times;
}

Contestant::Contestant(Renderer renderer, std::vector<double> times, double trial_seconds)
    : renderer_(std::move(renderer)), times_(std::move(times)) {
    repeat_.seed = renderer_.options().seed;
    repeat_.method = renderer_.options().method.name();
    repeat_.trial_seconds = trial_seconds;
    repeat_.build_seconds = renderer_.statistics().build_kernels_seconds + renderer_.statistics().pilot_seconds;
}

void Contestant::render(double slice) {
    const double end = std::min(seconds() + slice, next_time());
    do {
        renderer_.render_pass(static_cast<std::uint32_t>(renderer_.statistics().passes));
    } while (seconds() < end);
}

void Contestant::measure(const XyzImage& reference, const std::vector<NamedRegion>& regions) {
    const Stopwatch comparing;
    const RenderStatistics& statistics = renderer_.statistics();
    const std::uint64_t before = repeat_.checkpoints.empty() ? 0 : repeat_.checkpoints.back().memory;
    CurvePoint checkpoint{
        seconds(), statistics.passes, statistics.photons_emitted, std::max(before, device_memory(statistics)), {}, {}};
    const XyzImage now = image();
    for (const NamedRegion& region : regions) {
        const ImageDifference difference = compare_images(now, reference, region.region);
        checkpoint.rmse.push_back(difference.rmse);
        checkpoint.rel_mse.push_back(difference.rel_mse);
    }
    repeat_.checkpoints.push_back(std::move(checkpoint));
    skip_passed_times();
    repeat_.compare_seconds += comparing.seconds();
}

void Contestant::skip_passed_times() {
    while (next_ < times_.size() && times_[next_] <= seconds())
        ++next_;
    repeat_.finished = next_ == times_.size();
}

MemoryUse Contestant::memory() const {
    const RenderStatistics& statistics = renderer_.statistics();
    return {statistics.photon_bytes, statistics.pixel_bytes,
            device_memory(statistics) - statistics.photon_bytes - statistics.pixel_bytes, statistics.bytes_per_photon,
            statistics.bytes_per_pixel};
}

void Contestant::save(const std::string& path) const {
    const std::vector<FilmPixel> pixels = renderer_.film_pixels();
    std::vector<std::uint8_t> bytes(pixels.size() * sizeof(FilmPixel));
    std::memcpy(bytes.data(), pixels.data(), bytes.size());
    const nlohmann::json state{{"seed", repeat_.seed},
                               {"passes", renderer_.statistics().passes},
                               {"method", repeat_.method},
                               {"seconds", renderer_.statistics().render_seconds},
                               {"build_seconds", repeat_.build_seconds},
                               {"film", nlohmann::json::binary(std::move(bytes))}};
    replace_file(path, nlohmann::json::to_cbor(state));
}

void Contestant::restore(const std::string& path, const Repeat& measured) {
    if (!std::filesystem::exists(path))
        return;
    const nlohmann::json state = nlohmann::json::from_cbor(read_whole_file(path), true, false);
    const auto member = [&state](const char* name) {
        return state.is_object() ? state.value(name, nlohmann::json()) : nlohmann::json();
    };
    std::vector<FilmPixel> pixels(static_cast<std::size_t>(renderer_.options().region.pixels()));
    if (member("seed") != repeat_.seed || member("method") != repeat_.method ||
        !member("passes").is_number_unsigned() || !member("seconds").is_number() ||
        !member("build_seconds").is_number() || !member("film").is_binary() ||
        state["film"].get_binary().size() != pixels.size() * sizeof(FilmPixel))
        fail("cannot go on from \"{}\": it is damaged or of another image", path);
    std::memcpy(pixels.data(), state["film"].get_binary().data(), pixels.size() * sizeof(FilmPixel));
    renderer_.restore(pixels, state["passes"].get<std::uint64_t>(), state["seconds"].get<double>());
    repeat_.build_seconds += state["build_seconds"].get<double>();
    repeat_.compare_seconds = measured.compare_seconds;
    for (const CurvePoint& checkpoint : measured.checkpoints) {
        if (checkpoint.passes <= renderer_.statistics().passes)
            repeat_.checkpoints.push_back(checkpoint);
    }
    // A state is saved after the last measurement, so times that it has passed are measured.
    skip_passed_times();
}

} // namespace tristim
