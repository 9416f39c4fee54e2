#include "thin_film_kernel.h"

#include "kernel_harness.h"
#include "shared_types.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>
#include <map>

namespace tristim::kernel_test {
namespace {

constexpr int blocks = 2;

// Each item has a pass table of its own, whose first spectra are the indices outside and of the base, and the cosine.
const char* const source = R"(
#include "thin_film.h"
kernel void films(const global float* tables, const global SceneFilmLayer* layers, const global int4* items,
                  const global float* first_thickness, global float* out) {
    const size_t i = get_global_id(0);
    const global float* table = tables + items[i].x;
    const ThinFilm film = {layers + items[i].y, items[i].z, first_thickness[i]};
    for (int b = 0; b < BLOCKS; ++b) {
        const FilmOptics optics = film_optics(table, b, &film, items[i].w != 0, vloadv(b, spectrum_row(table, 3)),
                                              vloadv(b, spectrum_row(table, 0)), vloadv(b, spectrum_row(table, 1)),
                                              vloadv(b, spectrum_row(table, 2)));
        global float* to = out + i * 4 * W_PADDED;
        vstorev(optics.reflected_s, b, to);
        vstorev(optics.reflected_p, b, to + W_PADDED);
        vstorev(optics.transmitted_s, b, to + 2 * W_PADDED);
        vstorev(optics.transmitted_p, b, to + 3 * W_PADDED);
    }
}
)";

::cl::Program built(const FilmProgram& program) {
    static std::map<std::pair<int, bool>, ::cl::Program> programs;
    ::cl::Program& known = programs[{program.lanes, program.absorbing}];
    if (known() == nullptr)
        known = build_test_program(source, {{"LANES", std::to_string(program.lanes)},
                                            {"BLOCKS", std::to_string(blocks)},
                                            {"HAS_ABSORBING_FILM", program.absorbing ? "1" : "0"}});
    return known;
}

} // namespace

std::size_t film_slots(const FilmProgram& program) {
    return static_cast<std::size_t>(blocks * program.lanes);
}

std::vector<std::vector<oracle::FilmOptics>> evaluate_films(const FilmProgram& program,
                                                            const std::vector<FilmCase>& cases) {
    const std::size_t slots = film_slots(program);
    constexpr float unread = std::numeric_limits<float>::quiet_NaN();
    constexpr int weights_row = -3; // as a spectrum
    std::vector<float> tables;
    std::vector<SceneFilmLayer> layers(1); // never empty
    std::vector<cl_int4> items;
    std::vector<float> first_thickness;
    for (const FilmCase& film : cases) {
        if (film.slots.size() != slots)
            throw std::invalid_argument("a film case must have as many slots as the program");
        const auto count = static_cast<int>(film.thickness.size());
        items.push_back(
            {{static_cast<int>(tables.size()), static_cast<int>(layers.size()), count, film.from_outside ? 1 : 0}});
        first_thickness.push_back(count > 0 ? film.thickness[0] : 0.0F);
        for (int i = 0; i < count; ++i)
            layers.push_back({i == 0 ? unread : film.thickness[static_cast<std::size_t>(i)], 4 + 2 * i,
                              program.absorbing ? 5 + 2 * i : weights_row, 0});
        const auto add_row = [&](auto value) {
            for (const FilmSlot& slot : film.slots)
                tables.push_back(value(slot));
        };
        add_row([](const FilmSlot& slot) { return slot.lambda; });
        tables.insert(tables.end(), 3 * slots, unread);
        add_row([](const FilmSlot& slot) { return slot.n0; });
        add_row([](const FilmSlot& slot) { return slot.base_n; });
        add_row([](const FilmSlot& slot) { return slot.base_k; });
        add_row([](const FilmSlot& slot) { return slot.cos_i; });
        for (std::size_t i = 0; i < film.thickness.size(); ++i) {
            add_row([i](const FilmSlot& slot) { return slot.n[i]; });
            add_row([i](const FilmSlot& slot) { return slot.k[i]; });
        }
    }
    const Buffer<float> output = make_buffer<float>(4 * slots * cases.size());
    run(built(program), "films", cases.size(), upload(tables), upload(layers), upload(items), upload(first_thickness),
        output);
    const std::vector<float> values = output.read(test_device());
    std::vector<std::vector<oracle::FilmOptics>> results(cases.size(), std::vector<oracle::FilmOptics>(slots));
    for (std::size_t i = 0; i < cases.size(); ++i)
        for (std::size_t w = 0; w < slots; ++w) {
            const float* at = values.data() + 4 * slots * i + w;
            results[i][w] = {at[0], at[slots], at[2 * slots], at[3 * slots]};
        }
    return results;
}

oracle::FilmOptics expected_optics(const FilmCase& film, const FilmSlot& slot) {
    std::vector<oracle::Layer> layers;
    for (std::size_t i = 0; i < film.thickness.size(); ++i)
        layers.push_back({film.thickness[i], slot.n[i], slot.k[i]});
    return oracle::film(slot.n0, layers, slot.base_n, slot.base_k, slot.lambda, slot.cos_i, film.from_outside);
}

} // namespace tristim::kernel_test
