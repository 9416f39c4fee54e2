#include "bench/bench.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "bench/machine.h"
#include "bench/race.h"
#include "bench/reference.h"
#include "image/compare_images.h"
#include "image/error_map.h"
#include "image/output_file.h"
#include "image/write_image.h"

#include <algorithm>
#include <filesystem>

namespace tristim {
namespace {

constexpr double seconds_between_saves = 30.0;
/// The longest that a method renders before the next one has its turn.
constexpr double longest_slice = 0.5; // seconds
constexpr double slices_per_race = 40.0;
constexpr std::uint32_t math_passes = 16;

void make_folder(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error)
        fail("cannot make the folder \"{}\": {}", path, error.message());
}

bool has_checkpoints(const SceneResults& scene) {
    return std::any_of(scene.runs.begin(), scene.runs.end(), [](const Run& run) {
        return std::any_of(run.repeats.begin(), run.repeats.end(),
                           [](const Repeat& repeat) { return !repeat.checkpoints.empty(); });
    });
}

/// Seconds of a pass, over all repeats.
double pass_seconds(const Run& run) {
    double seconds = 0.0;
    double passes = 0.0;
    for (const Repeat& repeat : run.repeats) {
        seconds += repeat.checkpoints.back().seconds;
        passes += static_cast<double>(repeat.checkpoints.back().passes);
    }
    return seconds / passes;
}

class Bench {
  public:
    Bench(BenchPlan& plan, const BenchCallback& callback) : plan_(plan), callback_(callback) {}

    bool run(bool resume) {
        for (const PlannedScene& planned : plan_.scenes)
            check_references(planned);
        prepare_folder(resume);
        for (PlannedScene& planned : plan_.scenes) {
            if (!measure_scene(planned))
                return false;
        }
        save();
        remove_states();
        return true;
    }

  private:
    std::string path(const std::string& name) const { return (std::filesystem::path(plan_.folder) / name).string(); }
    std::string state_path(const PlannedScene& planned, const Run& run, std::size_t repeat) const {
        return path(fmt::format("state/{}-{}-{}.cbor", planned.results.name, run.id, repeat));
    }
    /// As given, or relative to the folder.
    std::string reference_name(const PlannedScene& planned) const {
        return planned.given_reference.empty() ? "reference-" + planned.results.name + ".exr" : planned.given_reference;
    }

    /// Seconds of rendering that a race takes.
    double race_seconds(const PlannedScene& planned) const {
        return plan_.results.seconds * static_cast<double>(planned.results.runs.size());
    }

    bool go_on(double seconds, std::string what) const {
        double total = 0.0;
        for (const PlannedScene& planned : plan_.scenes)
            total += race_seconds(planned) * plan_.results.repeats +
                     (planned.given_reference.empty() ? plan_.reference_seconds : 0.0);
        return callback_({std::min(done_ + seconds, total), total, std::move(what)});
    }

    void check_references(const PlannedScene& planned) const;
    void check_seeds(const std::string& reference, std::uint32_t reference_seed) const;
    void prepare_folder(bool resume);
    void remove_states() const;
    void take_over(const BenchResults& earlier, const std::string& source);
    void save();
    bool measure_scene(PlannedScene& planned);
    Reference obtain_reference(PlannedScene& planned, bool& stopped);
    bool run_repeat(PlannedScene& planned, const XyzImage& reference, std::size_t repeat);
    void write_images(PlannedScene& planned, const std::vector<Contestant>& contestants, const XyzImage& reference);
    void compare_math(PlannedScene& planned);

