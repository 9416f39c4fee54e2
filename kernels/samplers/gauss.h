// gauss:C: the same C wavelengths in every pass, from Gaussian quadrature in an opponent colour space (Meyer 1988, "Wavelength
// selection for synthetic image generation"; host/spectra/gauss_rule.h). Biased: what lies between them is never seen. The table
// holds C wavelengths, then their weights in X, in Y and in Z.
float sample_wavelength(const Sampler* s, int w, float3* weight) {
    *weight = (float3)(s->table[W + w], s->table[2 * W + w], s->table[3 * W + w]);
    return s->table[w];
}
