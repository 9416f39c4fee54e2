// rgb: three bands; the host has integrated the spectra over them (host/render/spectrum_table.h), the weights are the columns
// of the matrix from RGB to XYZ. Interference sees each band as one wavelength. The table holds the matrix's three rows, then the
// bands' wavelengths.
float sample_wavelength(const Sampler* s, int w, float3* weight) {
    *weight = (float3)(s->table[w], s->table[3 + w], s->table[6 + w]);
    return s->table[9 + w];
}
