// mixture:C and illuminant-mixture:C: every wavelength feeds X, Y and Z, with the pdf p ∝ x̄ + ȳ + z̄, or that times the light
// that the scene emits (host/render/sampler_table.h). X + Y + Z of a constant spectrum is then the same in every pass with
// the first; of the light itself with the second, but for the defensive share, at most 1/(1 - defensive_share) of what it is. The
// table holds the CDF.
float sample_wavelength(const Sampler* s, int w, float3* weight) {
    float pdf;
    const float lambda = invert_cdf(s->table, sample_position(s->seed, s->pass, (uint)w, W), &pdf);
    *weight = colour_matching(s, lambda) / (pdf * (float)W);
    return lambda;
}
