// What the wavelength samplers of kernels/samplers/ share. A sampler is one function,
//
//   float sample_wavelength(const Sampler* s, int w, float3* weight);
//
// which says where wavelength w of the pass's W lies [nm] and what it weighs in X, Y and Z, so that the mean over the passes of
// Σ_w weight_w L(λ_w) is (1/k) ∫ L(λ) (x̄, ȳ, z̄) dλ with k = ∫ ȳ dλ: for a wavelength of pdf p among n that do the same work,
// (x̄, ȳ, z̄)/(k n p).
#ifndef TRISTIM_WAVELENGTH_SAMPLING_H
#define TRISTIM_WAVELENGTH_SAMPLING_H

#include "rng.h"

#define LAMBDA_MIN 380.0f
#define LAMBDA_MAX 780.0f
#define LAMBDA_BINS 400
#define SOBOL_DEGREE 5u
#define CDF_FLOATS (2 * (LAMBDA_BINS + 1))  // of the table, for each CDF
#define WITHIN_BIN (1.0f - 0x1p-14f)  // the farthest in a bin that does not round up into the next

typedef struct Sampler {
    uint seed, pass;
    const global float* matching;  // three rows of LAMBDA_BINS: x̄/k, ȳ/k and z̄/k [1/nm], means over the bins [380 + i, 381 + i) nm
    const global float* table;     // what host/render/sampler_table.cpp adds for this sampler
} Sampler;

// A number in [0, 1) for a pass, as a binary fraction of 32 digits: with --sequence random a new one for each index, else the
// pass's point of a Sobol' sequence, the same for all, with a random digital shift. Its dimension is the ninth of Joe & Kuo 2008 (of
// the polynomial x⁵ + x³ + 1), behind the eight of the camera paths, with which wavelengths are so stratified too.
uint pass_position(uint seed, uint pass, uint index) {
#if SEQUENCE_RANDOM
    return pcg4d((uint4)(index, STREAM_WAVELENGTHS, pass, seed)).x;
#else
    uint last[SOBOL_DEGREE] = {1u << 31, 1u << 30, 5u << 29, 5u << 28, 5u << 27};  // direction numbers
    uint x = pcg4d((uint4)(0u, STREAM_WAVELENGTHS, 0u, seed)).x;
    for (uint bit = 0u; pass >> bit != 0u && bit < 32u; ++bit) {
        const uint k = bit % SOBOL_DEGREE;
        if (bit >= SOBOL_DEGREE)
            last[k] = last[k] ^ last[k] >> SOBOL_DEGREE ^ last[(k + 3u) % SOBOL_DEGREE];
        x ^= pass >> bit & 1u ? last[k] : 0u;
    }
    return x;
#endif
}

// Sample j of n at equal distances in [0, 1), one position v for all: (j + v)/n, rounded down. As a set this is the rotation of one
// sample in steps of 1/n around [0, 1). Over all v each of the 2^32 values comes up n times, so that no bin gains or loses.
uint rotated_position(uint seed, uint pass, uint j, uint n) {
    return (uint)(((ulong)j << 32 | pass_position(seed, pass, 0u)) / n);
}

// Sample j of n: n independent numbers with --sequence random, else at equal distances.
uint sample_position(uint seed, uint pass, uint j, uint n) {
#if SEQUENCE_RANDOM
    return pass_position(seed, pass, j);
#else
    return rotated_position(seed, pass, j, n);
#endif
}

int wavelength_bin(float lambda) { return clamp((int)(lambda - LAMBDA_MIN), 0, LAMBDA_BINS - 1); }

// (x̄, ȳ, z̄)/k at a wavelength [1/nm].
float3 colour_matching(const Sampler* s, float lambda) {
    const global float* bin = s->matching + wavelength_bin(lambda);
    return (float3)(bin[0], bin[LAMBDA_BINS], bin[2 * LAMBDA_BINS]);
}

// The CDF at a border of bins in units of 2^-31: the table holds the upper digits and the lower eight, since no float holds all.
uint cdf_at(const global float* cdf, int border) { return (uint)cdf[2 * border] << 8 | (uint)cdf[2 * border + 1]; }

// λ at a position on the CDF: bins hold the fraction cdf_at(i + 1) - cdf_at(i), evenly within, which is also the pdf [1/nm] and
// exactly the share of all positions that leads there; with a CDF in float, bins of less than 2^-24 would be left out. λ never
// rounds up into the next bin, whose light may be brighter than that pdf expects by orders of magnitude.
float invert_cdf(const global float* cdf, uint position, float* pdf) {
    const uint u = position >> 1;
    int low = 0, high = LAMBDA_BINS;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (cdf_at(cdf, middle) <= u)
            low = middle;
        else
            high = middle;
    }
    const uint below = cdf_at(cdf, low);
    const float share = (float)(cdf_at(cdf, low + 1) - below);
    *pdf = share * 0x1p-31f;
    return LAMBDA_MIN + (float)low + clamp((float)(u - below) / share, 0.0f, WITHIN_BIN);
}

// λ with the pdf of Radziszewski et al. 2009, near the eye's sensitivity and invertible: p(λ) ∝ 1/cosh²(0.0072 (λ - 538 nm)).
float invert_visible(float u, float* pdf) {
    const float slope = 0.0072f, centre = 538.0f;
    const float first = tanh(slope * (LAMBDA_MIN - centre));
    const float last = tanh(slope * (LAMBDA_MAX - centre));
    const float t = mix(first, last, u);
    *pdf = slope * (1.0f - t * t) / (last - first);
    return clamp(centre + atanh(t) / slope, LAMBDA_MIN, LAMBDA_MAX);
}

#endif
