// cluster:C: C random wavelengths of one path, with the pdf of Radziszewski et al. 2009, "An improved technique for full spectral
// rendering". One of them, the path's slot, steers it where the way depends on the wavelength. Their multiple importance weight
// of wavelength w, p(λ_w) q_w(x)/Σ_v p(λ_v) q_v(x) with q_v(x) the pdf of the path had v steered it, is 1/C each where the way does
// not depend on the wavelength; at smooth dispersive surfaces q is zero but for the steering one, which keeps all C shares.
float sample_wavelength(const Sampler* s, int w, float3* weight) {
    float pdf;
    const float lambda = invert_visible(unit_float(sample_position(s->seed, s->pass, (uint)w, W)), &pdf);
    *weight = colour_matching(s, lambda) / (pdf * (float)W);
    return lambda;
}
