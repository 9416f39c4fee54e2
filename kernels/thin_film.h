// Reflectance and transmittance of thin films: stacks of homogeneous layers on a dielectric or a conductor, by the
// characteristic matrix (Abelès 1950; Born & Wolf 1999, section 1.6; Macleod 2010, chapter 2).
//
// Fields go as exp(-iωt), a medium has the index n + ik, and the component of the wave vector along the normal is
// 2π q/λ with q² = (n + ik)² - β² and Im q >= 0, where β = n0 sin θ is the same in every medium. (U, V) are the tangential
// electric and magnetic fields; V = ηU for the wave that goes down, with η = q (s) or (n + ik)²/q (p). A layer of phase
// thickness δ = 2π q d/λ takes them from its bottom to its top:
//     U' = cos δ U - i (sin δ/η) V,    V' = cos δ V - i η sin δ U.
// Only sin δ/q and q sin δ occur, so nothing is 0/0 at a critical angle, where Airy's closed form of the same product for one
// layer would be. Signs and scales common to U and V drop out of the ratio that is the reflectance: phases are reduced by half
// turns, and exp(Im δ) is left out, so that thick evanescent or absorbing layers do not overflow.
//
// Above an opaque layer U' and V' must stand in the ratio η of the wave that grows upwards, even where that wave is hardly excited
// at the bottom (near a guided mode or a surface plasmon). With e = exp(-2 Im δ) and sh = (1 - e)/2, both scaled by exp(-Im δ),
//     cos δ = e cos(Re δ) + g,    sin δ = e sin(Re δ) + i g,    g = sh exp(-i Re δ),
// so that the growing parts of U' and V' come from one and the same sum, V + ηU, and its cancellation harms neither's ratio.
#ifndef TRISTIM_THIN_FILM_H
#define TRISTIM_THIN_FILM_H

#include "multiply_add.h"
#include "sampling.h"
#include "shared_types.h"
#include "spectrum.h"

// A film as a path meets it. Layer i lies above layer i + 1 as seen from outside.
typedef struct ThinFilm {
    const global SceneFilmLayer* layers;
    int count;
    float first_thickness;  // nm: in place of layers[0].thickness, which a texture may vary
} ThinFilm;

// Share of the power that is reflected and transmitted, for a block of wavelengths and each polarisation.
typedef struct FilmOptics {
    floatv reflected_s, reflected_p;
    floatv transmitted_s, transmitted_p;
} FilmOptics;

// high + low, |low| at most half a unit in the last place of high: the phase of a film of 0.1 mm runs through a thousand turns,
// and a float would leave it three decimals.
typedef struct DoubleFloat {
    floatv high, low;
} DoubleFloat;

// a + b + low, where |a + b| need not exceed |b| (Knuth 1997, TAOCP vol. 2, section 4.2.2, theorem B).
DoubleFloat sum_exactly(floatv a, floatv b, floatv low) {
#pragma OPENCL FP_CONTRACT OFF
    const floatv sum = a + b;
    const floatv b_rounded = sum - a;
    const floatv tail = ((a - (sum - b_rounded)) + (b - b_rounded)) + low;
    DoubleFloat result;
    result.high = sum + tail;
    result.low = tail - (result.high - sum);
    return result;
}

// β² = n0² - q0² with q0 = n0 cos θ, of the medium that light comes from.
typedef struct Incidence {
    floatv n;
    DoubleFloat q2, beta2;
} Incidence;

Incidence incidence(floatv n0, floatv cosine) {
#pragma OPENCL FP_CONTRACT OFF
    const floatv square = n0 * n0;
    const floatv q = n0 * cosine, q_low = fused_multiply_add(n0, cosine, -q);
    Incidence first;
    first.n = n0;
    first.q2.high = q * q;
    first.q2.low = fused_multiply_add(q, q, -first.q2.high) + 2.0f * q * q_low;
    first.beta2 = sum_exactly(square, -first.q2.high, fused_multiply_add(n0, n0, -square) - first.q2.low);
    return first;
}

// q² = n² - β² without absorption. Of what equals the first medium it is the very q0², however small.
DoubleFloat normal_squared(floatv n, Incidence first) {
#pragma OPENCL FP_CONTRACT OFF
    const floatv square = n * n;
    DoubleFloat q2 = sum_exactly(square, -first.beta2.high, fused_multiply_add(n, n, -square) - first.beta2.low);
    q2.high = n == first.n ? first.q2.high : q2.high;
    q2.low = n == first.n ? first.q2.low : q2.low;
    return q2;
}

// Re q² = n² - k² - β²
DoubleFloat absorbing_normal_squared(floatv n, floatv k, Incidence first) {
#pragma OPENCL FP_CONTRACT OFF
    const DoubleFloat real = normal_squared(n, first);
    const floatv square = k * k;
    return sum_exactly(real.high, -square, real.low - fused_multiply_add(k, k, -square));
}

