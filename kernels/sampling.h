// Maps from the unit square to directions and points, and the encoding of normals.
#ifndef TRISTIM_SAMPLING_H
#define TRISTIM_SAMPLING_H

#include "multiply_add.h"

#define PI 3.14159265358979f
#define INV_PI 0.318309886183791f

// normalize() without its care for vectors whose squared length overflows, of which there are none here.
float3 unit_vector(float3 v) { return v * (1.0f / sqrt(dot(v, v))); }

// An orthonormal basis around a unit vector: Duff et al. 2017, "Building an Orthonormal Basis, Revisited", JCGT 6(1).
typedef struct Frame {
    float3 s, t, n;
} Frame;

Frame make_frame(float3 n) {
    const float sign = copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    Frame frame;
    frame.s = (float3)(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    frame.t = (float3)(b, sign + n.y * n.y * a, -n.y);
    frame.n = n;
    return frame;
}

float3 frame_to_world(const Frame* frame, float3 v) { return v.x * frame->s + v.y * frame->t + v.z * frame->n; }
float3 frame_from_world(const Frame* frame, float3 v) { return (float3)(dot(v, frame->s), dot(v, frame->t), dot(v, frame->n)); }

// (cos, sin) of 2π·turns for turns in [0, 1]. The turn is cut into quarters exactly, and Taylor's series to the ninth power of
// the angle's at most π/4 are right to 3e-8: the library's sincos spends most of its time on large arguments.
float2 cos_sin_turns(float turns) {
    const float quarter = rint(4.0f * turns);
    const float x = 0.5f * PI * (4.0f * turns - quarter);
    const float x2 = x * x;
    float s = multiply_add(x2, 1.0f / 362880.0f, -1.0f / 5040.0f);
    s = multiply_add(x2, s, 1.0f / 120.0f);
    s = multiply_add(x2, s, -1.0f / 6.0f);
    s = x * multiply_add(x2, s, 1.0f);
    float c = multiply_add(x2, 1.0f / 40320.0f, -1.0f / 720.0f);
    c = multiply_add(x2, c, 1.0f / 24.0f);
    c = multiply_add(x2, c, -0.5f);
    c = multiply_add(x2, c, 1.0f);
    const int q = (int)quarter & 3;
    const float2 swapped = (q & 1) ? (float2)(s, c) : (float2)(c, s);
    return (float2)(q == 1 || q == 2 ? -swapped.x : swapped.x, q >= 2 ? -swapped.y : swapped.y);
}

// Uniform on the unit disc, polar.
float2 sample_disc(float2 u) { return sqrt(u.x) * cos_sin_turns(u.y); }

// About +z with pdf cos θ / π.
float3 sample_cosine_hemisphere(float2 u) {
    const float2 d = sample_disc(u);
    return (float3)(d.x, d.y, sqrt(max(0.0f, 1.0f - u.x)));
}

// A direction about +z with a given cosine; u.y turns it.
float3 direction_at_cosine(float cosine, float u) {
    const float sine = sqrt(max(0.0f, (1.0f - cosine) * (1.0f + cosine)));
    return (float3)(sine * cos_sin_turns(u), cosine);
}

float3 sample_sphere(float2 u) { return direction_at_cosine(1.0f - 2.0f * u.x, u.y); }

// Uniform in a triangle: barycentrics of v1 and v2 (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
float2 sample_triangle(float2 u) {
    return u.x < u.y ? (float2)(0.5f * u.x, u.y - 0.5f * u.x) : (float2)(u.x - 0.5f * u.y, 0.5f * u.y);
}

// pbrt's spot light: smoothstep of the cosine between the total width (0) and the start of the falloff (1).
float spot_falloff(float cosine, float cos_total_width, float cos_falloff_start) {
    if (cosine >= cos_falloff_start)
        return 1.0f;
    if (cosine <= cos_total_width)
        return 0.0f;
    const float x = (cosine - cos_total_width) / (cos_falloff_start - cos_total_width);
    return x * x * (3.0f - 2.0f * x);
}

// ∫ falloff dω over all directions, the spot's power at intensity 1: the smoothstep's mean over the cosine is one half.
float spot_solid_angle(float cos_total_width, float cos_falloff_start) {
    return 2.0f * PI * ((1.0f - cos_falloff_start) + 0.5f * (cos_falloff_start - cos_total_width));
}

// The cosine of a spot's photon, distributed in proportion to the falloff. The falloff part inverts the smoothstep's
// integral x³ - x⁴/2 = u/2 by Newton's method; it converges from above, where the function is convex or nearly linear.
float sample_spot_cosine(float u, float cos_total_width, float cos_falloff_start) {
    const float inner = 1.0f - cos_falloff_start;
    const float outer = 0.5f * (cos_falloff_start - cos_total_width);
    const float cut = u * (inner + outer);
    if (cut < inner)
        return 1.0f - cut;
    const float target = 0.5f * min((cut - inner) / outer, 1.0f);
    float x = 1.0f;
    if (target < 0.5f) {
        const float root = sqrt(2.0f * target);
        x = 0.35f * sqrt(root) + 0.9f * root - 0.5f * target; // within a tenth of the root
        for (int i = 0; i < 4; ++i) {
            const float value = x * x * x * (1.0f - 0.5f * x) - target;
            const float slope = x * x * (3.0f - 2.0f * x);
            x = clamp(x - value / max(slope, 1e-8f), 0.0f, 1.0f);
        }
    }
    return cos_total_width + x * (cos_falloff_start - cos_total_width);
}

// Unit vectors in 32 bits by the octahedral map (Cigolle et al. 2014, JCGT 3(2)), 16 bits each: right to 0.004°. The normals of
// photons only have to tell the sides and corners of surfaces.
uint pack_normal(float3 n) {
    const float3 a = fabs(n);
    float2 p = n.xy / (a.x + a.y + a.z);
    if (n.z < 0.0f)
        p = (1.0f - fabs(p.yx)) * copysign((float2)(1.0f), p);
    const int2 q = convert_int2_rte(clamp(p, -1.0f, 1.0f) * 32767.0f);
    return ((uint)q.x & 0xffffu) | (uint)q.y << 16;
}

// Not normalised: its length lies between 1/√3 and 1.
float3 unpack_direction(uint packed) {
    const float2 p = (float2)((float)as_short((ushort)(packed & 0xffffu)), (float)as_short((ushort)(packed >> 16))) *
                     (1.0f / 32767.0f);
    float3 n = (float3)(p.x, p.y, 1.0f - fabs(p.x) - fabs(p.y));
    if (n.z < 0.0f)
        n.xy = (1.0f - fabs(n.yx)) * copysign((float2)(1.0f), n.xy);
    return n;
}

float3 unpack_normal(uint packed) { return unit_vector(unpack_direction(packed)); }

#endif
