#include "base/error.h"
#include "base/stopwatch.h"
#include "bench/reference_file.h"
#include "bench/reference_snapshots.h"
#include "image/output_file.h"
#include "render/image_metadata.h"
#include "render/pilot.h"
#include "render/renderer.h"

#include <algorithm>
#include <bit>
#include <filesystem>

namespace tristim {
namespace {

/// Throws Error unless passes rendered with these options are more of those that the reference has.
void check_same_settings(const Reference& reference, const std::string& path, const Reference& wanted) {
    const auto check = [&path](const std::string& name, const std::string& is, const std::string& should) {
        if (is != should)
            fail("cannot continue \"{}\": its {} is {}, not {}", path, name, is, should);
    };
    if (const std::string difference = describe_difference(reference, wanted.identity); !difference.empty())
        fail("cannot continue \"{}\": {}", path, difference);
    check("method", reference.method, wanted.method);
    check("seed", std::to_string(reference.seed), std::to_string(wanted.seed));
    for (std::size_t i = 0; i < wanted.settings.size(); ++i) {
        std::string name = wanted.settings[i].first;
        std::replace(name.begin(), name.end(), '_', ' ');
        check(name, reference.settings[i].second, wanted.settings[i].second);
    }
}

/// Where a half that has as many passes as the other stops next: at the powers of two, where snapshots are taken, and
/// soon enough that an interruption leaves the halves much alike. Changing turns costs reading a film back.
std::uint64_t next_stop(std::uint64_t passes) {
    constexpr std::uint64_t longest_turn = 32;
    return std::min(std::bit_ceil(passes + 1), passes + std::clamp<std::uint64_t>(passes / 8, 1, longest_turn));
}

/// A render in progress that continues a reference.
class Continuation {
  public:
    Continuation(Renderer renderer, Reference reference)
        : renderer_(std::move(renderer)), reference_(std::move(reference)), base_seconds_(reference_.seconds),
          base_(film(reference_.image.xyz, reference_.passes)) {
        base_.rejected_samples = reference_.rejected_samples;
        if (reference_.passes > 0)
            base_.variance = reference_.variance;
        const std::vector<FilmPixel> empty = renderer_.film_pixels();
        HalfFilms snapshots;
        for (std::size_t h = 0; h < 2; ++h) {
            const ReferenceHalf& half = reference_.halves[h];
            base_halves_[h] = film(half.xyz, half.passes);
            snapshots[h] = film(half.snapshot, reference_.snapshot_passes);
            passes_[h] = half.passes;
            pixels_[h] = empty;
        }
        if (reference_.snapshot_passes > 0)
            snapshots_.add(std::move(snapshots));
        if (passes_[0] == passes_[1] && passes_[0] > reference_.snapshot_passes)
            snapshots_.add(base_halves_);
        take_turn(passes_[0] <= passes_[1] ? 0 : 1);
    }

    std::uint64_t passes() const { return passes_[0] + passes_[1]; }
    double seconds() const { return base_seconds_ + renderer_.statistics().render_seconds; }

    void render_pass() {
        if (passes_[turn_] == stop_)
            change_turns();
        const std::uint64_t pass = passes_[turn_]++;
        // The radius shrinks with the passes of both halves, as it would in one render.
        const std::uint32_t seed = half_seeds(reference_.seed)[turn_];
        renderer_.render_pass({.pass = static_cast<std::uint32_t>(pass),
                               .seed = seed,
                               .radius_pass = static_cast<std::uint32_t>(2 * pass + turn_),
                               .wavelength_seed = seed});
    }

    const Reference& write(const std::string& path) {
        pixels_[turn_] = renderer_.film_pixels();
        const HalfFilms halves = films();
        for (std::size_t h = 0; h < 2; ++h) {
            reference_.halves[h].passes = halves[h].passes;
            reference_.halves[h].xyz = halves[h].xyz;
        }
        FilmImage image = merge(base_, merge(developed(0), developed(1)));
        const NonFiniteCounts counts = renderer_.non_finite();
        image.rejected_samples += counts.total() - counts.film; // the halves have those of the film
        reference_.image = {image.full_width, image.full_height, image.region, image.xyz};
        reference_.variance = image.variance;
        reference_.passes = image.passes;
        reference_.photons = image.passes * static_cast<std::uint64_t>(renderer_.options().photons_per_pass);
        reference_.seconds = seconds();
        reference_.rejected_samples = image.rejected_samples;
        if (const HalfFilms* snapshot = snapshots_.best(std::min(passes_[0], passes_[1]))) {
            reference_.snapshot_passes = (*snapshot)[0].passes;
            for (std::size_t h = 0; h < 2; ++h)
                reference_.halves[h].snapshot = (*snapshot)[h].xyz;
        }
        write_reference(path, reference_, image_metadata(renderer_, reference_.scene, image.rejected_samples));
        return reference_;
    }

