#include "scene/films.h"

#include "base/parse_number.h"
#include "scene/film_limits.h"
#include "spectra/complex_index.h"

#include <algorithm>

namespace tristim {

namespace {

/// The thicknesses of all layers; 0 for one with a texture, whose index goes to `texture`.
std::vector<double> thicknesses(ParameterList& parameters, TextureTable& textures, int& texture) {
    const char* const name = "filmthickness";
    const SourceLocation where = parameters.where(name);
    std::vector<double> values;
    const std::string texture_name = parameters.texture(name);
    if (texture_name.empty()) {
        values = parameters.numbers(name);
    } else {
        const FloatTexture& found = textures.find(texture_name, where);
        values.push_back(found.value);
        if (found.pattern) {
            for (const double value : value_range(*found.pattern)) {
                if (value < 0.0 || value > max_layer_thickness_nm)
                    fail_at(where,
                            "the film thickness cannot be the texture \"{}\", which is {} somewhere: films are 0 to {} "
                            "nm thick",
                            texture_name, value, max_layer_thickness_nm);
            }
            texture = textures.use(found);
        }
    }
    if (values.empty())
        fail_at(where, "\"{}\" of {} holds no thickness", name, parameters.owner());
    for (const double value : values) {
        if (value < 0.0 || value > max_layer_thickness_nm)
            fail_at(where, "the film thickness {} nm in \"{}\" must be from 0 to {} nm", value, name,
                    max_layer_thickness_nm);
    }
    return values;
}

void check_length(const ParameterList& parameters, const char* name, std::size_t given, std::size_t layers) {
    if (given > 1 && parameters.is_type("filmthickness", "texture"))
        fail_at(parameters.where(name), "\"{}\" has {} layers, but a texture can only be the thickness of one", name,
                given);
    if (given != layers)
        fail_at(parameters.where(name), "\"{}\" has {} value{}, but \"filmthickness\" has {}", name, given,
                given == 1 ? "" : "s", layers);
}

std::vector<Spectrum> number_indices(ParameterList& parameters, const char* name, bool may_be_zero) {
    std::vector<Spectrum> result;
    for (const double value : parameters.numbers(name)) {
        if (value < 0.0 || (value == 0.0 && !may_be_zero))
            fail_at(parameters.where(name), "\"{}\" is {}, but it must be {}", name, value,
                    may_be_zero ? "at least 0" : "positive");
        result.push_back(Spectrum::constant(value));
    }
    return result;
}

/// k from a number, a .spd file, a spectrum's name or a material's name.
Spectrum absorption(const std::string& text, const SourceLocation& where, const PathResolver& resolve) {
    if (const std::optional<double> number = parse_number(text))
        return Spectrum::constant(*number);
    if (is_spectrum_file(text))
        return Spectrum::read_spd(resolve(text, where));
    const std::vector<std::string> spectra = named_spectra();
    return std::binary_search(spectra.begin(), spectra.end(), text) ? Spectrum::named(text) : named_index(text).k;
}

void set_eta(std::vector<FilmLayer>& layers, ParameterList& parameters, const PathResolver& resolve) {
    const char* const name = "filmeta";
    const SourceLocation where = parameters.where(name);
    std::vector<ComplexIndex> indices;
    if (parameters.is_type(name, "string")) {
        const auto path = [&](const std::string& file) { return resolve(file, where); };
        for (const std::string& text : parameters.texts(name))
            indices.push_back(with_location(where, [&] { return parse_index(text, path); }));
    } else if (parameters.is_type(name, "float")) {
        for (const Spectrum& eta : number_indices(parameters, name, false))
            indices.push_back({eta, Spectrum::constant(0.0)});
    } else if (const auto eta = index_parameter(parameters, name, false, resolve)) {
        indices.push_back({*eta, Spectrum::constant(0.0)});
    }
    check_length(parameters, name, indices.size(), layers.size());
    for (std::size_t i = 0; i < layers.size(); ++i) {
        layers[i].eta = indices[i].eta;
        layers[i].k = indices[i].k;
    }
}

void set_k(std::vector<FilmLayer>& layers, ParameterList& parameters, const PathResolver& resolve) {
    const char* const name = "filmk";
    if (!parameters.has(name))
        return;
    const SourceLocation where = parameters.where(name);
    std::vector<Spectrum> values;
    if (parameters.is_type(name, "string")) {
        for (const std::string& text : parameters.texts(name)) {
            values.push_back(with_location(where, [&] { return absorption(text, where, resolve); }));
            check_index(values.back(), text, true, where);
        }
    } else if (parameters.is_type(name, "float")) {
        values = number_indices(parameters, name, true);
    } else if (const auto k = index_parameter(parameters, name, true, resolve)) {
        values.push_back(*k);
    }
    check_length(parameters, name, values.size(), layers.size());
    for (std::size_t i = 0; i < layers.size(); ++i)
        layers[i].k = values[i];
}

} // namespace

Film film_parameters(ParameterList& parameters, const PathResolver& resolve, TextureTable& textures) {
    Film film;
    const bool has_thickness = parameters.has("filmthickness");
    if (!has_thickness && !parameters.has("filmeta") && !parameters.has("filmk"))
        return film;
    for (const char* name : {"filmthickness", "filmeta"}) {
        if (!parameters.has(name))
            fail_at(parameters.where(), "{} has a film, but no \"{}\" for it", parameters.owner(), name);
    }
    for (const double thickness : thicknesses(parameters, textures, film.thickness_texture))
        film.layers.emplace_back().thickness = thickness;
    set_eta(film.layers, parameters, resolve);
    set_k(film.layers, parameters, resolve);
    return film;
}

} // namespace tristim
