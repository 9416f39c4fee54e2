// hero:C: a uniform hero wavelength and C - 1 rotations of it around the visible range (Wilkie et al. 2014, "Hero wavelength
// spectral sampling"), with their balance heuristic: any of the C may have been the hero, all with the same pdf
// 1/(400 nm), hence 1/C each; at smooth dispersive surfaces the path's slot, its hero, keeps all shares (see cluster.h).
float sample_wavelength(const Sampler* s, int w, float3* weight) {
    const float lambda = mix(LAMBDA_MIN, LAMBDA_MAX, unit_float(rotated_position(s->seed, s->pass, (uint)w, W)));
    *weight = colour_matching(s, lambda) * (LAMBDA_MAX - LAMBDA_MIN) / (float)W;
    return lambda;
}
