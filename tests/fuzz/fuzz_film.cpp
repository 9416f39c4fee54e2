// What a user types for films and images: the first line of an input is a film stack, the second a range of values, the
// third a region, the fourth an index, the fifth an illuminant. None may name a file.

#include "line_mutator.h"
#include "scratch.h"

#include "base/region.h"
#include "base/split.h"
#include "films/film_stack.h"
#include "films/illuminant.h"
#include "films/value_range.h"

#include <cmath>

namespace tristim::fuzz {

namespace {

void check_stack(const std::string& text) {
    const FilmStack stack = parse_film_stack(text);
    for (const StackLayer& layer : stack.layers)
        require(layer.thickness >= 0.0 && layer.thickness <= max_layer_thickness_nm, "thicknesses are in range");
    require(!stack.description().empty(), "a stack has a description");
    has_absorbing_layer(stack, lambda_min_nm, lambda_max_nm);
    check_stack_covers(stack, lambda_min_nm, lambda_max_nm);
}

void check_range(const std::string& text) {
    const std::vector<double> values = parse_range(text, "value");
    require(!values.empty() && static_cast<double>(values.size()) <= max_range_values + 1.0, "a range is short");
    for (std::size_t i = 0; i < values.size(); ++i)
        require(std::isfinite(values[i]) && (i == 0 || values[i] >= values[i - 1]), "a range ascends");
}

void check_region(const std::string& text) {
    const Region region = parse_region(text);
    require(region.x >= 0 && region.y >= 0 && region.width > 0 && region.height > 0, "a region has pixels");
    require(contains(region, region), "a region contains itself");
}

void check_index_text(const std::string& text) {
    const ComplexIndex index = parse_index(text);
    require(std::isfinite(index.eta.mean(lambda_min_nm, lambda_max_nm)), "n is finite");
    require(std::isfinite(index.k.mean(lambda_min_nm, lambda_max_nm)), "k is finite");
}

} // namespace

} // namespace tristim::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tristim;
    using namespace tristim::fuzz;
    std::string text(data, data + size);
    for (std::size_t at = text.find(".spd"); at != text.npos; at = text.find(".spd"))
        text.replace(at, 4, ".txt");
    std::vector<std::string> lines = split(text, '\n');
    lines.resize(5);
    expect_value_or_error([&] { check_stack(lines[0]); });
    expect_value_or_error([&] { check_range(lines[1]); });
    expect_value_or_error([&] { check_region(lines[2]); });
    expect_value_or_error([&] { check_index_text(lines[3]); });
    expect_value_or_error([&] { find_illuminant(lines[4]); });
    return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    return tristim::fuzz::mutate_text(data, size, max_size, seed);
}
