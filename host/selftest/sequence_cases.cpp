#include "selftest/sequence_cases.h"

#include "opencl/buffer.h"
#include "render/sobol.h"
#include "selftest/sequence_oracle.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <random>

namespace tristim::selftest {
namespace {

/// Numbers of passes, paths and seeds to try: 0, powers of two and the numbers beside them, the largest, random ones.
std::vector<std::uint32_t> probing_words(std::size_t random_ones) {
    std::vector<std::uint32_t> words{0U, 0xffffffffU};
    for (std::uint32_t power = 1U; power != 0U; power <<= 1U)
        words.insert(words.end(), {power, power - 1U, power + 1U});
    std::mt19937 engine(7);
    for (std::size_t i = 0; i < random_ones; ++i)
        words.push_back(static_cast<std::uint32_t>(engine()));
    return words;
}

template <typename... Buffers>
void enqueue(const Device& device, ::cl::Kernel& kernel, ::cl_uint argument, std::size_t items,
             const Buffers&... buffers) {
    (kernel.setArg(argument++, buffers.cl()), ...);
    device.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(items));
}

Measurement positions(const Setting& setting, const Programs& cores) {
    const ::cl::Program program = cores(setting);
    const Device& device = setting.device;
    Measurement found;
    for (const std::uint32_t seed : {0U, 9U, 0xffffffffU}) {
        for (const std::uint32_t of : {1U, 2U, 3U, 4U, 20U, 60U, 64U, 256U, 400U, 767U, 768U}) {
            std::vector<std::uint32_t> passes = probing_words(inputs(setting, 1000)), parts;
            for (std::size_t i = 0; i < passes.size(); ++i)
                parts.push_back(i % 3 == 0 ? of - 1U : static_cast<std::uint32_t>(i) % of);
            const Buffer<std::uint32_t> pass_buffer(device, "passes", passes), part_buffer(device, "parts", parts);
            const Buffer<std::uint32_t> out(device, "positions", passes.size());
            ::cl::Kernel kernel(program, "positions");
            kernel.setArg(0, seed);
            kernel.setArg(1, of);
            enqueue(device, kernel, 2, passes.size(), pass_buffer, part_buffer, out);
            const std::vector<std::uint32_t> read = out.read(device);
            for (std::size_t i = 0; i < read.size(); ++i) {
                const std::uint32_t exact = rotated(wavelength_position(seed, passes[i]), parts[i], of);
                found.add(std::floor(std::log2(passes[i] + 1.0)),
                          std::abs(static_cast<double>(read[i]) - static_cast<double>(exact)), [&] {
                              return fmt::format("seed {}, pass {}, part {} of {}: {} instead of {}", seed, passes[i],
                                                 parts[i], of, read[i], exact);
                          });
            }
        }
    }
    return found;
}

constexpr std::size_t cells = 16;
/// 128 pairs to a cell. Fewer passes would show the gaps of nets, so that less effort means fewer runs.
constexpr std::size_t passes_of_run = 1U << 15U;

double within_part(double u, double parts) {
    return u * parts - std::floor(u * parts);
}

/// Photon counts with the structure that the sequence's base has, and without; a few paths of each; from the first pass
/// on, and over the one where the sequence's 32-bit index begins anew.
std::vector<LongRun> photon_runs() {
    std::vector<LongRun> runs;
    for (const std::uint32_t paths : {65536U, 3U, 1U << 20U, 16U, 1000U, 1U, 4096U, 256U}) {
        const std::uint32_t wrap = 0xffffffffU / paths;
        for (const std::uint32_t path : {0U, paths / 3U, paths - 1U}) {
            for (const std::uint32_t first : {0U, wrap - std::min(wrap, 10000U)})
                runs.push_back({3, first, paths, path, 0, passes_of_run});
        }
    }
    return runs;
}

std::vector<LongRun> pixel_runs() {
    std::vector<LongRun> runs;
    for (const std::uint32_t pixel : {1U, 0U, 2U, 1919U, 1920U, 2073599U}) {
        for (const std::uint32_t first : {0U, 1000000U, 0xffffffffU - 100000U})
            runs.push_back({3, first, 1, 0, pixel, passes_of_run});
    }
    return runs;
}

template <typename Dependence, typename Parameter>
Measurement dependences(const Setting& setting, const Programs& cores, std::vector<LongRun> runs,
                        Dependence&& dependence, Parameter&& parameter) {
    const ::cl::Program program = cores(setting);
    runs.resize(std::min(runs.size(), inputs(setting, runs.size())));
    Measurement found;
    for (const LongRun& run : runs) {
        std::string which;
        const double error = dependence(run, pass_numbers(setting.device, program, run), which);
        found.add(parameter(run), error, [&] {
            return fmt::format("{} paths a pass, path {}, pixel {}, from pass {} on: {}", run.paths_per_pass, run.path,
                               run.pixel, run.first, which);
        });
    }
    return found;
}

} // namespace

void PairCounts::add(double x, double y) {
    const std::size_t rows = counts_.size() / columns_;
    const auto cell = [](double u, std::size_t of) {
        return std::min(static_cast<std::size_t>(u * static_cast<double>(of)), of - 1);
    };
    ++counts_[cell(y, rows) * columns_ + cell(x, columns_)];
}

