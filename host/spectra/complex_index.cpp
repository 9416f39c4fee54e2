#include "spectra/complex_index.h"

#include "base/error.h"
#include "base/parse_number.h"
#include "spectra/near_matches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

namespace tristim {

namespace {

constexpr std::array<std::string_view, 3> prefixes{"film-", "metal-", "glass-"};
constexpr std::string_view eta_suffix = "-eta";
constexpr std::string_view k_suffix = "-k";

bool is_table(const std::string& name) {
    const std::vector<std::string> names = named_spectra();
    return std::binary_search(names.begin(), names.end(), name);
}

bool is_index_table(const std::string& name) {
    return std::any_of(prefixes.begin(), prefixes.end(), [&](auto prefix) { return name.starts_with(prefix); });
}

/// The tables {eta, k} or {eta} of a material by its name with its prefix.
std::vector<std::string> tables_of(const std::string& material) {
    if (!is_index_table(material))
        return {};
    if (is_table(material))
        return {material};
    std::vector<std::string> tables;
    for (const std::string_view suffix : {eta_suffix, k_suffix}) {
        std::string table = material + std::string(suffix);
        if (is_table(table))
            tables.push_back(std::move(table));
    }
    return tables;
}

std::string without_prefix_and_suffix(std::string name) {
    for (const std::string_view prefix : prefixes) {
        if (name.starts_with(prefix))
            name.erase(0, prefix.size());
    }
    for (const std::string_view suffix : {eta_suffix, k_suffix}) {
        if (name.ends_with(suffix))
            name.erase(name.size() - suffix.size());
    }
    return name;
}

/// A number or a .spd file.
std::optional<Spectrum> parse_part(const std::string& text,
                                   const std::function<std::string(const std::string&)>& resolve) {
    if (const std::optional<double> value = parse_number(text))
        return Spectrum::constant(*value);
    if (text.ends_with(".spd"))
        return Spectrum::read_spd(resolve ? resolve(text) : text);
    return std::nullopt;
}

void check_part(const Spectrum& spectrum, const std::string& part, const std::string& name) {
    const auto [from, to] = spectrum.range_nm();
    if (from > lambda_min_nm || to < lambda_max_nm)
        fail("{} of the refractive index {} covers {} to {} nm, not the whole visible range from {} to {} nm", part,
             name, from, to, lambda_min_nm, lambda_max_nm);
}

} // namespace

std::vector<std::string> index_tables(const std::string& name) {
    std::vector<std::string> tables = tables_of(name);
    for (std::size_t i = 0; i < prefixes.size() && tables.empty(); ++i)
        tables = tables_of(std::string(prefixes[i]) + name);
    return tables;
}

ComplexIndex named_index(const std::string& name) {
    if (name == "air" || name == "vacuum")
        return {Spectrum::constant(1.0), {}};
    const std::vector<std::string> tables = index_tables(name);
    if (name.ends_with(k_suffix) && !tables.empty())
        fail("the spectrum \"{}\" is the imaginary part of a refractive index; the whole index is \"{}\"", name,
             without_prefix_and_suffix(name));
    if (tables.empty() && is_table(name))
        fail("the spectrum \"{}\" is not a refractive index", name);
    if (tables.empty())
        fail("unknown refractive index \"{}\"; did you mean {}?", name, near_matches(name, named_indices()));
    return {Spectrum::named(tables.front()), tables.size() > 1 ? Spectrum::named(tables.back()) : Spectrum{}};
}

std::vector<std::string> named_indices() {
    std::set<std::string> names{"air", "vacuum"};
    for (const std::string& table : named_spectra()) {
        if (is_index_table(table))
            names.insert(without_prefix_and_suffix(table));
    }
    return {names.begin(), names.end()};
}

ComplexIndex parse_index(const std::string& text, const std::function<std::string(const std::string&)>& resolve) {
    ComplexIndex index;
    const std::size_t comma = text.find(',');
    const std::optional<Spectrum> first =
        comma == text.npos ? std::nullopt : parse_part(text.substr(0, comma), resolve);
    if (first) {
        const std::optional<Spectrum> second = parse_part(text.substr(comma + 1), resolve);
        if (!second)
            fail("k of the refractive index \"{}\" must be a number or a .spd file", text);
        index = {*first, *second};
    } else if (const std::optional<Spectrum> only = parse_part(text, resolve)) {
        index.eta = *only;
    } else {
        return named_index(text);
    }
    check_index(index, fmt::format("\"{}\"", text));
    return index;
}

void check_index(const ComplexIndex& index, const std::string& name) {
    check_part(index.eta, "n", name);
    check_part(index.k, "k", name);
    const double eta = index.eta.minimum(lambda_min_nm, lambda_max_nm);
    if (!(eta > 0.0) || !std::isfinite(static_cast<float>(eta)))
        fail("n of the refractive index {} must be positive and finite, not {}", name, eta);
    const double k = index.k.minimum(lambda_min_nm, lambda_max_nm);
    if (!(k >= 0.0) || !std::isfinite(static_cast<float>(k)))
        fail("k of the refractive index {} must be finite and not negative, not {}", name, k);
}

} // namespace tristim