// λ in nm and 1/λ.
typedef struct Wavelength {
    floatv lambda, inverse;
} Wavelength;

// Half turns of phase 2 d q/λ, reduced to [-1/2, 1/2]; q must not be negative.
floatv half_turns(float thickness, const Wavelength* wave, floatv q, floatv q_low) {
#pragma OPENCL FP_CONTRACT OFF
    const floatv d = 2.0f * thickness;
    const floatv ratio = d * wave->inverse;
    const floatv ratio_low = fused_multiply_add(-ratio, wave->lambda, d) * wave->inverse;
    const floatv turns = ratio * q;
    const floatv low = fused_multiply_add(ratio, q, -turns) + (ratio * q_low + ratio_low * q);
    return (turns - rint(turns)) + low;
}

// cos and sin of π·x for |x| <= 1/2 and a little more: Taylor's series to the 14th power, right to 1e-8.
floatv cos_half_turns(floatv x) {
    const floatv a = PI * x, a2 = a * a;
    floatv sum = multiply_add(a2, -1.0f / 87178291200.0f, 1.0f / 479001600.0f);
    sum = multiply_add(a2, sum, -1.0f / 3628800.0f);
    sum = multiply_add(a2, sum, 1.0f / 40320.0f);
    sum = multiply_add(a2, sum, -1.0f / 720.0f);
    sum = multiply_add(a2, sum, 1.0f / 24.0f);
    sum = multiply_add(a2, sum, -0.5f);
    return multiply_add(a2, sum, 1.0f);
}
floatv sin_half_turns(floatv x) {
    const floatv a = PI * x, a2 = a * a;
    floatv sum = multiply_add(a2, 1.0f / 6227020800.0f, -1.0f / 39916800.0f);
    sum = multiply_add(a2, sum, 1.0f / 362880.0f);
    sum = multiply_add(a2, sum, -1.0f / 5040.0f);
    sum = multiply_add(a2, sum, 1.0f / 120.0f);
    sum = multiply_add(a2, sum, -1.0f / 6.0f);
    return a * multiply_add(a2, sum, 1.0f);
}

typedef struct ComplexV {
    floatv re, im;
} ComplexV;

