// uniform:C: C wavelengths anywhere in the visible range, the baseline: p = 1/(400 nm).
float sample_wavelength(const Sampler* s, int w, float3* weight) {
    const float u = unit_float(sample_position(s->seed, s->pass, (uint)w, W));
    const float lambda = mix(LAMBDA_MIN, LAMBDA_MAX, u);
    *weight = colour_matching(s, lambda) * (LAMBDA_MAX - LAMBDA_MIN) / (float)W;
    return lambda;
}
