#include "commands/bench_film.h"

#include "base/median.h"
#include "base/stopwatch.h"
#include "commands/device_options.h"
#include "opencl/buffer.h"
#include "opencl/program.h"
#include "shared_types.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <memory>

namespace tristim {
namespace {

struct BenchFilmOptions {
    bool json = false;
    std::string device;
    int repeats = 15;
    int items = 65536;
};

struct Stack {
    const char* name;
    int layers; ///< the index of the first is 1.38 + ik, those below it alternate 2.35 and 1.46
    double layer_k;
    double base_n, base_k;
};

constexpr std::array<Stack, 4> stacks{
    Stack{"1 layer on glass", 1, 0.0, 1.5, 0.0}, Stack{"1 layer on aluminium", 1, 0.0, 0.9, 6.4},
    Stack{"1 absorbing layer on aluminium", 1, 0.1, 0.9, 6.4}, Stack{"20 layers on glass", 20, 0.0, 1.5, 0.0}};
constexpr std::array<int, 3> lane_counts{4, 8, 16};

/// Evaluations of each work-item: enough that starting it counts little.
constexpr int evaluations = 64;

/// Angle, thickness and side change from one evaluation to the next, so that nothing can be computed once for all.
constexpr const char* source = R"(
#include "rng.h"
#include "thin_film.h"
kernel void films(const global float* pass_table, const global SceneFilmLayer* layers, int count, uint seed, global float* out) {
    const uint i = (uint)get_global_id(0);
    floatv sum = 0.0f;
    for (uint e = 0; e < EVALUATIONS; ++e) {
        const uint4 bits = pcg4d((uint4)(i, e, 0u, seed));
        const ThinFilm film = {layers, count, 100.0f + 400.0f * unit_float(bits.x)};
        const FilmOptics optics =
            film_optics(pass_table, 0, &film, true, (floatv)(unit_float(bits.y)), (floatv)(1.0f),
                        vloadv(0, spectrum_row(pass_table, 0)), vloadv(0, spectrum_row(pass_table, 1)));
        sum += 0.5f * (optics.reflected_s + optics.reflected_p);
    }
    out[i] = lanes_sum(sum) / (float)(EVALUATIONS * LANES);
}
)";

/// One stack and width of vectors, ready to run.
class Contestant {
  public:
    Contestant(const Device& device, const Stack& stack, int lanes, int items)
        : device_(device), stack_(stack), lanes_(lanes), items_(items) {
        const ::cl::Program program = build_program_from_text(device, "bench_film.cl", source,
                                                              {{"LANES", std::to_string(lanes)},
                                                               {"HAS_ABSORBING_FILM", stack.layer_k > 0.0 ? "1" : "0"},
                                                               {"EVALUATIONS", std::to_string(evaluations)}},
                                                              {});
        kernel_ = ::cl::Kernel(program, "films");
        std::vector<float> table;
        const auto add_row = [&](double value, double step) {
            for (int lane = 0; lane < lanes; ++lane)
                table.push_back(static_cast<float>(value + step * lane));
        };
        add_row(400.0, 360.0 / lanes); // wavelengths
        for (int weights = 0; weights < 3; ++weights)
            add_row(0.0, 0.0);
        add_row(stack.base_n, 0.001);
        add_row(stack.base_k, stack.base_k * 0.001);
        std::vector<SceneFilmLayer> layers;
        for (int layer = 0; layer < stack.layers; ++layer) {
            const double n = layer == 0 ? 1.38 : layer % 2 == 1 ? 2.35 : 1.46;
            add_row(n, 0.001);
            add_row(layer == 0 ? stack.layer_k : 0.0, 0.0);
            layers.push_back({static_cast<float>(550.0 / 4.0 / n), 2 + 2 * layer, 3 + 2 * layer, 0});
        }
        table_ = Buffer<float>(device, "pass table", table);
        layers_ = Buffer<SceneFilmLayer>(device, "film layers", layers);
        output_ = Buffer<float>(device, "reflectances", static_cast<std::size_t>(items));
    }

    /// Nanoseconds for one reflectance, of one wavelength and unpolarised light.
    double run(std::uint32_t seed) {
        kernel_.setArg(0, table_.cl());
        kernel_.setArg(1, layers_.cl());
        kernel_.setArg(2, stack_.layers);
        kernel_.setArg(3, seed);
        kernel_.setArg(4, output_.cl());
        const Stopwatch watch;
        device_.queue.enqueueNDRangeKernel(kernel_, ::cl::NullRange, ::cl::NDRange(static_cast<std::size_t>(items_)));
        device_.queue.finish();
        return 1e9 * watch.seconds() / (static_cast<double>(items_) * evaluations * lanes_);
    }

    const Stack& stack() const { return stack_; }
    int lanes() const { return lanes_; }

  private:
    const Device& device_;
    Stack stack_;
    int lanes_, items_;
    ::cl::Kernel kernel_;
    Buffer<float> table_, output_;
    Buffer<SceneFilmLayer> layers_;
};

struct Result {
    std::string stack;
    int lanes = 0;
    double nanoseconds = 0.0;
};

/// Medians over runs of all contestants in turn, after one to warm up.
std::vector<Result> measure(std::vector<Contestant>& contestants, int repeats) {
    std::vector<std::vector<double>> times(contestants.size());
    for (int repeat = -1; repeat < repeats; ++repeat)
        for (std::size_t i = 0; i < contestants.size(); ++i) {
            const double time = contestants[i].run(static_cast<std::uint32_t>(repeat + 1));
            if (repeat >= 0)
                times[i].push_back(time);
        }
    std::vector<Result> results;
    for (std::size_t i = 0; i < contestants.size(); ++i)
        results.push_back({contestants[i].stack().name, contestants[i].lanes(), median(times[i])});
    return results;
}

void bench_film(const BenchFilmOptions& options) {
    const Device device = open_device(options.device);
    std::vector<Contestant> contestants;
    for (const Stack& stack : stacks)
        for (const int lanes : lane_counts)
            contestants.emplace_back(device, stack, lanes, options.items);
    const std::vector<Result> results = measure(contestants, options.repeats);
    if (options.json) {
        nlohmann::ordered_json list = nlohmann::ordered_json::array();
        for (const Result& r : results)
            list.push_back({{"stack", r.stack}, {"lanes", r.lanes}, {"ns_per_reflectance", r.nanoseconds}});
        fmt::print("{}\n", list.dump(2));
        return;
    }
    fmt::print("ns for one reflectance (one wavelength, unpolarised) on '{}', {} threads; medians of {}\n\n",
               device.info.name, device.info.compute_units, options.repeats);
    fmt::print("{:<32}{:>8}{:>10}\n", "film", "lanes", "ns");
    for (const Result& r : results)
        fmt::print("{:<32}{:>8}{:>10.2f}\n", r.stack, r.lanes, r.nanoseconds);
}

} // namespace

void add_bench_film_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("bench-film", "Time of one thin-film reflectance");
    const auto options = std::make_shared<BenchFilmOptions>();
    command->add_flag("--json", options->json, "print a JSON list instead of a table");
    add_device_option(*command, options->device);
    command->add_option("--repeats", options->repeats, "timed runs of each film")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_option("--items", options->items, "work-items, of 64 evaluations each")
        ->check(CLI::Range(1, 1 << 24))
        ->capture_default_str();
    command->callback([options] { bench_film(*options); });
}

} // namespace tristim
