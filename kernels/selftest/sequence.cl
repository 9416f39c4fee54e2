// The sequences of a render, for `tristim selftest`.
#include "wavelength_sampling.h"

// Where part parts[i] of `of` lies in a pass.
kernel void positions(uint seed, uint of, const global uint* passes, const global uint* parts, global uint* out) {
    const size_t i = get_global_id(0);
    out[i] = rotated_position(seed, passes[i], parts[i], of);
}

// What passes first, first + 1, … draw: where their wavelengths lie, the point of a photon path as photon_pass.cl takes it, and that
// of a pixel as eye_pass.cl does. 17 numbers each.
kernel void long_run(const global uint* sobol_table, uint seed, uint first, uint paths_per_pass, uint path, uint pixel,
                     global float* out) {
    const size_t i = get_global_id(0);
    const uint pass = first + (uint)i;
    const ulong number = (ulong)pass * paths_per_pass + path;
    const uint epoch = (uint)(number >> 32);
    const uint8 photon = (uint8)(pcg4d((uint4)(epoch, STREAM_PHOTON, 0u, seed)), pcg4d((uint4)(epoch, STREAM_PHOTON, 1u, seed)));
    const uint8 eye = (uint8)(pcg4d((uint4)(pixel, STREAM_EYE, 0u, seed)), pcg4d((uint4)(pixel, STREAM_EYE, 1u, seed)));
    out[17 * i] = unit_float(pass_position(seed, pass, 0u));
    vstore8(sobol8(sobol_table, (uint)number, photon), 0, out + 17 * i + 1);
    vstore8(sobol8(sobol_table, pass, eye), 0, out + 17 * i + 9);
}
