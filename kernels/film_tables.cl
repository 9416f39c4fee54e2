// Still step 1: what of films does not depend on the path, at the pass's wavelengths.
#include "internal_reflectance.h"

// The row internal_reflectance of each coated diffuse material whose film is the same everywhere. One work-item per block of
// wavelengths and material.
kernel void film_tables(const global SurfaceMaterial* materials, const global SceneFilmLayer* film_layers,
                        global float* pass_table) {
    const int block = (int)get_global_id(0) % BLOCKS;
    const global SurfaceMaterial* material = materials + get_global_id(0) / BLOCKS;
    if (material->kind != MATERIAL_DIFFUSE || material->film_layers == 0 || material->film_texture >= 0)
        return;
    const ThinFilm film = {film_layers + material->film, material->film_layers, film_layers[material->film].thickness};
    const floatv n = vloadv(block, spectrum_row(pass_table, material->eta));
    const floatv reflectance = internal_reflectance(pass_table, block, &film, n);
    vstorev(reflectance, block, pass_table + (PASS_TABLE_SPECTRA + material->internal_reflectance) * W_PADDED);
}
