#include "selftest/film_points.h"

#include "opencl/buffer.h"
#include "shared_types.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace tristim::selftest {
namespace {

constexpr std::size_t lanes = 8;
constexpr std::size_t group = 8;                    // work-items
constexpr std::size_t media_rows = 4;               // n outside; n and k of the base; the cosine
constexpr std::size_t points_per_launch = 1U << 14; // of few layers
constexpr std::size_t layers_per_launch = 1U << 15;

bool same_item(const FilmPoint& a, const FilmPoint& b) {
    return a.from_outside == b.from_outside &&
           std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(),
                      [](const auto& x, const auto& y) { return x.thickness == y.thickness; });
}

/// What the kernels are given for a launch.
struct Launch {
    std::vector<cl_int4> films;
    std::vector<float> tables;
    std::vector<SceneFilmLayer> layers = std::vector<SceneFilmLayer>(1); // never empty

    void add(const FilmPoint* points, std::size_t count) {
        const FilmPoint& first = points[0];
        films.push_back({{static_cast<int>(tables.size()), static_cast<int>(layers.size()),
                          static_cast<int>(first.layers.size()), first.from_outside ? 1 : 0}});
        const auto row = [&](auto value) {
            for (std::size_t lane = 0; lane < lanes; ++lane)
                tables.push_back(value(points[std::min(lane, count - 1)]));
        };
        row([](const FilmPoint& p) { return p.lambda; });
        tables.insert(tables.end(), (PASS_TABLE_SPECTRA - 1) * lanes, std::numeric_limits<float>::quiet_NaN());
        row([](const FilmPoint& p) { return p.n0; });
        row([](const FilmPoint& p) { return p.base_n; });
        row([](const FilmPoint& p) { return p.base_k; });
        row([](const FilmPoint& p) { return p.cos_i; });
        for (std::size_t i = 0; i < first.layers.size(); ++i) {
            const int eta = static_cast<int>(media_rows + 2 * i);
            layers.push_back({first.layers[i].thickness, eta, eta + 1, 0});
            row([i](const FilmPoint& p) { return p.layers[i].n; });
            row([i](const FilmPoint& p) { return p.layers[i].k; });
        }
    }
};

} // namespace

std::string describe(const FilmPoint& point) {
    std::string text = fmt::format("{:.9g} nm, cosine {:.9g} from {}, {:.9g} | ", point.lambda, point.cos_i,
                                   point.from_outside ? "outside" : "the base", point.n0);
    constexpr std::size_t most = 4;
    for (std::size_t i = 0; i < std::min(point.layers.size(), most); ++i) {
        const FilmPoint::Layer& layer = point.layers[i];
        text += fmt::format("{:.9g}+{:.9g}i {:.9g} nm | ", layer.n, layer.k, layer.thickness);
    }
    if (point.layers.size() > most)
        text += fmt::format("… {} layers in all | ", point.layers.size());
    return text + fmt::format("{:.9g}+{:.9g}i", point.base_n, point.base_k);
}

bool has_absorbing_layer(const FilmPoint& point) {
    return std::any_of(point.layers.begin(), point.layers.end(), [](const auto& layer) { return layer.k > 0.0F; });
}

oracle::FilmOptics exact_optics(const FilmPoint& point) {
    std::vector<oracle::Layer> layers;
    for (const FilmPoint::Layer& layer : point.layers)
        layers.push_back({layer.thickness, layer.n, layer.k});
    return oracle::film(point.n0, layers, point.base_n, point.base_k, point.lambda, point.cos_i, point.from_outside);
}

const ::cl::Program& FilmKernels::program(const Setting& setting, bool absorbing) {
    ::cl::Program& known = programs_[{setting.device.context(), setting.fast_math, absorbing}];
    if (known() == nullptr) {
        known = builder_(setting, {{"W", std::to_string(lanes)},
                                   {"LANES", std::to_string(lanes)},
                                   {"BLOCKS", "1"},
                                   {"HAS_FILM", "1"},
                                   {"HAS_ABSORBING_FILM", absorbing ? "1" : "0"}});
    }
    return known;
}

