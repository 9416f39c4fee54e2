// Step 1: the wavelengths of a pass, their weights in X, Y and Z, and every spectrum of the scene at them. This kernel is
// the only place that knows which method renders; each method is one function in a file of kernels/samplers/.
#include "spectrum.h"
#include "wavelength_sampling.h"

#if SAMPLER == SAMPLER_TRISTIMULUS
#include "samplers/tristimulus.h"
#elif SAMPLER == SAMPLER_SPECTRAL
#include "samplers/spectral.h"
#elif SAMPLER == SAMPLER_RGB
#include "samplers/rgb.h"
#elif SAMPLER == SAMPLER_GAUSS
#include "samplers/gauss.h"
#elif SAMPLER == SAMPLER_UNIFORM
#include "samplers/uniform.h"
#elif SAMPLER == SAMPLER_CLUSTER
#include "samplers/cluster.h"
#elif SAMPLER == SAMPLER_HERO
#include "samplers/hero.h"
#elif SAMPLER == SAMPLER_VISIBLE
#include "samplers/visible.h"
#elif SAMPLER == SAMPLER_MIXTURE
#include "samplers/mixture.h"
#elif SAMPLER == SAMPLER_ILLUMINANT
#include "samplers/illuminant.h"
#endif

// The value of a spectrum given by its means over the bins: as it is for emission, whose lines must keep their energy,
// and linear between the bins' centres for smooth data such as refractive indices.
float bins_at(const global float* bins, int smooth, float lambda) {
    if (!smooth)
        return bins[wavelength_bin(lambda)];
    const float centred = clamp(lambda - LAMBDA_MIN - 0.5f, 0.0f, (float)(LAMBDA_BINS - 1));
    const int bin = min((int)centred, LAMBDA_BINS - 2);
    return mix(bins[bin], bins[bin + 1], centred - (float)bin);
}

// One work-item per wavelength, W_PADDED of them. sampler_table holds the rows of Sampler::matching, then Sampler::table.
// spectra holds a row for each spectrum: LAMBDA_BINS means or, for rgb, three band values. The padding repeats the last wavelength, so
// that nothing in it divides by zero, with weights and emission of zero.
kernel void wavelengths(uint seed, uint pass, const global float* sampler_table, const global float* spectra,
                        const global int* spectrum_is_smooth, int spectrum_count, global float* pass_table) {
    const int item = (int)get_global_id(0);
    const int w = min(item, W - 1);
    const bool used = item < W;
    const Sampler sampling = {seed, pass, sampler_table, sampler_table + 3 * LAMBDA_BINS};
    float3 weight;
    const float lambda = sample_wavelength(&sampling, w, &weight);
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