ComplexV multiply(ComplexV a, ComplexV b) {
    const ComplexV product = {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
    return product;
}
floatv squared_modulus(ComplexV a) { return a.re * a.re + a.im * a.im; }

#define SMALLEST_Q 1e-10f       // stands for 0, so that sin δ/q has its limit
#define SMALLEST_COSINE 1e-12f  // stands for 0, so that grazing light has its limit

// The square root in the first quadrant; im must not be negative. The smaller part comes from the larger, without cancellation.
ComplexV complex_sqrt(floatv re, floatv im) {
    const floatv larger = max(sqrt(0.5f * (sqrt(re * re + im * im) + fabs(re))), SMALLEST_Q);
    const floatv smaller = 0.5f * im / larger;
    const ComplexV root = {re >= 0.0f ? larger : smaller, re >= 0.0f ? smaller : larger};
    return root;
}

// The fields of one polarisation.
typedef struct Fields {
    ComplexV u, v;
} Fields;

#if HAS_ABSORBING_FILM
ComplexV add(ComplexV a, ComplexV b) {
    const ComplexV sum = {a.re + b.re, a.im + b.im};
    return sum;
}

// c f - i d x + y
ComplexV field_above(floatv c, ComplexV f, floatv d, ComplexV x, ComplexV y) {
    const ComplexV above = {c * f.re + d * x.im + y.re, c * f.im - d * x.re + y.im};
    return above;
}

// Takes the fields of both polarisations through a layer; *decay is multiplied by the squared scale that was left out. Inlined, a
// film takes a quarter less time on PoCL.
__attribute__((always_inline))
void cross_layer(Fields* s, Fields* p, floatv* decay, floatv n, floatv k, Incidence first, float thickness,
                 const Wavelength* wave) {
    const DoubleFloat q2 = absorbing_normal_squared(n, k, first);
    const floatv q2_im = 2.0f * n * k;
    ComplexV q = complex_sqrt(q2.high, q2_im);
    // One step of Newton's method for the real part's low half.
    const floatv residual_re = (fused_multiply_add(-q.re, q.re, q2.high) + q.im * q.im) + q2.low;
    const floatv residual_im = fused_multiply_add(-2.0f * q.re, q.im, q2_im) + 2.0f * fused_multiply_add(n, k, -n * k);
    const floatv inverse = 1.0f / squared_modulus(q);
    const floatv q_low = 0.5f * (residual_re * q.re + residual_im * q.im) * inverse;

    const floatv phase = half_turns(thickness, wave, q.re, q_low);
    const floatv c = cos_half_turns(phase), d = sin_half_turns(phase);
    const floatv exponent = -4.0f * PI * thickness * q.im * wave->inverse;  // -2 Im δ
    const floatv e = exp(exponent), sh = -0.5f * expm1(exponent);           // 1 + expm1 would lose e's digits where it is small
    const floatv ec = e * c, ed = e * d;
    *decay *= e;

    const ComplexV g = {c * sh, -d * sh}, over_q = {q.re * inverse, -q.im * inverse};
    const ComplexV epsilon = {n * n - k * k, q2_im};
    const floatv inverse_epsilon = 1.0f / squared_modulus(epsilon);
    const ComplexV over_epsilon = {epsilon.re * inverse_epsilon, -epsilon.im * inverse_epsilon};
    const ComplexV g_over_q = multiply(g, over_q), g_over_epsilon = multiply(g, over_epsilon);

    const ComplexV q_u = multiply(q, s->u), ws = add(s->v, q_u);
    const Fields s_above = {field_above(ec, s->u, ed, multiply(over_q, s->v), multiply(g_over_q, ws)),
                            field_above(ec, s->v, ed, q_u, multiply(g, ws))};
    const ComplexV q_v = multiply(q, p->v), epsilon_u = multiply(epsilon, p->u), wp = add(q_v, epsilon_u);
    const Fields p_above = {field_above(ec, p->u, ed, multiply(over_epsilon, q_v), multiply(g_over_epsilon, wp)),
                            field_above(ec, p->v, ed, multiply(over_q, epsilon_u), multiply(g_over_q, wp))};
    *s = s_above;
    *p = p_above;
}
#else
// The first where the sign is negative, else the second.
Fields choose(floatv sign, Fields first, Fields second) {
    const Fields chosen = {{sign < 0.0f ? first.u.re : second.u.re, sign < 0.0f ? first.u.im : second.u.im},
                           {sign < 0.0f ? first.v.re : second.v.re, sign < 0.0f ? first.v.im : second.v.im}};
    return chosen;
}

// As above: without absorption cos δ, sin δ/q and q sin δ are real, whether δ is real or imaginary.
Fields through_layer(Fields f, floatv cosine, floatv sine_over_eta, floatv eta_sine) {
    const Fields above = {{cosine * f.u.re + sine_over_eta * f.v.im, cosine * f.u.im - sine_over_eta * f.v.re},
                          {cosine * f.v.re + eta_sine * f.u.im, cosine * f.v.im - eta_sine * f.u.re}};
    return above;
}

__attribute__((always_inline))
void cross_layer(Fields* s, Fields* p, floatv* decay, floatv n, floatv k, Incidence first, float thickness,
                 const Wavelength* wave) {
    const DoubleFloat q2 = normal_squared(n, first);
    const floatv magnitude = fabs(q2.high);
    const floatv q = max(sqrt(magnitude), SMALLEST_Q);
    const floatv epsilon = n * n;
    const floatv inverse = 1.0f / (q * epsilon);
    const floatv q_low = 0.5f * (fused_multiply_add(-q, q, magnitude) + (q2.high < 0.0f ? -q2.low : q2.low)) * epsilon * inverse;
    const floatv phase = half_turns(thickness, wave, q, q_low);
    const floatv cosine = cos_half_turns(phase), sine = sin_half_turns(phase);
    const floatv q_sine = q * sine;
    Fields s_above = through_layer(*s, cosine, sine * epsilon * inverse, q_sine);
    Fields p_above = through_layer(*p, cosine, q_sine * q * inverse, epsilon * epsilon * sine * inverse);
    if (any(q2.high < 0.0f)) {  // q = iκ, and Re δ = 0
        const floatv exponent = -4.0f * PI * thickness * q * wave->inverse;
        const floatv e = exp(exponent), sh = -0.5f * expm1(exponent);  // 1 + expm1 would lose e's digits where it is small
        const floatv sh_over_q = sh * epsilon * inverse, sh_over_epsilon = sh * q * inverse;
        const ComplexV ws = {s->v.re - q * s->u.im, s->v.im + q * s->u.re};
        const ComplexV wp = {epsilon * p->u.re - q * p->v.im, epsilon * p->u.im + q * p->v.re};
        const Fields s_evanescent = {{e * s->u.re + sh_over_q * ws.im, e * s->u.im - sh_over_q * ws.re},
                                     {e * s->v.re + sh * ws.re, e * s->v.im + sh * ws.im}};
        const Fields p_evanescent = {{e * p->u.re + sh_over_epsilon * wp.re, e * p->u.im + sh_over_epsilon * wp.im},
                                     {e * p->v.re + sh_over_q * wp.im, e * p->v.im - sh_over_q * wp.re}};
        s_above = choose(q2.high, s_evanescent, s_above);
        p_above = choose(q2.high, p_evanescent, p_above);
        *decay *= q2.high < 0.0f ? e : (floatv)(1.0f);
    }
    *s = s_above;
    *p = p_above;
}
#endif

#define SMALLEST_POWER 2e-38f  // of fields, so that its inverse is finite

// Both fields by the larger one's size: long stacks would overflow the square below. Fields that are nothing stay so.
void rescale(Fields* f, floatv decay, floatv* transmitted) {
    const floatv largest = max(max(fabs(f->u.re), fabs(f->u.im)), max(fabs(f->v.re), fabs(f->v.im)));
    const floatv scale = 1.0f / max(largest, 1e-12f);
    f->u.re *= scale;
    f->u.im *= scale;
    f->v.re *= scale;
    f->v.im *= scale;
    *transmitted *= decay;
    *transmitted *= scale * scale;
}

// Light of block `block` of the pass's wavelengths that meets the film at an angle of cosine cos_i, from outside, where the index is
// outside_eta, or from the base of index base_eta + i base_k (base_k must then be 0). cos_i may differ between the
// wavelengths.
FilmOptics film_optics(const global float* pass_table, int block, const ThinFilm* film, bool from_outside, floatv cos_i,
                       floatv outside_eta, floatv base_eta, floatv base_k) {
    Wavelength wave;
    wave.lambda = vloadv(block, pass_table);
    wave.inverse = 1.0f / wave.lambda;
    const floatv n0 = from_outside ? outside_eta : base_eta;
    const floatv n = from_outside ? base_eta : outside_eta;
    const floatv cosine = max(cos_i, SMALLEST_COSINE);
    const floatv q0 = n0 * cosine, epsilon0 = n0 * n0;
    const Incidence first = incidence(n0, cosine);

    ComplexV q, epsilon = {n * n, 0.0f};
    if (any(base_k > 0.0f)) {
        epsilon.re -= base_k * base_k;
        epsilon.im = 2.0f * n * base_k;
        q = complex_sqrt(absorbing_normal_squared(n, base_k, first).high, epsilon.im);
    } else {
        const floatv q2 = normal_squared(n, first).high;
        const floatv root = sqrt(fabs(q2));
        q.re = q2 >= 0.0f ? root : 0.0f;
        q.im = q2 >= 0.0f ? 0.0f : root;
    }
    Fields s = {{1.0f, 0.0f}, q}, p = {q, epsilon};
    floatv transmitted_s = 4.0f * q0 * q.re;
    floatv transmitted_p = 4.0f * q0 * epsilon0 * (q.re * epsilon.re + q.im * epsilon.im);

    floatv decay = 1.0f;
    for (int i = 0; i < film->count; ++i) {
        const int layer = from_outside ? film->count - 1 - i : i;
        const global SceneFilmLayer* l = film->layers + layer;
        cross_layer(&s, &p, &decay, vloadv(block, spectrum_row(pass_table, l->eta)),
                    vloadv(block, spectrum_row(pass_table, l->k)), first,
                    layer == 0 ? film->first_thickness : l->thickness, &wave);
        if (i % 8 == 7) {
            rescale(&s, decay, &transmitted_s);
            rescale(&p, decay, &transmitted_p);
            decay = 1.0f;
        }
    }
    const ComplexV s_down = {q0 * s.u.re + s.v.re, q0 * s.u.im + s.v.im};
    const ComplexV s_up = {q0 * s.u.re - s.v.re, q0 * s.u.im - s.v.im};
    const ComplexV p_down = {epsilon0 * p.u.re + q0 * p.v.re, epsilon0 * p.u.im + q0 * p.v.im};
    const ComplexV p_up = {epsilon0 * p.u.re - q0 * p.v.re, epsilon0 * p.u.im - q0 * p.v.im};
    // Where a layer guides light behind an opaque one, the wave that grows upwards may vanish to the last digit, and with it every
    // field above: nothing comes through, and all is reflected.
    const floatv power_s = squared_modulus(s_down), power_p = squared_modulus(p_down);
    const floatv inverse_s = 1.0f / max(power_s, SMALLEST_POWER), inverse_p = 1.0f / max(power_p, SMALLEST_POWER);
    FilmOptics optics;
    optics.reflected_s = power_s < SMALLEST_POWER ? 1.0f : squared_modulus(s_up) * inverse_s;
    optics.reflected_p = power_p < SMALLEST_POWER ? 1.0f : squared_modulus(p_up) * inverse_p;
    optics.transmitted_s = transmitted_s * decay * inverse_s;
    optics.transmitted_p = transmitted_p * decay * inverse_p;
    return optics;
}

#endif
