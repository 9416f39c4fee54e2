// What a path carries. The file that includes this defines PATH_SPECTRUM (see bsdf.h).
#ifndef TRISTIM_PATH_WEIGHT_H
#define TRISTIM_PATH_WEIGHT_H

#include "spectrum.h"

// The value of a spectrum at the slot that a path keeps.
float spectrum_at(const Spectrum* v, int slot) { return ((const float*)v->block)[slot]; }

// Flux of a photon path or throughput of a camera path: scale · spectrum[w] for every wavelength w while slot is SLOT_ALL,
// and scale for that wavelength alone, nothing for the others, once slot >= 0.
typedef struct PathWeight {
    float scale;
    int slot;
#if PATH_SPECTRUM
    Spectrum spectrum;
#endif
} PathWeight;

// From here on the path is of one wavelength. Chosen with probability 1/W, it stands for all: weight W.
void keep_slot(PathWeight* weight, int slot) {
#if PATH_SPECTRUM
    weight->scale *= spectrum_at(&weight->spectrum, slot);
#endif
    weight->scale *= (float)W;
    weight->slot = slot;
}

#if PATH_SPECTRUM
// Σ_w v_w weight_w / scale over the wavelengths that the path carries.
float carried_sum(const PathWeight* weight, const Spectrum* v) {
    if (is_single(weight->slot))
        return spectrum_at(v, weight->slot);
    floatv sum = 0.0f;
    for (int b = 0; b < BLOCKS; ++b)
        sum += weight->spectrum.block[b] * v->block[b];
    return lanes_sum(sum);
}

float carried_total(const PathWeight* weight) { return is_single(weight->slot) ? 1.0f : spectrum_sum(&weight->spectrum); }

void multiply_weight(PathWeight* weight, const Spectrum* v, float factor) {
    weight->scale *= factor;
    if (is_single(weight->slot)) {
        weight->scale *= spectrum_at(v, weight->slot);
        return;
    }
    for (int b = 0; b < BLOCKS; ++b)
        weight->spectrum.block[b] *= v->block[b];
}
#endif

#endif
