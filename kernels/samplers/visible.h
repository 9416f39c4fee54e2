// visible:C: one sample and C - 1 rotations of it in the CDF of one pdf over the visible range, as pbrt-v4 does by default (Pharr,
// Jakob & Humphreys 2023); the pdf is that of Radziszewski et al. 2009, here over 380 to 780 nm.
float sample_wavelength(const Sampler* s, int w, float3* weight) {
    float pdf;
    const float lambda = invert_visible(unit_float(rotated_position(s->seed, s->pass, (uint)w, W)), &pdf);
    *weight = colour_matching(s, lambda) / (pdf * (float)W);
    return lambda;
}