  private:
    FilmImage film(const std::vector<std::array<float, 3>>& xyz, std::uint64_t passes) const {
        const RenderOptions& options = renderer_.options();
        return {options.width, options.height, options.region, xyz, std::vector<std::array<float, 3>>(xyz.size()), 0,
                passes};
    }

    FilmImage developed(std::size_t half) const {
        const RenderOptions& options = renderer_.options();
        return develop_film(pixels_[half], options.width, options.height, options.region);
    }

    HalfFilms films() const { return {merge(base_halves_[0], developed(0)), merge(base_halves_[1], developed(1))}; }

    void take_turn(std::size_t half) {
        turn_ = half;
        const std::uint64_t other = passes_[1 - half];
        stop_ = passes_[half] < other ? other : next_stop(passes_[half]);
    }

    void change_turns() {
        pixels_[turn_] = renderer_.film_pixels();
        if (passes_[0] == passes_[1] && std::has_single_bit(passes_[0]))
            snapshots_.add(films());
        take_turn(passes_[0] <= passes_[1] ? 0 : 1);
        const RenderStatistics& statistics = renderer_.statistics();
        renderer_.restore(pixels_[turn_], statistics.passes, statistics.render_seconds);
    }

    Renderer renderer_;
    Reference reference_;
    double base_seconds_;
    FilmImage base_;                               ///< of the run before
    HalfFilms base_halves_;                        ///< and its halves, without their variances
    std::array<std::vector<FilmPixel>, 2> pixels_; ///< of the halves in this run; the one whose turn it is lies in the
                                                   ///< renderer
    std::array<std::uint64_t, 2> passes_{};        ///< of the halves, in all runs
    std::size_t turn_ = 0;
    std::uint64_t stop_ = 0; ///< passes of the half at which its turn ends
    ReferenceSnapshots snapshots_;
};

} // namespace

Reference render_reference(DeviceScenes& scenes, const std::string& scene_file, const RenderOptions& options,
                           const Device& device, double seconds, const std::string& path,
                           const ReferenceProgress& progress, double seconds_between_writes) {
    check_options(options);
    if (options.statistics_radius)
        fail("a reference needs --radius global: with the statistics radius no pass can be rendered without those "
             "before, so the reference could not be continued");
    check_output_file(path);
    Reference reference;
    reference.scene = scene_file;
    reference.method = options.method.name();
    reference.seed = options.seed;
    reference.settings = reference_settings(options);
    reference.identity = scene_identity(scenes.scene(), options);
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored)) {
        Reference existing = read_reference(path);
        check_same_settings(existing, path, reference);
        if (existing.seconds >= seconds)
            return existing;
        reference = std::move(existing);
        reference.scene = scene_file;
    }

    Continuation continuation(Renderer(scenes.get(options, device), options, device), std::move(reference));
    Stopwatch since_write;
    while (continuation.seconds() < seconds && continuation.passes() + 1 < pilot_pass &&
           progress(continuation.passes(), continuation.seconds())) {
        continuation.render_pass();
        if (since_write.seconds() >= seconds_between_writes) {
            continuation.write(path);
            since_write = Stopwatch();
        }
    }
    if (continuation.passes() == 0)
        fail("interrupted before the first pass was done: no reference written");
    return continuation.write(path);
}

Reference render_reference(const Scene& scene, const std::string& scene_file, const RenderOptions& options,
                           const Device& device, double seconds, const std::string& path,
                           const ReferenceProgress& progress, double seconds_between_writes) {
    DeviceScenes scenes(scene);
    return render_reference(scenes, scene_file, options, device, seconds, path, progress, seconds_between_writes);
}

} // namespace tristim
