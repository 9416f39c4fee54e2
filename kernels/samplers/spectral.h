// spectral:400: one wavelength in each bin of 1 nm, at the same place in all; the weights are those of equations 2 to 4 of
// Takemura et al., (x̄, ȳ, z̄)·1 nm/k.
float sample_wavelength(const Sampler* s, int w, float3* weight) {
    *weight = (float3)(s->matching[w], s->matching[LAMBDA_BINS + w], s->matching[2 * LAMBDA_BINS + w]);
    return LAMBDA_MIN + (float)w + min(unit_float(pass_position(s->seed, s->pass, 0u)), WITHIN_BIN);
}