template <typename Store, typename... Arguments>
void FilmKernels::run(const Setting& setting, const char* kernel_name, std::size_t rows, bool absorbing,
                      const std::vector<FilmPoint>& points, const Store& store, const Arguments&... more) {
    const Device& device = setting.device;
    ::cl::Kernel kernel(program(setting, absorbing), kernel_name);
    for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end) {
        Launch launch;
        std::vector<std::size_t> places; // of each point's first value among the results
        std::size_t layers = 0;
        while (end < points.size() && end - begin < points_per_launch && layers < layers_per_launch) {
            const std::size_t first = end++;
            while (end < points.size() && end < first + lanes && same_item(points[first], points[end]))
                ++end;
            for (std::size_t lane = 0; lane < end - first; ++lane)
                places.push_back(launch.films.size() * rows * lanes + lane);
            launch.add(&points[first], end - first);
            layers += points[first].layers.size();
        }
        const std::size_t items = launch.films.size(), padded = (items + group - 1) / group * group;
        const Buffer<cl_int4> films(device, "films", launch.films);
        const Buffer<float> tables(device, "pass tables", launch.tables);
        const Buffer<SceneFilmLayer> film_layers(device, "film layers", launch.layers);
        const Buffer<float> results(device, "film shares", items * rows * lanes);
        cl_uint argument = 0;
        kernel.setArg(argument++, static_cast<cl_uint>(items));
        kernel.setArg(argument++, films.cl());
        kernel.setArg(argument++, tables.cl());
        kernel.setArg(argument++, film_layers.cl());
        kernel.setArg(argument++, results.cl());
        (kernel.setArg(argument++, more), ...);
        device.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(padded), ::cl::NDRange(group));
        const std::vector<float> values = results.read(device);
        for (std::size_t i = begin; i < end; ++i)
            store(i, values.data() + places[i - begin]);
    }
}

std::vector<oracle::FilmOptics> FilmKernels::optics(const Setting& setting, const std::vector<FilmPoint>& points,
                                                    bool absorbing) {
    std::vector<oracle::FilmOptics> answers(points.size());
    run(setting, "film_shares", 4, absorbing, points, [&](std::size_t i, const float* at) {
        answers[i] = {at[0], at[lanes], at[2 * lanes], at[3 * lanes]};
    });
    return answers;
}

std::vector<double> FilmKernels::internal_reflectances(const Setting& setting, const std::vector<FilmPoint>& points,
                                                       bool absorbing, int most_quadrature_points) {
    std::vector<double> answers(points.size());
    run(
        setting, "film_internal", 1, absorbing, points,
        [&](std::size_t i, const float* at) { answers[i] = double{*at}; }, static_cast<cl_int>(most_quadrature_points));
    return answers;
}

double largest_difference(const oracle::FilmOptics& a, const oracle::FilmOptics& b) {
    double worst = 0.0;
    for (const double d : {a.reflected_s - b.reflected_s, a.reflected_p - b.reflected_p,
                           a.transmitted_s - b.transmitted_s, a.transmitted_p - b.transmitted_p})
        worst = std::max(worst, std::isfinite(d) ? std::abs(d) : std::numeric_limits<double>::infinity());
    return worst;
}

double absolute_error(const FilmPoint& point, const oracle::FilmOptics& answer) {
    return largest_difference(answer, exact_optics(point));
}

double power_error(const FilmPoint& point, const oracle::FilmOptics& answer) {
    const bool absorbs = point.base_k > 0.0F || has_absorbing_layer(point);
    double worst = 0.0;
    for (const double share : {answer.reflected_s, answer.reflected_p, answer.transmitted_s, answer.transmitted_p}) {
        if (!std::isfinite(share))
            return std::numeric_limits<double>::infinity();
        worst = std::max(worst, -share);
    }
    for (const double sum : {answer.reflected_s + answer.transmitted_s, answer.reflected_p + answer.transmitted_p})
        worst = std::max(worst, absorbs ? sum - 1.0 : std::abs(sum - 1.0));
    return worst;
}

Measurement measure_films(FilmKernels& kernels, const Setting& setting, const std::vector<FilmInput>& inputs,
                          const FilmError& error) {
    Measurement found;
    std::vector<FilmPoint> all, clear;
    std::vector<double> all_parameters, clear_parameters;
    for (const FilmInput& input : inputs) {
        all.push_back(input.point);
        all_parameters.push_back(input.parameter);
        if (!has_absorbing_layer(input.point)) {
            clear.push_back(input.point);
            clear_parameters.push_back(input.parameter);
        }
    }
    for (const bool absorbing : {true, false}) {
        const std::vector<FilmPoint>& points = absorbing ? all : clear;
        const std::vector<double>& parameters = absorbing ? all_parameters : clear_parameters;
        const std::vector<oracle::FilmOptics> answers = kernels.optics(setting, points, absorbing);
        for (std::size_t i = 0; i < points.size(); ++i) {
            found.add(parameters[i], error(points[i], answers[i]), [&] {
                const oracle::FilmOptics& a = answers[i];
                return fmt::format("{}, {} code for absorbing layers: R_s {:.8f} R_p {:.8f} T_s {:.8f} T_p {:.8f}",
                                   describe(points[i]), absorbing ? "with" : "without", a.reflected_s, a.reflected_p,
                                   a.transmitted_s, a.transmitted_p);
            });
        }
    }
    return found;
}

} // namespace tristim::selftest
