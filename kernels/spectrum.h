// Vectors over the wavelengths of a pass, and the pass's table of spectra.
#ifndef TRISTIM_SPECTRUM_H
#define TRISTIM_SPECTRUM_H

#include "config.h"
#include "shared_types.h"

#define CONCATENATE_(a, b) a##b
#define CONCATENATE(a, b) CONCATENATE_(a, b)
#define floatv CONCATENATE(float, LANES)
#define vloadv CONCATENATE(vload, LANES)
#define vstorev CONCATENATE(vstore, LANES)

// One value per wavelength of the pass.
typedef struct Spectrum {
    floatv block[BLOCKS];
} Spectrum;

#if LANES == 4
float lanes_sum(floatv v) { return (v.x + v.y) + (v.z + v.w); }
#elif LANES == 8
float lanes_sum(floatv v) {
    const float4 a = v.lo + v.hi;
    return (a.x + a.y) + (a.z + a.w);
}
#else
float lanes_sum(floatv v) {
    const float8 a = v.lo + v.hi;
    const float4 b = a.lo + a.hi;
    return (b.x + b.y) + (b.z + b.w);
}
#endif

const global float* spectrum_row(const global float* pass_table, int spectrum) {
    return pass_table + (PASS_TABLE_SPECTRA + spectrum) * W_PADDED;
}

// Whether what has this slot is of that one wavelength. Without dispersion nothing is.
bool is_single(int slot) { return HAS_DISPERSION && slot >= 0; }

// The blocks of wavelengths that something with this slot needs, the second excluded.
int first_block(int slot) { return is_single(slot) ? slot / LANES : 0; }
int last_block(int slot) { return is_single(slot) ? slot / LANES + 1 : BLOCKS; }

float3 slot_weight(const global float* pass_table, int slot) {
    return (float3)(pass_table[W_PADDED + slot], pass_table[2 * W_PADDED + slot], pass_table[3 * W_PADDED + slot]);
}

// Σ_w c_w v_w
float3 spectrum_to_xyz(const global float* pass_table, const Spectrum* v) {
    floatv x = 0.0f, y = 0.0f, z = 0.0f;
    for (int b = 0; b < BLOCKS; ++b) {
        x += vloadv(b, pass_table + W_PADDED) * v->block[b];
        y += vloadv(b, pass_table + 2 * W_PADDED) * v->block[b];
        z += vloadv(b, pass_table + 3 * W_PADDED) * v->block[b];
    }
    return (float3)(lanes_sum(x), lanes_sum(y), lanes_sum(z));
}

float spectrum_sum(const Spectrum* v) {
    floatv sum = v->block[0];
    for (int b = 1; b < BLOCKS; ++b)
        sum += v->block[b];
    return lanes_sum(sum);
}

#endif
