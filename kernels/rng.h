// Random numbers that depend on nothing but their coordinates: (seed, pass, path, dimension). So a pass can be computed
// alone, again, or on another machine, with the same result.
#ifndef TRISTIM_RNG_H
#define TRISTIM_RNG_H

#include "config.h"

// Streams keep the dimensions of different steps apart.
#define STREAM_WAVELENGTHS 0x10000u
#define STREAM_EYE 0x20000u
#define STREAM_PHOTON 0x30000u

// pcg4d by Jarzynski & Olano 2020, "Hash Functions for GPU Rendering", JCGT 9(3). Its last round leaves the low bits dependent
// between neighbouring inputs; the final line, which is ours, mixes them, since scramblings live by their low bits.
// In scalars: its steps wait for one another, and on CPUs a scalar multiplication takes a third of the time of a vector one.
uint4 pcg4d(uint4 v) {
    uint x = v.x * 1664525u + 1013904223u;
    uint y = v.y * 1664525u + 1013904223u;
    uint z = v.z * 1664525u + 1013904223u;
    uint w = v.w * 1664525u + 1013904223u;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    w ^= w >> 16;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    return (uint4)(x ^ x >> 16, y ^ y >> 16, z ^ z >> 16, w ^ w >> 16);
}

// 24 bits to [0, 1): the largest value is 1 - 2^-24, so that no result rounds up to 1.
float unit_float(uint bits) { return (float)(bits >> 8) * 0x1p-24f; }
float4 unit_float4(uint4 bits) { return convert_float4(bits >> 8) * 0x1p-24f; }

// Four uniform numbers in [0, 1).
float4 random4(uint seed, uint pass, uint path, uint dimension) {
    return unit_float4(pcg4d((uint4)(path, dimension, pass, seed)));
}

// One uniform number in [0, 1) for each step of a path, from a key of the path. Its hash is Wellons 2018's lowbias32 ("Prospecting
// for Hash Functions"), a third of the work of pcg4d, which makes the keys.
float random_step(uint key, uint step) {
    uint x = key + step * 0x9e3779b9u;  // 2^32 / golden ratio
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return unit_float(x ^ x >> 16);
}

// The low 24 bits mirrored at the binary point: bit 0 counts 1/2, bit 23 counts 2^-24. Mirrors the bits of each byte, then adds
// up the bytes as floats, which is exact. (A mirror made of shifts alone becomes llvm.bitreverse, which Oclgrind lacks.)
float8 mirrored_unit_float(uint8 x) {
    x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    const float8 high = convert_float8(as_int8(x & 255u));
    const float8 middle = convert_float8(as_int8(x >> 8 & 255u));
    const float8 low = convert_float8(as_int8(x >> 16 & 255u));
    return high * 0x1p-8f + middle * 0x1p-16f + low * 0x1p-24f;
}

// Point number `index` of the Sobol' sequence in eight dimensions at once, scrambled by Owen's nested permutation in the
// hashed form of Laine & Karras 2011 with the constants of Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4),
// section 3. `table` holds for each byte of the index and value of that byte the xor of direction numbers of the eight
// dimensions, bit-reversed (host/render/sobol.h), since that is the form the permutation works on.
float8 sobol8(const global uint* table, uint index, uint8 scramble) {
    uint8 x = vload8(index & 255u, table) ^ vload8(256u + (index >> 8 & 255u), table) ^
              vload8(512u + (index >> 16 & 255u), table) ^ vload8(768u + (index >> 24), table);
    x += scramble;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return mirrored_unit_float(x);
}

#endif
