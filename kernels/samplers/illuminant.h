// illuminant:N: N sets of three as tristimulus:N, with pdfs p_ξ ∝ f_ξ S for ξ = x̄, ȳ, z̄ and S the light that the scene emits
// (host/render/sampler_table.h), so that what is left to vary is what surfaces do to it; weights f_ξ/(k N p_ξ). Compare Peters
// 2025, "Spectral rendering, part 2". The table holds three CDFs.
float sample_wavelength(const Sampler* s, int w, float3* weight) {
    const int channel = w % 3;
    float pdf;
    const uint u = sample_position(s->seed, s->pass, (uint)(w / 3), W / 3);
    const float lambda = invert_cdf(s->table + channel * CDF_FLOATS, u, &pdf);
    const float3 f = colour_matching(s, lambda) / (pdf * (float)(W / 3));
    *weight = (float3)(channel == 0 ? f.x : 0.0f, channel == 1 ? f.y : 0.0f, channel == 2 ? f.z : 0.0f);
    return lambda;
}
