#include "films/film_stack.h"

#include "base/error.h"
#include "base/parse_number.h"
#include "base/split.h"

#include <cmath>
#include <string_view>

namespace tristim {
namespace {

std::string trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\n";
    const std::size_t begin = text.find_first_not_of(blanks);
    if (begin == text.npos)
        return {};
    return std::string(text.substr(begin, text.find_last_not_of(blanks) - begin + 1));
}

/// How messages name a part of the stack.
std::string place(std::size_t i, std::size_t count, const std::string& part) {
    if (i == 0)
        return fmt::format("the first medium \"{}\" of the stack", part);
    if (i + 1 == count)
        return fmt::format("the base \"{}\" of the stack", part);
    return fmt::format("layer {} \"{}\" of the stack", i, part);
}

ComplexIndex index_of(const std::string& text, const std::string& where) {
    if (text.empty())
        fail("{} has no index: expected a name, n, n,k or a .spd file", where);
    try {
        return parse_index(text);
    } catch (const Error& error) {
        fail("{}: {}", where, error.what());
    }
}

StackMedium parse_medium(const std::string& part, const std::string& where) {
    const std::size_t colon = part.rfind(':');
    if (colon != part.npos && parse_number(part.substr(colon + 1)))
        fail("{} must not have a thickness: it has no end", where);
    return {part, index_of(part, where)};
}

StackLayer parse_layer(const std::string& part, const std::string& where) {
    const std::size_t colon = part.rfind(':');
    if (colon == part.npos)
        fail("{} has no thickness: expected INDEX:NANOMETRES", where);
    const std::string thickness_text = trimmed(std::string_view(part).substr(colon + 1));
    const std::optional<double> thickness = parse_number(thickness_text);
    if (!thickness)
        fail("{} has the thickness \"{}\", which is no number of nanometres", where, thickness_text);
    if (!std::isfinite(*thickness) || *thickness < 0.0)
        fail("{} has a thickness of {} nm, which must be finite and not negative", where, *thickness);
    if (*thickness > max_layer_thickness_nm)
        fail("{} has a thickness of {} nm; films are computed up to {} nm", where, *thickness, max_layer_thickness_nm);
    const std::string name = trimmed(std::string_view(part).substr(0, colon));
    return {name, index_of(name, where), *thickness};
}

/// Spectra read as 0 outside their range. A constant that is not 0 has no end.
bool covers(const Spectrum& spectrum, double from_nm, double to_nm) {
    const auto [from, to] = spectrum.range_nm();
    if (from <= from_nm && to >= to_nm)
        return true;
    const auto reaches = [&](double lambda) { return spectrum(lambda) == spectrum(lambda_min_nm); };
    return spectrum.is_constant() && reaches(from_nm) && reaches(to_nm);
}

void check_medium(const std::string& name, const ComplexIndex& index, double from_nm, double to_nm) {
    for (const Spectrum* part : {&index.eta, &index.k}) {
        const char* symbol = part == &index.eta ? "n" : "k";
        const auto [from, to] = part->range_nm();
        if (!covers(*part, from_nm, to_nm))
            fail("{} of \"{}\" in the stack is given from {} to {} nm, not over all of {} to {} nm", symbol, name, from,
                 to, from_nm, to_nm);
    }
    if (!(index.eta.minimum(from_nm, to_nm) > 0.0) || !(index.k.minimum(from_nm, to_nm) >= 0.0))
        fail("\"{}\" in the stack has an index outside n > 0 and k >= 0 between {} and {} nm", name, from_nm, to_nm);
}

bool absorbs(const ComplexIndex& index, double from_nm, double to_nm) {
    return index.k.mean(from_nm, to_nm) > 0.0 || index.k(from_nm) > 0.0 || index.k(to_nm) > 0.0;
}

void check_outside(const StackMedium& outside, double from_nm, double to_nm) {
    if (absorbs(outside.index, from_nm, to_nm))
        fail("the first medium \"{}\" of the stack absorbs: the light must come from a medium of k = 0", outside.name);
}

} // namespace

std::string FilmStack::description() const {
    std::string text = outside.name;
    for (const StackLayer& layer : layers)
        text += fmt::format(" | {} {} nm", layer.name, layer.thickness);
    return text + " | " + base.name;
}

FilmStack parse_film_stack(const std::string& text) {
    std::vector<std::string> parts = split(text, '|');
    for (std::string& part : parts)
        part = trimmed(part);
    if (parts.size() < 2)
        fail("the stack \"{}\" has no base: expected OUTSIDE|LAYER:NM|...|BASE, such as air|SiO2:300|Si", text);
    FilmStack stack;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::string where = place(i, parts.size(), parts[i]);
        if (i == 0)
            stack.outside = parse_medium(parts[i], where);
        else if (i + 1 == parts.size())
            stack.base = parse_medium(parts[i], where);
        else
            stack.layers.push_back(parse_layer(parts[i], where));
    }
    check_outside(stack.outside, lambda_min_nm, lambda_max_nm);
    return stack;
}

void check_stack_covers(const FilmStack& stack, double from_nm, double to_nm) {
    check_medium(stack.outside.name, stack.outside.index, from_nm, to_nm);
    check_outside(stack.outside, from_nm, to_nm);
    for (const StackLayer& layer : stack.layers)
        check_medium(layer.name, layer.index, from_nm, to_nm);
    check_medium(stack.base.name, stack.base.index, from_nm, to_nm);
}

bool has_absorbing_layer(const FilmStack& stack, double from_nm, double to_nm) {
    for (const StackLayer& layer : stack.layers) {
        if (absorbs(layer.index, from_nm, to_nm))
            return true;
    }
    return false;
}

} // namespace tristim
