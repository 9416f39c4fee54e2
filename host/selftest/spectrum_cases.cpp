#include "selftest/spectrum_cases.h"

#include "base/error.h"
#include "opencl/buffer.h"
#include "render/sampler_table.h"
#include "selftest/sequence_oracle.h"
#include "selftest/spectrum_oracle.h"
#include "spectra/colour.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>
#include <random>

namespace tristim::selftest {
namespace {

constexpr int wavelengths = 12;
constexpr std::uint32_t seed = 77;
constexpr double all_positions = 0x1p32;
constexpr std::uint64_t last_position = 0xffffffff;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// What a sampler is told that the lights emit.
struct Told {
    const char* name;
    WavelengthBins emission;
};

/// A triangle of unit area on a foot of 0.01 nm, as far as it is visible.
WavelengthBins line_at(double nm) {
    return Spectrum::piecewise_linear({nm - 0.005, nm, nm + 0.005}, {0.0, 200.0, 0.0}).bins();
}

const std::vector<Told>& lights() {
    static const std::vector<Told> all = [] {
        WavelengthBins comb{};
        for (std::size_t i = 0; i < comb.size(); ++i)
            comb[i] = i % 7 == 0 ? 1e30 : 1e-30;
        const Spectrum middle = Spectrum::piecewise_linear({400.25, 700.75}, {1.0, 1.0});
        return std::vector<Told>{{"daylight", Spectrum::named("stdillum-D65").bins()},
                                 {"mercury lines", Spectrum::named("illum-mercury-lines").bins()},
                                 {"a line at 546.075 nm", line_at(546.075)},
                                 {"a line at 780 nm", line_at(780.0)},
                                 {"400.25 to 700.75 nm alone", middle.bins()},
                                 {"1e-30 and 1e30 in turns", comb},
                                 {"nothing", {}}};
    }();
    return all;
}

bool heeds_light(Method::Kind kind) {
    return kind == Method::Kind::Illuminant || kind == Method::Kind::IlluminantMixture;
}

/// Whether wavelengths come from a table of a CDF.
bool has_table(Method::Kind kind) {
    return heeds_light(kind) || kind == Method::Kind::Tristimulus || kind == Method::Kind::Mixture;
}

struct Sample {
    float lambda;
    std::array<float, 3> weight;
};

/// A sampler of twelve wavelengths on the device, asked for any of the 2^32 positions that a pass may have.
class DeviceSampler {
  public:
    DeviceSampler(const Device& device, const ::cl::Program& program, const MethodKind& kind,
                  const WavelengthBins& emission)
        : device_(device), kernel_(program, (std::string("sample_by_") + kind.sampler).c_str()),
          rows_(kind.wavelengths == 3 ? 3 : 1) {
        const Method method{kind.kind, wavelengths / kind.wavelengths};
        table_ = Buffer<float>(device, "sampler table", sampler_table(method, emission));
    }

    int parts() const { return wavelengths / rows_; }
    int part(int slot) const { return slot / rows_; }
    std::size_t row(int slot) const { return static_cast<std::size_t>(slot % rows_); }
    /// Where wavelength `slot` lies on its CDF.
    std::uint32_t place(std::uint32_t position, int slot) const {
        return rotated(position, static_cast<std::uint32_t>(part(slot)), static_cast<std::uint32_t>(parts()));
    }

    std::vector<Sample> operator()(const std::vector<std::uint32_t>& positions, const std::vector<int>& slots) const {
        std::vector<std::uint32_t> passes;
        passes.reserve(positions.size());
        for (const std::uint32_t position : positions)
            passes.push_back(pass_of_wavelength_position(seed, position));
        const Buffer<std::uint32_t> pass_buffer(device_, "passes", passes);
        const Buffer<std::int32_t> slot_buffer(device_, "slots", slots);
        const Buffer<Sample> samples(device_, "samples", positions.size());
        ::cl::Kernel kernel = kernel_;
        kernel.setArg(0, seed);
        kernel.setArg(1, table_.cl());
        kernel.setArg(2, pass_buffer.cl());
        kernel.setArg(3, slot_buffer.cl());
        kernel.setArg(4, samples.cl());
        device_.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(positions.size()));
        return samples.read(device_);
    }

