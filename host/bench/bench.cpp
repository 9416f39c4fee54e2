#include "bench/bench.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "bench/comparisons.h"
#include "bench/machine.h"
#include "bench/race.h"
#include "bench/reference.h"
#include "bench/resume.h"
#include "image/output_file.h"
#include "image/write_image.h"
#include "render/choose_method.h"

#include <algorithm>
#include <filesystem>
#include <optional>

namespace tristim {
namespace {

constexpr double seconds_between_saves = 30.0;
/// The longest that a method renders before the next one has its turn.
constexpr double longest_slice = 0.5; // seconds
constexpr double slices_per_race = 40.0;

bool has_checkpoints(const SceneResults& scene) {
    return std::any_of(scene.runs.begin(), scene.runs.end(), [](const Run& run) {
        return std::any_of(run.repeats.begin(), run.repeats.end(),
                           [](const Repeat& repeat) { return !repeat.checkpoints.empty(); });
    });
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
    void save();
    bool measure_scene(PlannedScene& planned);
    Reference obtain_reference(PlannedScene& planned, DeviceScenes& scenes, bool& stopped);
    std::optional<double> choose(const std::shared_ptr<const DeviceScene>& scene, const Device& device,
                                 const Repeat& earlier, const std::string& what, RenderOptions& options) const;
    bool run_repeat(PlannedScene& planned, DeviceScenes& scenes, const XyzImage& reference, std::size_t repeat);

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
        take_over(plan_, read_results(results), results);
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

void Bench::save() {
    BenchResults results = plan_.results;
    results.peak_process_memory = std::max(results.peak_process_memory, peak_process_memory());
    for (const PlannedScene& planned : plan_.scenes)
        results.scenes.push_back(planned.results);
    replace_file(path("results.json"), to_json(results).dump(1) + "\n");
    since_save_ = Stopwatch();
}

Reference Bench::obtain_reference(PlannedScene& planned, DeviceScenes& scenes, bool& stopped) {
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
                              ? render_reference(scenes, planned.results.file, planned.reference_options,
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
    DeviceScenes scenes(planned.scene);
    const Reference reference = obtain_reference(planned, scenes, stopped);
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
        stopped = !measured && !run_repeat(planned, scenes, reference.image, repeat);
        done_ += race_seconds(planned);
    }
    note_choices(planned.results);
    if (!stopped)
        compare_math(planned, scenes, plan_.devices, plan_.results.seed);
    return !stopped;
}

/// For the method auto: fills in what an earlier part of the repeat chose, or chooses. Returns the seconds that
/// choosing took, or none if it was stopped.
std::optional<double> Bench::choose(const std::shared_ptr<const DeviceScene>& scene, const Device& device,
                                    const Repeat& earlier, const std::string& what, RenderOptions& options) const {
    if (!options.auto_method)
        return 0.0;
    options.auto_method = false;
    if (!earlier.method.empty()) {
        options.method = parse_method(earlier.method);
        return earlier.trial_seconds;
    }
    bool stopped = false;
    const MethodChoice choice =
        choose_method(scene, options, device, {{}, plan_.results.seconds}, [&](const Method& method) {
            stopped = !go_on(0.0, what + ": trying " + method.name());
            return !stopped;
        });
    if (stopped)
        return std::nullopt;
    options.method = choice.method;
    return choice.seconds;
}

bool Bench::run_repeat(PlannedScene& planned, DeviceScenes& scenes, const XyzImage& reference, std::size_t repeat) {
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
        const Device& device = plan_.devices[runs[i].device];
        const std::shared_ptr<const DeviceScene> scene = scenes.get(options, device);
        runs[i].repeats.resize(std::max(runs[i].repeats.size(), repeat + 1));
        const std::optional<double> trial_seconds = choose(scene, device, runs[i].repeats[repeat], what, options);
        if (!trial_seconds)
            return false;
        contestants.emplace_back(Renderer(scene, options, device), checkpoint_times(bench.seconds), *trial_seconds);
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
    const bool all_began = std::all_of(contestants.begin(), contestants.end(),
                                       [](const Contestant& contestant) { return contestant.seconds() > 0.0; });
    if (repeat == 0 && all_began)
        write_images(planned.results, contestants, reference, plan_.folder);
    save();
    if (stopped)
        save_states();
    for (std::size_t i = 0; !stopped && i < runs.size(); ++i)
        std::filesystem::remove(state_path(planned, runs[i], repeat));
    return !stopped;
}

} // namespace

bool run_bench(BenchPlan& plan, bool resume, const BenchCallback& callback) {
    return Bench(plan, callback).run(resume);
}

} // namespace tristim
