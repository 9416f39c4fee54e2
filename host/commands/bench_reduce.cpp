#include "commands/bench_reduce.h"

#include "base/median.h"
#include "base/stopwatch.h"
#include "commands/parse.h"
#include "mpi/communicator.h"
#include "render/film.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace tristim {
namespace {

constexpr int round_trips = 2000;

struct BenchReduce {
    std::string resolution = "1920x1080";
    int repeats = 5;
    bool json = false;
};

/// Sums such as a render has: what they are makes no difference to the time, as long as they are normal numbers.
std::vector<FilmPixel> some_film(std::size_t pixels) {
    FilmPixel pixel{};
    for (std::size_t c = 0; c < 3; ++c) {
        pixel.sum_high[c] = 12.3456F;
        pixel.sum_middle[c] = 1.2345e-7F;
        pixel.square_high[c] = 2.3456F;
    }
    pixel.samples = 100;
    return std::vector<FilmPixel>(pixels, pixel);
}

Words wait_for_message(Communicator& ranks) {
    for (;;) {
        if (const std::optional<Message> message = ranks.receive())
            return message->words;
    }
}

/// Half of what it takes a message to go from rank 0 to rank 1 and another one to come back, seconds; the median.
double message_seconds(Communicator& ranks) {
    std::vector<double> both_ways;
    for (int i = 0; i < round_trips && ranks.rank() < 2; ++i) {
        const Stopwatch stopwatch;
        if (ranks.rank() == 0)
            ranks.send(1, {1, 2, 3, 4, 5});
        const Words words = wait_for_message(ranks);
        if (ranks.rank() == 1)
            ranks.send(0, words);
        both_ways.push_back(stopwatch.seconds());
    }
    return both_ways.empty() ? 0.0 : 0.5 * median(both_ways);
}

void run(const BenchReduce& command) {
    const auto [width, height] = parse_resolution(command.resolution, {1920, 1080});
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    Communicator* const ranks = join_ranks();
    const std::vector<FilmPixel> film = some_film(pixels);
    std::vector<FilmPixel> sum = film;
    std::vector<double> adding, reducing;
    for (int i = 0; i < command.repeats; ++i) {
        const Stopwatch stopwatch;
        add_film(sum, film);
        adding.push_back(stopwatch.seconds());
    }
    for (int i = 0; i < command.repeats && ranks != nullptr; ++i) {
        sum = film;
        ranks->gather(""); // so that all begin at the same time
        const Stopwatch stopwatch;
        ranks->reduce(sum);
        reducing.push_back(stopwatch.seconds());
    }
    nlohmann::ordered_json json{{"ranks", ranks != nullptr ? ranks->size() : 1},
                                {"pixels", pixels},
                                {"bytes", pixels * sizeof(FilmPixel)},
                                {"add_seconds", median(adding)}};
    if (ranks != nullptr) {
        json["reduce_seconds"] = median(reducing);
        json["message_seconds"] = message_seconds(*ranks);
    }
    if (ranks == nullptr || ranks->rank() == 0) {
        if (command.json)
            fmt::print("{}\n", json.dump(2));
        else
            for (const auto& [name, value] : json.items())
                fmt::print("{:<16} {}\n", name, value.dump());
    }
    leave_ranks();
}

} // namespace

void add_bench_reduce_command(CLI::App& app) {
    auto command = std::make_shared<BenchReduce>();
    CLI::App* sub = app.add_subcommand(
        "bench-reduce", "Measure what adding up films takes: two in one process, those of all ranks under mpirun");
    sub->add_option("--resolution", command->resolution, "Size of the image")->type_name("WxH")->capture_default_str();
    sub->add_option("--repeats", command->repeats, "Times to measure; medians are told")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    sub->add_flag("--json", command->json, "Print JSON");
    sub->callback([command] { run(*command); });
}

} // namespace tristim
