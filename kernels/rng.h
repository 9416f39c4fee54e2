// Random numbers that depend on nothing but their coordinates: (seed, pass, path, dimension). So a pass can be computed
// alone, again, or on another machine, with the same result.
#ifndef TRISTIM_RNG_H
#define TRISTIM_RNG_H

#include "config.h"

// Streams keep the dimensions of different steps apart.
#define STREAM_WAVELENGTHS 0x10000u
#define STREAM_EYE 0x20000u
#define STREAM_PHOTON 0x30000u

// pcg4d by Jarzynski & Olano 2020, "Hash Functions for GPU Rendering", JCGT 9(3).
uint4 pcg4d(uint4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// 24 bits to [0, 1): the largest value is 1 - 2^-24, so that no result rounds up to 1.
float unit_float(uint bits) { return (float)(bits >> 8) * 0x1p-24f; }
float4 unit_float4(uint4 bits) { return convert_float4(bits >> 8) * 0x1p-24f; }

// Four uniform numbers in [0, 1).
float4 random4(uint seed, uint pass, uint path, uint dimension) {
    return unit_float4(pcg4d((uint4)(path, dimension, pass, seed)));
}

uint reverse_bits(uint x) {
    x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    x = (x >> 8 & 0x00ff00ffu) | (x & 0x00ff00ffu) << 8;
    return x >> 16 | x << 16;
}

// Sobol' points, scrambled by Owen's nested permutation in the hashed form of Laine & Karras 2011 with the constants of
// Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4), section 3. `table` holds for each dimension, byte of the
// index and value of that byte the xor of direction numbers, bit-reversed (host/render/sobol.h), since that is the form
// the permutation works on.
#define SOBOL_DIMENSIONS 8
float sobol(const global uint* table, uint index, uint dimension, uint scramble) {
    const global uint* bytes = table + dimension * 1024u;
    uint x = bytes[index & 255u] ^ bytes[256u + (index >> 8 & 255u)] ^ bytes[512u + (index >> 16 & 255u)] ^
             bytes[768u + (index >> 24)];
    x += scramble;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return unit_float(reverse_bits(x));
}

#endif