  private:
    Device device_;
    ::cl::Kernel kernel_;
    int rows_;
    Buffer<float> table_;
};

/// Calls function(sampler on the device, kind, light) for every sampler with a table, or for all others; those that
/// heed the light are told of each of the lights.
template <typename Function>
void for_each_sampler(const Setting& setting, const Programs& cores, bool tables, Function&& function) {
    const ::cl::Program program = cores(setting);
    for (const MethodKind& kind : method_kinds()) {
        if (!kind.unbiased || kind.kind == Method::Kind::Spectral || has_table(kind.kind) != tables)
            continue;
        for (const Told& light : lights()) {
            function(DeviceSampler(setting.device, program, kind, light.emission), kind, light);
            if (!heeds_light(kind.kind))
                break;
        }
    }
}

std::string described(const MethodKind& kind, const Told& light) {
    return heeds_light(kind.kind) ? fmt::format("{} told of {}", kind.name, light.name) : kind.name;
}

bool is_sound(const Sample& sample) {
    const auto& [x, y, z] = sample.weight;
    return sample.lambda >= static_cast<float>(lambda_min_nm) && sample.lambda <= static_cast<float>(lambda_max_nm) &&
           std::min({x, y, z}) >= 0.0F && std::isfinite(x + y + z) && x + y + z > 0.0F;
}

/// Ends, and where digits that floats drop change.
std::vector<std::uint32_t> probing_positions(std::size_t random_ones) {
    std::vector<std::uint32_t> positions;
    for (const std::uint32_t step : {0U, 1U, 2U, 127U, 128U, 255U, 256U, 65535U, 1U << 24U, (1U << 31U) - 1U}) {
        positions.push_back(step);
        positions.push_back(~step);
    }
    std::mt19937 engine(5);
    for (std::size_t i = 0; i < random_ones; ++i)
        positions.push_back(static_cast<std::uint32_t>(engine()));
    std::sort(positions.begin(), positions.end());
    return positions;
}

/// How far wavelengths are from those of the positions, which may be off by `slack`; or go back where positions go on.
Measurement inverse_cdfs(const Setting& setting, const Programs& cores, bool tables, double slack) {
    Measurement found;
    const std::vector<std::uint32_t> probes = probing_positions(inputs(setting, 400));
    for_each_sampler(
        setting, cores, tables, [&](const DeviceSampler& sampler, const MethodKind& kind, const Told& light) {
            const WavelengthOracle oracle(kind.kind, light.emission);
            std::vector<std::uint32_t> positions;
            std::vector<int> slots;
            for (int slot = 0; slot < wavelengths; ++slot) {
                positions.insert(positions.end(), probes.begin(), probes.end());
                slots.insert(slots.end(), probes.size(), slot);
            }
            const std::vector<Sample> samples = sampler(positions, slots);
            for (std::size_t i = 0; i < samples.size(); ++i) {
                const std::size_t row = sampler.row(slots[i]);
                const double u = sampler.place(positions[i], slots[i]) / all_positions;
                const double lambda = samples[i].lambda;
                double error =
                    std::max({0.0, lambda - oracle.lambda(row, u + slack), oracle.lambda(row, u - slack) - lambda});
                if (i % probes.size() > 0)
                    error = std::max(error, double{samples[i - 1].lambda} - lambda);
                if (!is_sound(samples[i]))
                    error = infinity;
                found.add(std::floor(64.0 * u) / 64.0, error, [&] {
                    return fmt::format("{}, wavelength {}, u = {:.10f}: {} nm", described(kind, light), slots[i], u,
                                       lambda);
                });
            }
        });
    return found;
}

std::size_t bin_of(float lambda) {
    return static_cast<std::size_t>(std::clamp(double{lambda} - lambda_min_nm, 0.0, lambda_bins - 1.0));
}

/// Which of the 2^32 positions put wavelength `slot` into a bin: [first, last).
struct BinPositions {
    std::size_t bin;
    int slot;
    std::uint64_t first = 0, last = 0;
};

/// By bisection: wavelengths ascend with the position.
void find_positions(const DeviceSampler& sampler, std::vector<BinPositions>& of_bins) {
    struct Search {
        std::uint64_t low, high; ///< the first position with a bin of `bin` or more lies in [low, high]
        std::size_t bin;
        int slot;
    };
    std::vector<Search> searches;
    for (const BinPositions& of : of_bins) {
        for (const std::size_t bin : {of.bin, of.bin + 1})
            searches.push_back({0, std::uint64_t{1} << 32U, bin, of.slot});
    }
    std::vector<int> slots;
    for (const Search& search : searches)
        slots.push_back(search.slot);
    for (int round = 0; round < 33; ++round) {
        std::vector<std::uint32_t> middles;
        for (const Search& search : searches)
            middles.push_back(static_cast<std::uint32_t>(std::min((search.low + search.high) / 2, last_position)));
        const std::vector<Sample> samples = sampler(middles, slots);
        for (std::size_t i = 0; i < searches.size(); ++i) {
            Search& search = searches[i];
            if (search.low == search.high)
                continue;
            if (bin_of(samples[i].lambda) >= search.bin)
                search.high = middles[i];
            else
                search.low = middles[i] + std::uint64_t{1};
        }
    }
    for (std::size_t i = 0; i < of_bins.size(); ++i) {
        of_bins[i].first = searches[2 * i].low;
        of_bins[i].last = searches[2 * i + 1].low;
    }
}

/// X, Y and Z of a line of unit area in each bin, k times, averaged over all passes that there can be. The weights
/// within a bin are integrated by Gauss's rule of three points, as they hardly change there.
std::vector<Xyz> line_energies(const DeviceSampler& sampler, const std::vector<std::size_t>& bins) {
    std::vector<BinPositions> of_bins;
    for (const std::size_t bin : bins) {
        for (int slot = 0; slot < wavelengths; ++slot)
            of_bins.push_back({bin, slot});
    }
    find_positions(sampler, of_bins);
    constexpr std::array<double, 3> points{0.11270166537925831, 0.5, 0.8872983346207417};
    constexpr std::array<double, 3> shares{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    std::vector<std::uint32_t> positions;
    std::vector<int> slots;
    for (const BinPositions& of : of_bins) {
        for (const double point : points) {
            const auto step = static_cast<std::uint64_t>(point * static_cast<double>(of.last - of.first));
            positions.push_back(static_cast<std::uint32_t>(std::min(of.first + step, last_position)));
            slots.push_back(of.slot);
        }
    }
    const std::vector<Sample> samples = sampler(positions, slots);
    std::vector<Xyz> energies(bins.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const BinPositions& of = of_bins[i / points.size()];
        const double share = shares[i % points.size()] * static_cast<double>(of.last - of.first) / all_positions;
        for (std::size_t c = 0; c < 3 && share > 0.0; ++c)
            energies[i / points.size() / wavelengths][c] += share * samples[i].weight[c];
    }
    return energies;
}

Measurement lines(const Setting& setting, const Programs& cores, bool tables) {
    const std::size_t count = std::min(inputs(setting, lambda_bins, 5), std::size_t{lambda_bins});
    std::vector<std::size_t> bins;
    for (std::size_t i = 0; i < count; ++i)
        bins.push_back(i * (lambda_bins - 1) / (count - 1));
    Measurement found;
    for_each_sampler(
        setting, cores, tables, [&](const DeviceSampler& sampler, const MethodKind& kind, const Told& light) {
            const std::vector<Xyz> energies = line_energies(sampler, bins);
            for (std::size_t i = 0; i < bins.size(); ++i) {
                Xyz exact{};
                for (std::size_t c = 0; c < 3; ++c)
                    exact[c] = cie_bins()[c][bins[i]] / cie_y_integral();
                double error = 0.0;
                for (std::size_t c = 0; c < 3; ++c)
                    error = std::max(error, std::abs(energies[i][c] - exact[c]) / (exact[0] + exact[1] + exact[2]));
                const double nm = lambda_min_nm + static_cast<double>(bins[i]);
                found.add(nm, error, [&] {
                    return fmt::format("{}, a line at {} to {} nm: XYZ {:.4g} instead of {:.4g}",
                                       described(kind, light), nm, nm + 1.0, fmt::join(energies[i], ", "),
                                       fmt::join(exact, ", "));
                });
            }
        });
    return found;
}

/// The values that emission and smooth data have at knots, between them and at the ends of the table, over the larger
/// of the means that they lie between.
Measurement table_values(const Setting& setting, const Programs& cores) {
    std::vector<float> lambdas;
    const std::size_t step = std::max(std::size_t{1}, 2 * lambda_bins / inputs(setting, 2 * lambda_bins, 20));
    for (std::size_t half = 0; half <= 2 * lambda_bins; half += step) {
        const auto knot = static_cast<float>(lambda_min_nm + 0.5 * static_cast<double>(half));
        for (const float nm : {std::nextafter(knot, 0.0F), knot, std::nextafter(knot, 1000.0F), knot + 0.17F})
            lambdas.push_back(std::clamp(nm, 380.0F, 780.0F));
    }
    std::vector<std::pair<std::string, WavelengthBins>> tables;
    for (const Told& light : lights())
        tables.emplace_back(light.name, light.emission);
    for (const char* const name : {"glass-SF11", "metal-Au-k", "stdillum-F11"})
        tables.emplace_back(name, Spectrum::named(name).bins());

    const ::cl::Program program = cores(setting);
    Measurement found;
    for (const auto& [name, means] : tables) {
        const std::vector<float> bins(means.begin(), means.end());
        const Buffer<float> table(setting.device, "bins", bins);
        const Buffer<float> wavelength_buffer(setting.device, "wavelengths", lambdas);
        const Buffer<std::array<float, 2>> values(setting.device, "values", lambdas.size());
        ::cl::Kernel kernel(program, "read_bins");
        kernel.setArg(0, table.cl());
        kernel.setArg(1, wavelength_buffer.cl());
        kernel.setArg(2, values.cl());
        setting.device.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(lambdas.size()));
        const std::vector<std::array<float, 2>> read = values.read(setting.device);
        for (std::size_t i = 0; i < lambdas.size(); ++i) {
            const std::size_t bin = bin_of(lambdas[i]);
            float largest = 0.0F;
            for (std::size_t near = bin > 0 ? bin - 1 : 0; near <= std::min(bin + 1, bins.size() - 1); ++near)
                largest = std::max(largest, bins[near]);
            for (const bool smooth : {false, true}) {
                const double value = read[i][smooth ? 1 : 0];
                const double off = std::abs(value - table_value(bins, smooth, lambdas[i]));
                found.add(lambdas[i], off > 0.0 ? off / largest : off, [&, at = lambdas[i], is_smooth = smooth] {
                    return fmt::format("{} as {} at {} nm: {}", name, is_smooth ? "smooth data" : "emission", at,
                                       value);
                });
            }
        }
    }
    return found;
}

} // namespace

