#include "films/film_evaluator.h"

#include "base/error.h"
#include "opencl/buffer.h"
#include "opencl/program.h"
#include "shared_types.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tristim {
namespace {

constexpr std::size_t lanes = 16;
constexpr std::size_t media_rows = 3;              // n outside; n and k of the base
constexpr std::size_t max_table_floats = 1U << 23; // of the pass tables of one launch

float cosine_of(double angle_deg) {
    return angle_deg == 90.0 ? 0.0F : static_cast<float>(std::cos(angle_deg * std::numbers::pi / 180.0));
}

std::vector<SceneFilmLayer> layers_of(const std::vector<std::vector<double>>& films) {
    std::vector<SceneFilmLayer> layers;
    for (const std::vector<double>& film : films) {
        for (std::size_t i = 0; i < film.size(); ++i) {
            const int eta = static_cast<int>(media_rows + 2 * i);
            layers.push_back({static_cast<float>(film[i]), eta, eta + 1, 0});
        }
    }
    return layers;
}

} // namespace

FilmEvaluator::FilmEvaluator(const Device& device, const FilmStack& stack, double from_nm, double to_nm, bool fast_math)
    : device_(device), stack_(stack) {
    const Macros macros{{"W", std::to_string(lanes)},
                        {"LANES", std::to_string(lanes)},
                        {"BLOCKS", "1"},
                        {"HAS_FILM", "1"},
                        {"HAS_ABSORBING_FILM", has_absorbing_layer(stack, from_nm, to_nm) ? "1" : "0"}};
    kernel_ = ::cl::Kernel(build_program(device, "evaluate_film.cl", macros, {fast_math, {}}), "evaluate_film");
}

std::vector<FilmResponse> FilmEvaluator::evaluate(const std::vector<double>& lambda_nm, double angle_deg) const {
    std::vector<double> film;
    for (const StackLayer& layer : stack_.layers)
        film.push_back(layer.thickness);
    return evaluate_films(lambda_nm, angle_deg, {film});
}

std::vector<FilmResponse> FilmEvaluator::evaluate(const std::vector<double>& lambda_nm, double angle_deg,
                                                  std::size_t layer, const std::vector<double>& thicknesses) const {
    std::vector<std::vector<double>> films;
    for (const double thickness : thicknesses) {
        std::vector<double>& film = films.emplace_back();
        for (std::size_t i = 0; i < stack_.layers.size(); ++i)
            film.push_back(i == layer ? thickness : stack_.layers[i].thickness);
    }
    return evaluate_films(lambda_nm, angle_deg, films);
}

std::size_t FilmEvaluator::table_rows() const {
    return PASS_TABLE_SPECTRA + media_rows + 2 * stack_.layers.size();
}

std::vector<FilmResponse> FilmEvaluator::evaluate_films(const std::vector<double>& lambda_nm, double angle_deg,
                                                        const std::vector<std::vector<double>>& films) const {
    std::vector<FilmResponse> results(films.size() * lambda_nm.size());
    const std::size_t at_once = std::max(lanes, max_table_floats / table_rows() / lanes * lanes);
    for (std::size_t begin = 0; begin < lambda_nm.size(); begin += at_once)
        evaluate_part(lambda_nm, begin, std::min(begin + at_once, lambda_nm.size()), angle_deg, films, results);
    return results;
}

std::vector<float> FilmEvaluator::pass_tables(const std::vector<double>& lambda_nm, std::size_t begin,
                                              std::size_t end) const {
    std::vector<const Spectrum*> spectra{&stack_.outside.index.eta, &stack_.base.index.eta, &stack_.base.index.k};
    for (const StackLayer& layer : stack_.layers)
        spectra.insert(spectra.end(), {&layer.index.eta, &layer.index.k});
    std::vector<float> tables;
    for (std::size_t chunk = begin; chunk < end; chunk += lanes) {
        // The last wavelength fills up the last chunk.
        const auto lambda = [&](std::size_t lane) { return lambda_nm[std::min(chunk + lane, end - 1)]; };
        for (std::size_t lane = 0; lane < lanes; ++lane)
            tables.push_back(static_cast<float>(lambda(lane)));
        tables.insert(tables.end(), (PASS_TABLE_SPECTRA - 1) * lanes, 0.0F); // weights, which films do not need
        for (const Spectrum* spectrum : spectra) {
            for (std::size_t lane = 0; lane < lanes; ++lane)
                tables.push_back(static_cast<float>((*spectrum)(lambda(lane))));
        }
    }
    return tables;
}

void FilmEvaluator::evaluate_part(const std::vector<double>& lambda_nm, std::size_t begin, std::size_t end,
                                  double angle_deg, const std::vector<std::vector<double>>& films,
                                  std::vector<FilmResponse>& results) const {
    const std::size_t chunks = (end - begin + lanes - 1) / lanes;
    const std::size_t items = films.size() * chunks;
    const Buffer<float> tables(device_, "pass tables", pass_tables(lambda_nm, begin, end));
    const Buffer<SceneFilmLayer> layers(device_, "film layers", layers_of(films));
    const Buffer<float> output(device_, "film responses", items * 4 * lanes);
    cl_uint argument = 0;
    kernel_.setArg(argument++, static_cast<cl_uint>(items));
    kernel_.setArg(argument++, static_cast<cl_uint>(chunks));
    kernel_.setArg(argument++, static_cast<cl_uint>(table_rows()));
    kernel_.setArg(argument++, tables.cl());
    kernel_.setArg(argument++, static_cast<cl_int>(stack_.layers.size()));
    kernel_.setArg(argument++, layers.cl());
    kernel_.setArg(argument++, cosine_of(angle_deg));
    kernel_.setArg(argument++, output.cl());
    const std::size_t group = device_.tuning.pixel_group;
    const std::size_t padded = (items + group - 1) / group * group;
    device_.queue.enqueueNDRangeKernel(kernel_, ::cl::NullRange, ::cl::NDRange(padded), ::cl::NDRange(group));

    const std::vector<float> values = output.read(device_);
    for (std::size_t film = 0; film < films.size(); ++film) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t item = film * chunks + (i - begin) / lanes;
            const float* lane = values.data() + item * 4 * lanes + (i - begin) % lanes;
            const FilmResponse response{lane[0], lane[lanes], lane[2 * lanes], lane[3 * lanes]};
            if (!std::isfinite(response.reflected() + response.transmitted()))
                fail("the stack \"{}\" has no finite reflectance at {} nm and {} degrees in the device's arithmetic",
                     stack_.description(), lambda_nm[i], angle_deg);
            results[film * lambda_nm.size() + i] = response;
        }
    }
}

} // namespace tristim
