// film_optics and internal_reflectance as `tristim selftest` asks them. A work-item takes LANES wavelengths of one film, each with
// indices and an angle of its own. films holds, for each item, where its pass table (of BLOCKS = 1) begins in tables, its first layer,
// how many layers it has and whether light comes from outside. A table's spectra are n outside, n and k of the base, the cosine, then
// what the layers refer to.
#include "internal_reflectance.h"

// Not returned by value: when it inlines such a function, Oclgrind's compiler leaves a call that Oclgrind does not know.
void film_of_item(const global int4* films, const global SceneFilmLayer* layers, uint item, ThinFilm* film) {
    film->layers = layers + films[item].y;
    film->count = films[item].z;
    film->first_thickness = film->count > 0 ? film->layers[0].thickness : 0.0f;
}

// Four rows for each item: reflected s and p, transmitted s and p.
kernel void film_shares(uint items, const global int4* films, const global float* tables, const global SceneFilmLayer* layers,
                        global float* results) {
    const uint item = (uint)get_global_id(0);
    if (item >= items)
        return;
    const global float* table = tables + films[item].x;
    ThinFilm film;
    film_of_item(films, layers, item, &film);
    const FilmOptics optics =
        film_optics(table, 0, &film, films[item].w != 0, vloadv(0, spectrum_row(table, 3)), vloadv(0, spectrum_row(table, 0)),
                    vloadv(0, spectrum_row(table, 1)), vloadv(0, spectrum_row(table, 2)));
    global float* result = results + (size_t)item * 4 * LANES;
    vstorev(optics.reflected_s, 0, result);
    vstorev(optics.reflected_p, 1, result);
    vstorev(optics.transmitted_s, 2, result);
    vstorev(optics.transmitted_p, 3, result);
}

// One row for each item: of diffuse light in the base, which must not absorb, under a film in vacuum, by at most so many points.
kernel void film_internal(uint items, const global int4* films, const global float* tables, const global SceneFilmLayer* layers,
                          global float* results, int most_points) {
    const uint item = (uint)get_global_id(0);
    if (item >= items)
        return;
    const global float* table = tables + films[item].x;
    ThinFilm film;
    film_of_item(films, layers, item, &film);
    const floatv n = vloadv(0, spectrum_row(table, 1));
    vstorev(internal_reflectance(table, 0, &film, n, quadrature_points(&film, most_points)), item, results);
}
