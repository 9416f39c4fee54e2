// a b + c, fused where the device can. Elsewhere (Mesa's rusticl on llvmpipe) fma() is a library routine in integers, hundreds of
// instructions for each lane of a vector, which is inlined wherever it is called: a pass of ours took minutes to compile.
#ifndef TRISTIM_MULTIPLY_ADD_H
#define TRISTIM_MULTIPLY_ADD_H

#include "config.h"

// multiply_add may round once or twice: for speed. fused_multiply_add keeps the product's rounding error, for sums in which the
// product cancels.
#if HAS_FMA
#define multiply_add(a, b, c) fma(a, b, c)
#define fused_multiply_add(a, b, c) fma(a, b, c)
#else
#define multiply_add(a, b, c) ((a) * (b) + (c))

#pragma OPENCL FP_CONTRACT OFF

// The product's error, exactly, from products of halves of 12 bits (Dekker 1971, "A floating-point technique for extending the
// available precision", section 5; the halves here by rounding bits). The sum rounds twice, and once where product and c cancel.
#define DEFINE_FUSED_MULTIPLY_ADD(floats, as_floats, as_uints)                                                   \
    __attribute__((overloadable)) floats fused_multiply_add(floats a, floats b, floats c) {                      \
        const floats a_high = as_floats((as_uints(a) + 0x800u) & 0xfffff000u), a_low = a - a_high;               \
        const floats b_high = as_floats((as_uints(b) + 0x800u) & 0xfffff000u), b_low = b - b_high;               \
        const floats product = a * b;                                                                            \
        const floats error = (((a_high * b_high - product) + a_high * b_low) + a_low * b_high) + a_low * b_low;  \
        return (product + c) + (fabs(error) < INFINITY ? error : 0.0f); /* none where the product is infinite */ \
    }
DEFINE_FUSED_MULTIPLY_ADD(float, as_float, as_uint)
DEFINE_FUSED_MULTIPLY_ADD(float2, as_float2, as_uint2)
DEFINE_FUSED_MULTIPLY_ADD(float3, as_float3, as_uint3)
DEFINE_FUSED_MULTIPLY_ADD(float4, as_float4, as_uint4)
DEFINE_FUSED_MULTIPLY_ADD(float8, as_float8, as_uint8)
DEFINE_FUSED_MULTIPLY_ADD(float16, as_float16, as_uint16)
#endif

#endif
