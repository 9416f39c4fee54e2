// tristimulus:N: N sets of three, λ = C_ξ⁻¹(u) for ξ = x̄, ȳ, z̄ (Takemura et al., equations 6 to 8). An average over L at
// pdf f_ξ/∫f_ξ estimates ∫L f_ξ/∫f_ξ, so with the 1/k of equations 2 to 4 the weight in channel ξ is ∫f_ξ/(k N), and
// nothing in the other channels (equations 9 to 11). The table holds three CDFs, then their three ∫f_ξ/k.
float sample_wavelength(const Sampler* s, int w, float3* weight) {
    const int channel = w % 3;
    const float share = s->table[3 * CDF_FLOATS + channel] / (float)(W / 3);
    *weight = (float3)(channel == 0 ? share : 0.0f, channel == 1 ? share : 0.0f, channel == 2 ? share : 0.0f);
    float pdf;
    return invert_cdf(s->table + channel * CDF_FLOATS, sample_position(s->seed, s->pass, (uint)(w / 3), W / 3), &pdf);
}
