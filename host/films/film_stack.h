#pragma once

#include "scene/film_limits.h"
#include "spectra/complex_index.h"

#include <string>
#include <vector>

namespace tristim {

/// A medium at one end of a stack.
struct StackMedium {
    std::string name; ///< as the user wrote it
    ComplexIndex index;
};

/// A homogeneous layer.
struct StackLayer {
    std::string name;
    ComplexIndex index;
    double thickness = 0.0; ///< nm
};

/// A thin-film stack as light meets it: the medium that it comes from, layers, base.
struct FilmStack {
    StackMedium outside; ///< k = 0
    std::vector<StackLayer> layers;
    StackMedium base;

    /// "air | SiO2 300 nm | Si"
    std::string description() const;
};

/// A stack from text like "air|SiO2:300|Si": parts between bars, an index for the ends (parse_index()), index and
/// thickness in nm for each layer. Throws Error that names the bad part: fewer than two parts, an index that
/// parse_index() refuses, an absorbing first medium, a missing, negative, non-finite or too large thickness, or a
/// thickness at an end.
FilmStack parse_film_stack(const std::string& text);

/// Throws Error unless every index is given, with n > 0, k >= 0 and k = 0 outside, over [from_nm, to_nm].
void check_stack_covers(const FilmStack& stack, double from_nm, double to_nm);

/// Whether any layer absorbs somewhere in [from_nm, to_nm].
bool has_absorbing_layer(const FilmStack& stack, double from_nm, double to_nm);

} // namespace tristim
