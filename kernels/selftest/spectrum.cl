// The wavelength samplers and what they read of spectra, for `tristim selftest`: every sampler of which a wavelength is a function
// of a position in [0, 1), in one program.
#include "spectrum.h"
#include "wavelength_sampling.h"
#define sample_wavelength sample_uniform
#include "samplers/uniform.h"
#undef sample_wavelength
#define sample_wavelength sample_cluster
#include "samplers/cluster.h"
#undef sample_wavelength
#define sample_wavelength sample_hero
#include "samplers/hero.h"
#undef sample_wavelength
#define sample_wavelength sample_visible
#include "samplers/visible.h"
#undef sample_wavelength
#define sample_wavelength sample_mixture
#include "samplers/mixture.h"
#undef sample_wavelength
#define sample_wavelength sample_illuminant
#include "samplers/illuminant.h"
#undef sample_wavelength
#define sample_wavelength sample_tristimulus
#include "samplers/tristimulus.h"
#include "wavelengths.cl"

// λ and the weights in X, Y and Z of wavelength slots[i] of pass passes[i]; the kernel's name ends as the value of SAMPLER with which
// the renderer builds the sampler.
#define SAMPLE_KERNEL(name, function) \
    kernel void sample_by_##name(uint seed, const global float* sampler_table, const global uint* passes, const global int* slots, \
                                 global float* samples) { \
        const size_t i = get_global_id(0); \
        const Sampler s = {seed, passes[i], sampler_table, sampler_table + 3 * LAMBDA_BINS}; \
        float3 weight; \
        const float lambda = function(&s, slots[i], &weight); \
        vstore4((float4)(lambda, weight), i, samples); \
    }

SAMPLE_KERNEL(SAMPLER_UNIFORM, sample_uniform)
SAMPLE_KERNEL(SAMPLER_CLUSTER, sample_cluster)
SAMPLE_KERNEL(SAMPLER_HERO, sample_hero)
SAMPLE_KERNEL(SAMPLER_VISIBLE, sample_visible)
SAMPLE_KERNEL(SAMPLER_MIXTURE, sample_mixture)
SAMPLE_KERNEL(SAMPLER_ILLUMINANT, sample_illuminant)
SAMPLE_KERNEL(SAMPLER_TRISTIMULUS, sample_tristimulus)

// A table of means over the bins at a wavelength, taken as emission and as smooth data.
kernel void read_bins(const global float* bins, const global float* lambdas, global float* values) {
    const size_t i = get_global_id(0);
    vstore2((float2)(bins_at(bins, 0, lambdas[i]), bins_at(bins, 1, lambdas[i])), i, values);
}