double PairCounts::dependence() const {
    const std::size_t rows = counts_.size() / columns_;
    const auto sums = [&](const std::vector<bool>& column_in, const std::vector<bool>& row_in) {
        std::pair<std::vector<double>, std::vector<double>> of{std::vector<double>(columns_, 0.0),
                                                               std::vector<double>(rows, 0.0)};
        for (std::size_t i = 0; i < counts_.size(); ++i) {
            if (column_in[i % columns_] && row_in[i / columns_]) {
                of.first[i % columns_] += counts_[i];
                of.second[i / columns_] += counts_[i];
            }
        }
        return of;
    };
    std::vector<bool> column_in(columns_, true), row_in(rows, true);
    const auto all = sums(column_in, row_in);
    for (std::size_t x = 0; x < columns_; ++x)
        column_in[x] = all.first[x] >= 5.0 * static_cast<double>(rows);
    for (std::size_t y = 0; y < rows; ++y)
        row_in[y] = all.second[y] >= 5.0 * static_cast<double>(columns_);
    const auto [of_column, of_row] = sums(column_in, row_in);
    double total = 0.0;
    for (const double count : of_row)
        total += count;
    double statistic = 0.0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        if (!column_in[i % columns_] || !row_in[i / columns_])
            continue;
        const double expected = of_column[i % columns_] * of_row[i / columns_] / total;
        statistic += (counts_[i] - expected) * (counts_[i] - expected) / expected;
    }
    const auto freedom = [](const std::vector<bool>& in) {
        return static_cast<double>(std::count(in.begin(), in.end(), true)) - 1.0;
    };
    const double degrees = freedom(column_in) * freedom(row_in);
    if (freedom(column_in) < 1.0 || freedom(row_in) < 1.0)
        return 0.0;
    return statistic / degrees;
}

std::vector<PassNumbers> pass_numbers(const Device& device, const ::cl::Program& program, const LongRun& run) {
    static_assert(sizeof(PassNumbers) == 17 * sizeof(float));
    const Buffer<std::uint32_t> table(device, "Sobol' table", sobol_table());
    const Buffer<PassNumbers> out(device, "numbers of passes", run.passes);
    ::cl::Kernel kernel(program, "long_run");
    ::cl_uint argument = 0;
    kernel.setArg(argument++, table.cl());
    for (const std::uint32_t value : {run.seed, run.first, run.paths_per_pass, run.path, run.pixel})
        kernel.setArg(argument++, value);
    enqueue(device, kernel, argument, run.passes, out);
    return out.read(device);
}

double photon_dependence(const LongRun& run, const std::vector<PassNumbers>& numbers, std::string& which) {
    double largest = 0.0;
    for (std::size_t d = 0; d < 8; ++d) {
        PairCounts whole(cells, cells), part(cells, cells);
        for (const PassNumbers& pass : numbers) {
            whole.add(pass.wavelengths, pass.photon[d]);
            part.add(pass.wavelengths, within_part(pass.photon[d], run.paths_per_pass));
        }
        for (const auto& [counts, name] :
             {std::pair{&whole, "dimension {}"}, {&part, "within parts of dimension {}"}}) {
            const double found = counts->dependence();
            if (which.empty() || found > largest)
                which = fmt::format(fmt::runtime(name), d);
            largest = std::max(largest, found);
        }
    }
    return largest;
}

double eye_dependence(const LongRun& /*run*/, const std::vector<PassNumbers>& numbers, std::string& which) {
    double largest = 0.0;
    for (std::size_t d = 0; d < 8; ++d) {
        PairCounts counts(cells, cells);
        for (const PassNumbers& pass : numbers)
            counts.add(pass.wavelengths, pass.eye[d]);
        const double found = counts.dependence();
        if (which.empty() || found > largest)
            which = fmt::format("dimension {}", d);
        largest = std::max(largest, found);
    }
    return largest;
}

std::vector<Case> sequence_cases(const Programs& cores) {
    return {{"sequence", "places of wavelengths, passes to 2^32", "log2 of the pass", "place, in 2^-32", 0.0, 0.0,
             [=](const Setting& setting) { return positions(setting, cores); }},
            {"sequence", "wavelengths against photons over passes", "photon paths per pass",
             "χ² of pairs over degrees of freedom", dependence_bound, dependence_bound,
             [=](const Setting& setting) {
                 return dependences(setting, cores, photon_runs(), photon_dependence,
                                    [](const LongRun& run) { return run.paths_per_pass; });
             }},
            {"sequence", "wavelengths against pixels over passes", "pixel", "χ² of pairs over degrees of freedom",
             dependence_bound, dependence_bound, [=](const Setting& setting) {
                 return dependences(setting, cores, pixel_runs(), eye_dependence,
                                    [](const LongRun& run) { return run.pixel; });
             }}};
}

std::vector<Case> sequence_cases() {
    return sequence_cases(built_once([](const Setting& setting) { return build(setting, "sequence.cl"); }));
}

} // namespace tristim::selftest
