// Still step 1: what of films does not depend on the path, at the pass's wavelengths.
#include "internal_reflectance.h"
#include "loops.h"

// The rows internal_reflectance of the coated diffuse materials. One work-item per block of wavelengths, row, of most_rows for each
// material, and material.
kernel void film_tables(const global SurfaceMaterial* materials, const global SceneFilmLayer* film_layers, int most_rows,
                        global float* pass_table, global uint* counts) {
    const int item = (int)get_global_id(0);
    const int block = item % BLOCKS, row = item / BLOCKS % most_rows;
    const global SurfaceMaterial* material = materials + item / BLOCKS / most_rows;
    if (row >= material->internal_rows)
        return;
    const float thickness = material->internal_thickness + (float)row * material->internal_step;
    const ThinFilm film = {film_layers + material->film, material->film_layers, thickness};
    const floatv n = vloadv(block, spectrum_row(pass_table, material->eta));
    // Many rows share what one may take.
    const int most = max(MOST_QUADRATURE_POINTS * 16 / max(material->internal_rows, 16), QUADRATURE_POINTS);
    const floatv reflectance = internal_reflectance(pass_table, block, &film, n, quadrature_points(&film, most));
    vstorev(reflectance, block, pass_table + (PASS_TABLE_SPECTRA + material->internal_reflectance + row) * W_PADDED);
    count_cut_loops(counts);
}
