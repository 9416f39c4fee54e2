// Step 1: the wavelengths of a pass, their weights in X, Y and Z, and every spectrum of the scene at them. This kernel is
// the only place that knows which method renders.
//
//   tristimulus:N  N sets of three, λ = C_ξ⁻¹(u) for ξ = x̄, ȳ, z̄ (Takemura et al., equations 6 to 8). An average over L at
//                  pdf f_ξ/∫f_ξ estimates ∫L f_ξ/∫f_ξ, so with the 1/k of equations 2 to 4 the weight in channel ξ is
//                  ∫f_ξ / (k N), and nothing in the other channels (equations 9 to 11).
//   spectral:400   one wavelength in each bin of 1 nm, at the same place in all; weights f_ξ(bin)·1 nm / k.
//   rgb            three bands; the host has integrated the spectra over them (host/render/spectrum_table.h), the weights
//                  are the columns of the matrix from RGB to XYZ. Interference sees each band as one wavelength.
//
// u: the paper draws it afresh for each set; by default set ν of N takes (ν + v)/N with v from the golden-ratio sequence
// over the passes, so that both the sets and the passes are stratified.
#include "rng.h"
#include "spectrum.h"

#define LAMBDA_MIN 380.0f
#define LAMBDA_BINS 400

// Where in [0, 1) pass and set put their sample.
float sample_position(uint seed, uint pass, uint set, uint sets) {
#if SEQUENCE_RANDOM
    return random4(seed, pass, set, STREAM_WAVELENGTHS).x;
#else
    const uint start = pcg4d((uint4)(0u, STREAM_WAVELENGTHS, 0u, seed)).x;
    const float v = unit_float(start + pass * 2654435769u);  // 2^32 / golden ratio
    return min(((float)set + v) / (float)sets, 0x1.fffffep-1f);
#endif
}

// Bins [380 + i, 381 + i) nm hold the fraction cdf[i+1] - cdf[i], evenly within.
float invert_cdf(const global float* cdf, float u) {
    int low = 0, high = LAMBDA_BINS;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (cdf[middle] <= u)
            low = middle;
        else
            high = middle;
    }
    const float within = clamp((u - cdf[low]) / (cdf[low + 1] - cdf[low]), 0.0f, 1.0f);
    return LAMBDA_MIN + (float)low + within;
}

// The value of a spectrum given by its means over the bins: as it is for emission, whose lines must keep their energy,
// and linear between the bins' centres for smooth data such as refractive indices.
float bins_at(const global float* bins, int smooth, float lambda) {
    const float x = lambda - LAMBDA_MIN;
    if (!smooth)
        return bins[clamp((int)x, 0, LAMBDA_BINS - 1)];
    const float centred = clamp(x - 0.5f, 0.0f, (float)(LAMBDA_BINS - 1));
    const int bin = min((int)centred, LAMBDA_BINS - 2);
    return mix(bins[bin], bins[bin + 1], centred - (float)bin);
}

// One work-item per wavelength, W_PADDED of them. sampler_table is, for tristimulus, three CDFs of LAMBDA_BINS + 1 values and
// then their three values of ∫f_ξ/k; for spectral, three rows of f_ξ/k; for rgb, the matrix's three rows and the bands' wavelengths.
// spectra holds a row for each spectrum: LAMBDA_BINS means or three band values. The padding repeats the last wavelength, so that
// nothing in it divides by zero, with weights and emission of zero.
kernel void wavelengths(uint seed, uint pass, const global float* sampler_table, const global float* spectra,
                        const global int* spectrum_is_smooth, int spectrum_count, global float* pass_table) {
    const int item = (int)get_global_id(0);
    const int w = min(item, W - 1);
    const bool used = item < W;
    float lambda;
    float3 weight;
#if SAMPLER == SAMPLER_TRISTIMULUS
    const int channel = w % 3;
    const float u = sample_position(seed, pass, (uint)(w / 3), W / 3);
    lambda = invert_cdf(sampler_table + channel * (LAMBDA_BINS + 1), u);
    const float share = sampler_table[3 * (LAMBDA_BINS + 1) + channel] / (float)(W / 3);
    weight = (float3)(channel == 0 ? share : 0.0f, channel == 1 ? share : 0.0f, channel == 2 ? share : 0.0f);
#elif SAMPLER == SAMPLER_SPECTRAL
    lambda = LAMBDA_MIN + (float)w + sample_position(seed, pass, 0u, 1u);
    weight = (float3)(sampler_table[w], sampler_table[W + w], sampler_table[2 * W + w]);
#else
    lambda = sampler_table[9 + w];
    weight = (float3)(sampler_table[w], sampler_table[3 + w], sampler_table[6 + w]);
#endif
    pass_table[item] = lambda;
    pass_table[W_PADDED + item] = used ? weight.x : 0.0f;
    pass_table[2 * W_PADDED + item] = used ? weight.y : 0.0f;
    pass_table[3 * W_PADDED + item] = used ? weight.z : 0.0f;
    for (int s = 0; s < spectrum_count; ++s) {
        const bool smooth = spectrum_is_smooth[s];
#if SAMPLER == SAMPLER_RGB
        const float value = spectra[3 * s + w];
#else
        const float value = bins_at(spectra + s * LAMBDA_BINS, smooth, lambda);
#endif
        pass_table[(PASS_TABLE_SPECTRA + s) * W_PADDED + item] = used || smooth ? value : 0.0f;
    }
}