Macros spectrum_macros() {
    return method_macros({Method::Kind::Uniform, wavelengths}, false);
}

std::vector<Case> spectrum_cases(const Programs& cores) {
    // A CDF has 2^31 steps, of which a bin too dark for one still gets one; there are six such bins in a row at most.
    constexpr double table_slack = 8.0 * 0x1p-31;
    constexpr double float_slack = 0x1p-24;
    // λ is kept 2^-14 nm from the next bin and rounded to 2^-14 nm; the closed form goes through tanh and its inverse.
    constexpr double table_nm = 1e-4, closed_nm = 4e-4;
    // A step of 2^-31 on the share of 1.4e-7 that ȳ has at 780 nm, where it is a quarter of X + Y + Z. One of 2^-24 on
    // the least share of 4.4e-4 that a bin has in closed form.
    constexpr double table_line = 1e-3, closed_line = 3e-4;
    constexpr double values = 2.5e-7; // three roundings and a subtraction
    return {{"spectrum", "inverse CDFs of tables, u = 0 to 1", "u", "wavelength / nm", table_nm, table_nm,
             [=](const Setting& setting) { return inverse_cdfs(setting, cores, true, table_slack); }},
            {"spectrum", "inverse CDFs in closed form, u = 0 to 1", "u", "wavelength / nm", closed_nm, closed_nm,
             [=](const Setting& setting) { return inverse_cdfs(setting, cores, false, float_slack); }},
            {"spectrum", "lines, 380 to 780 nm, samplers with tables", "wavelength / nm", "XYZ, over X + Y + Z",
             table_line, table_line, [=](const Setting& setting) { return lines(setting, cores, true); }},
            {"spectrum", "lines, 380 to 780 nm, other samplers", "wavelength / nm", "XYZ, over X + Y + Z", closed_line,
             closed_line, [=](const Setting& setting) { return lines(setting, cores, false); }},
            {"spectrum", "tables at their knots and ends", "wavelength / nm", "value, over the larger neighbour",
             values, values, [=](const Setting& setting) { return table_values(setting, cores); }}};
}

std::vector<Case> spectrum_cases() {
    return spectrum_cases(
        built_once([](const Setting& setting) { return build(setting, "spectrum.cl", spectrum_macros()); }));
}

} // namespace tristim::selftest
