// Reflectance and transmittance of films for `tristim film`, by the function that renders them.
#include "thin_film.h"

// A work-item takes LANES wavelengths of one film; items 0 to chunks - 1 are the first film's, and so on. pass_tables holds a pass
// table of BLOCKS = 1 for each chunk, of table_rows rows, whose spectra are n outside, then n and k of the base, then those of the
// layers. layers holds layer_count layers for each film. results takes four rows for each item: reflected s and p, transmitted s
// and p.
kernel void evaluate_film(uint items, uint chunks, uint table_rows, const global float* pass_tables, int layer_count,
                          const global SceneFilmLayer* layers, float cos_i, global float* results) {
    const uint item = (uint)get_global_id(0);
    if (item >= items)
        return;
    const global float* pass_table = pass_tables + (size_t)(item % chunks) * table_rows * W_PADDED;
    ThinFilm film;
    film.layers = layers + (size_t)(item / chunks) * layer_count;
    film.count = layer_count;
    film.first_thickness = layer_count > 0 ? film.layers[0].thickness : 0.0f;
    const FilmOptics optics = film_optics(pass_table, 0, &film, true, cos_i, vloadv(0, spectrum_row(pass_table, 0)),
                                          vloadv(0, spectrum_row(pass_table, 1)), vloadv(0, spectrum_row(pass_table, 2)));
    global float* result = results + (size_t)item * 4 * LANES;
    vstorev(optics.reflected_s, 0, result);
    vstorev(optics.reflected_p, 1, result);
    vstorev(optics.transmitted_s, 2, result);
    vstorev(optics.transmitted_p, 3, result);
}