    BenchPlan& plan_;
    const BenchCallback& callback_;
    double done_ = 0.0; ///< seconds of rendering behind us
    Stopwatch since_save_;
};

/// What can be told of references before anything is rendered.
void Bench::check_references(const PlannedScene& planned) const {
    const std::string& given = planned.given_reference;
    if (given.empty())
        return check_seeds(path(reference_name(planned)), planned.reference_options.seed);
    const Reference reference = read_reference(given);
    check_reference(reference, given, scene_identity(planned.scene, planned.options.front()));
    check_seeds(given, reference.seed);
}

/// Throws Error if a repeat has the seed of one of a reference's halves.
void Bench::check_seeds(const std::string& reference, std::uint32_t seed) const {
    for (const std::uint32_t half : half_seeds(seed)) {
        if (half - plan_.results.seed < static_cast<std::uint32_t>(plan_.results.repeats))
            fail("the reference \"{}\" has the seed {}, which a repeat has too: they would share their noise",
                 reference, half);
    }
}

void Bench::prepare_folder(bool resume) {
    make_folder(plan_.folder);
    const std::string results = path("results.json");
    check_output_file(results);
    const bool exists = std::filesystem::exists(results);
    if (exists && !resume)
        fail("\"{}\" holds a bench: go on with it by --resume, or give another folder", plan_.folder);
    if (exists)
        take_over(read_results(results), results);
    else
        remove_states(); // of a bench whose results are gone
    make_folder(path("images"));
}

/// These files alone, as the folder may hold others.
void Bench::remove_states() const {
    std::error_code ignored;
    for (const PlannedScene& planned : plan_.scenes) {
        for (const Run& run : planned.results.runs) {
            for (std::size_t repeat = 0; repeat < static_cast<std::size_t>(plan_.results.repeats); ++repeat)
                std::filesystem::remove(state_path(planned, run, repeat), ignored);
        }
    }
    std::filesystem::remove(path("state"), ignored); // if it is empty
}

/// Takes over what an earlier run measured. Throws Error unless it had the same plan.
void Bench::take_over(const BenchResults& earlier, const std::string& source) {
    const auto require = [&](bool same, const std::string& what) {
        if (!same)
            fail("cannot go on with \"{}\": it is a bench with other {}", source, what);
    };
    const BenchResults& wanted = plan_.results;
    require(earlier.kind == wanted.kind, "aims (--costs)");
    require(earlier.version == wanted.version, "kernels: version " + earlier.version);
    require(earlier.seconds == wanted.seconds, fmt::format("--time: {}", earlier.seconds));
    require(earlier.repeats == wanted.repeats, fmt::format("--repeats: {}", earlier.repeats));
    require(earlier.seed == wanted.seed, fmt::format("--seed: {}", earlier.seed));
    require(earlier.devices == wanted.devices, "devices or drivers");
    require(earlier.scenes.size() == plan_.scenes.size(), "scenes");
    for (std::size_t s = 0; s < earlier.scenes.size(); ++s) {
        const SceneResults& from = earlier.scenes[s];
        SceneResults& to = plan_.scenes[s].results;
        require(from.name == to.name && from.runs.size() == to.runs.size() && from.groups.size() == to.groups.size(),
                "scenes or methods");
        require(from.width == to.width && from.height == to.height, "--resolution");
        require(from.regions == to.regions, "regions");
        require(from.reference.passes == 0 || from.reference.file == reference_name(plan_.scenes[s]),
                "--reference: " + from.reference.file);
        require(from.reference.passes == 0 || !plan_.scenes[s].given_reference.empty() ||
                    from.reference.method == plan_.scenes[s].reference_options.method.name(),
                "--reference-method: " + from.reference.method);
        for (std::size_t r = 0; r < to.runs.size(); ++r)
            require(from.runs[r].options == to.runs[r].options && from.runs[r].id == to.runs[r].id,
                    "methods or options");
        to.runs = from.runs;
        to.reference = from.reference;
        to.image = from.image;
        to.error_map_scale = from.error_map_scale;
        for (std::size_t g = 0; g < to.groups.size(); ++g)
            to.groups[g].notes = from.groups[g].notes;
    }
    plan_.results.started = earlier.started;
}

void Bench::save() {
    BenchResults results = plan_.results;
    results.peak_process_memory = peak_process_memory();
    for (const PlannedScene& planned : plan_.scenes)
        results.scenes.push_back(planned.results);
    replace_file(path("results.json"), to_json(results).dump(1) + "\n");
    since_save_ = Stopwatch();
}

Reference Bench::obtain_reference(PlannedScene& planned, bool& stopped) {
    const std::string what = planned.results.name + ": reference";
    const auto progress = [&](std::uint64_t, double seconds) {
        stopped = !go_on(seconds, what);
        return !stopped;
    };
    const bool own = planned.given_reference.empty();
    const bool measured = has_checkpoints(planned.results);
    const std::string name = reference_name(planned);
    const std::string file = own ? path(name) : name;
    // What is measured was measured against the file as it is.
    Reference reference = own && !measured
                              ? render_reference(planned.scene, planned.results.file, planned.reference_options,
                                                 plan_.devices.front(), plan_.reference_seconds, file, progress)
                              : read_reference(file);
    if (own && reference.passes < 2)
        fail("the reference \"{}\" has one pass, and needs two to tell its error: {}", file,
             stopped ? "interrupted too early" : "give it more time by --reference-time");
    check_reference(reference, file, scene_identity(planned.scene, planned.options.front()));
    ReferenceSummary summary = summarise_reference(reference, planned.results.regions);
    summary.file = name;
    const ReferenceSummary& before = planned.results.reference;
    if (measured && (summary.passes != before.passes || summary.seed != before.seed))
        fail("cannot go on in \"{}\": what is there was measured against \"{}\" when that had {} passes, not {}",
             plan_.folder, name, before.passes, summary.passes);
    planned.results.reference = std::move(summary);
    return reference;
}

bool Bench::measure_scene(PlannedScene& planned) {
    bool stopped = false;
    const Reference reference = obtain_reference(planned, stopped);
    if (planned.given_reference.empty())
        done_ += plan_.reference_seconds;
    planned.results.image = "images/" + planned.results.name + "-reference.png";
    write_png(path(planned.results.image), reference.image, {});
    save();
    for (std::size_t repeat = 0; !stopped && repeat < static_cast<std::size_t>(plan_.results.repeats); ++repeat) {
        const std::vector<Run>& runs = planned.results.runs;
        const bool measured = std::all_of(runs.begin(), runs.end(), [&](const Run& run) {
            return run.repeats.size() > repeat && run.repeats[repeat].finished;
        });
        stopped = !measured && !run_repeat(planned, reference.image, repeat);
        done_ += race_seconds(planned);
    }
    if (!stopped)
        compare_math(planned);
    return !stopped;
}

bool Bench::run_repeat(PlannedScene& planned, const XyzImage& reference, std::size_t repeat) {
    const BenchResults& bench = plan_.results;
    std::vector<Run>& runs = planned.results.runs;
    const std::string what =
        planned.results.name + (bench.repeats > 1 ? fmt::format(", repeat {} of {}", repeat + 1, bench.repeats) : "");
    std::vector<Contestant> contestants;
    contestants.reserve(runs.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
        if (!go_on(0.0, what + ": building kernels"))
            return false;
        RenderOptions options = planned.options[i];
        options.seed = bench.seed + static_cast<std::uint32_t>(repeat);
        contestants.emplace_back(planned.scene, options, plan_.devices[runs[i].device],
                                 checkpoint_times(bench.seconds));
        runs[i].repeats.resize(std::max(runs[i].repeats.size(), repeat + 1));
        contestants.back().restore(state_path(planned, runs[i], repeat), runs[i].repeats[repeat]);
    }

    const auto keep = [&] {
        for (std::size_t i = 0; i < runs.size(); ++i) {
            runs[i].repeats[repeat] = contestants[i].repeat();
            if (repeat == 0)
                runs[i].memory = contestants[i].memory();
        }
    };
    // After results.json: a checkpoint that is later than the state is measured again, one that is missing is not.
    const auto save_states = [&] {
        make_folder(path("state"));
        for (std::size_t i = 0; i < runs.size(); ++i)
            contestants[i].save(state_path(planned, runs[i], repeat));
    };
    bool stopped = false;
    run_race(contestants, reference, planned.results.regions, std::min(longest_slice, bench.seconds / slices_per_race),
             [&](double seconds) {
                 if (since_save_.seconds() > seconds_between_saves) {
                     keep();
                     save();
                     save_states();
                 }
                 stopped = !go_on(std::min(seconds, race_seconds(planned)), what);
                 return !stopped;
             });
    keep();
    if (repeat == 0)
        write_images(planned, contestants, reference);
    save();
    if (stopped)
        save_states();
    for (std::size_t i = 0; !stopped && i < runs.size(); ++i)
        std::filesystem::remove(state_path(planned, runs[i], repeat));
    return !stopped;
}

/// Each method's image as it stands, in the reference's tones, and its error map.
void Bench::write_images(PlannedScene& planned, const std::vector<Contestant>& contestants, const XyzImage& reference) {
    std::vector<XyzImage> images;
    std::vector<std::vector<float>> errors;
    for (const Contestant& contestant : contestants) {
        images.push_back(contestant.image());
        errors.push_back(pixel_errors(images.back(), reference));
    }
    planned.results.error_map_scale = error_map_scale(errors);
    const ToneCurve curve(reference, {});
    for (std::size_t i = 0; i < images.size(); ++i) {
        Run& run = planned.results.runs[i];
        const std::string name = "images/" + planned.results.name + "-" + run.id;
        run.image = name + ".png";
        run.error_map = name + "-error.png";
        write_png(path(run.image), images[i], curve);
        write_error_map(path(run.error_map), images[i], reference, planned.results.error_map_scale);
    }
}

/// What fast arithmetic changes, free of noise: the same passes of both; and the time it saves.
void Bench::compare_math(PlannedScene& planned) {
    const auto group = std::find_if(planned.results.groups.begin(), planned.results.groups.end(),
                                    [](const RunGroup& g) { return g.name == "math"; });
    if (group == planned.results.groups.end() || !group->notes.empty())
        return;
    const std::size_t precise = group->runs[0];
    const std::size_t fast = group->runs[1];
    std::vector<XyzImage> images;
    for (const std::size_t run : {precise, fast}) {
        RenderOptions options = planned.options[run];
        options.seed = plan_.results.seed;
        Renderer renderer(planned.scene, options, plan_.devices[planned.results.runs[run].device]);
        for (std::uint32_t pass = 0; pass < math_passes; ++pass)
            renderer.render_pass(pass);
        FilmImage film = renderer.film();
        images.push_back({film.full_width, film.full_height, film.region, std::move(film.xyz)});
    }
    group->notes.push_back(
        fmt::format("After the same {} passes the image of fast math differs from that of precise "
                    "math by an RMSE of {:.2g}; a pass of fast math takes {:.2f} times as long.",
                    math_passes, compare_images(images[1], images[0]).rmse,
                    pass_seconds(planned.results.runs[fast]) / pass_seconds(planned.results.runs[precise])));
}

} // namespace

bool run_bench(BenchPlan& plan, bool resume, const BenchCallback& callback) {
    return Bench(plan, callback).run(resume);
}

} // namespace tristim
