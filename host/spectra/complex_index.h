#pragma once

#include "spectra/spectrum.h"

#include <functional>
#include <string>
#include <vector>

namespace tristim {

/// A complex refractive index eta + ik of fields e^{-iωt}: eta > 0, k >= 0 (absorption) at all visible wavelengths.
struct ComplexIndex {
    Spectrum eta;
    Spectrum k; ///< 0 by default
};

/// The index of a material by its name. Its tables are PREFIX-NAME-eta and PREFIX-NAME-k, or without the latter k = 0;
/// glasses have one table, glass-NAME. The prefix may be left out: "SiO2" is film-SiO2, "Ag" metal-Ag, "BK7" glass-BK7;
/// of equal names the film comes first (film-TiO2 before metal-TiO2). "air" and "vacuum" are 1. The name of a table
/// itself, "metal-Ag-eta", is eta alone with k = 0. Throws Error naming near matches if unknown, and for tables that
/// are not refractive indices.
ComplexIndex named_index(const std::string& name);

/// The materials that named_index() knows, without prefixes, sorted.
std::vector<std::string> named_indices();

/// The tables of a material, {eta, k} or {eta}, by a name that named_index() takes; empty if the name is unknown or
/// stands for no table.
std::vector<std::string> index_tables(const std::string& name);

/// "n" or "n,k", where n and k are numbers or .spd files, or a name for named_index(). `resolve` maps a file's name as
/// written to the path to open; without it the name is the path. Throws Error as named_index(), read_spd() and
/// check_index().
ComplexIndex parse_index(const std::string& text, const std::function<std::string(const std::string&)>& resolve = {});

/// Throws Error unless eta > 0 and k >= 0 are finite in single precision and given over the visible range. `name`
/// stands for the index.
void check_index(const ComplexIndex& index, const std::string& name);

} // namespace tristim
