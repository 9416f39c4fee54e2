// Step 3: photon paths that carry the fluxes of W wavelengths. Each diffuse surface on the way stores a photon, from the
// path's second hit on, since direct light is sampled at the visible points (from the first with DIRECT_PHOTONS).
#define PATH_SPECTRUM 1
#include "bsdf.h"
#include "lights.h"

// Dimensions of the low-discrepancy sequence over all photons of the render.
#define PHOTON_DIRECTION s01
#define PHOTON_SLOT s2
#define PHOTON_LIGHT s3
#define PHOTON_POSITION s45
#define PHOTON_FIRST_BOUNCE s67

// Where a work-item puts its photons.
typedef struct PhotonStore {
    global Photon* photons;
    global float* spectra;
    uint next, end;
} PhotonStore;

// Stores what a diffuse surface reflects of the photon: flux · reflectance / π. Past the end it only counts; the host then
// makes room and repeats the pass.
void store_photon(const Scene* scene, PhotonStore* store, const Interaction* it, float3 n, int reflectance,
                  const PathWeight* weight) {
    const uint index = store->next++;
    if (index >= store->end)
        return;
    const global float* row = spectrum_row(scene->pass_table, reflectance);
    float3 flux;
    if (weight->slot >= 0) {
        const float reflected = INV_PI * weight->scale * row[weight->slot];
        flux = reflected * slot_weight(scene->pass_table, weight->slot);
    } else {
        Spectrum reflected;
        for (int b = 0; b < BLOCKS; ++b) {
            reflected.block[b] = INV_PI * weight->scale * weight->spectrum.block[b] * vloadv(b, row);
#if STORE_SPECTRAL_FLUX
            vstorev(reflected.block[b], b, store->spectra + (size_t)index * W_PADDED);
#endif
        }
        flux = spectrum_to_xyz(scene->pass_table, &reflected);
    }
    const Photon photon = {it->point.x, it->point.y, it->point.z, pack_normal(n), flux.x, flux.y, flux.z, weight->slot};
    store->photons[index] = photon;
}

// Multiplies by the reflectance and ends the path by Russian roulette in proportion to it, so that the path's flux summed
// over its wavelengths stays the same. Returns whether the path goes on.
bool reflect_diffusely(const Scene* scene, int reflectance, float u, PathWeight* weight) {
    const global float* row = spectrum_row(scene->pass_table, reflectance);
    if (weight->slot >= 0)
        return u < row[weight->slot];
    const float before = spectrum_sum(&weight->spectrum);
    for (int b = 0; b < BLOCKS; ++b)
        weight->spectrum.block[b] *= vloadv(b, row);
    const float survival = spectrum_sum(&weight->spectrum) / before;
    weight->scale /= survival;
    return u < survival;
}

// u is the path's point of the low-discrepancy sequence.
void trace_photon(const Scene* scene, uint seed, uint pass, uint path, float8 u, PhotonStore* store) {
    const int chosen = choose_light(scene, u.PHOTON_LIGHT);
    const global SceneLight* light = scene->lights + chosen;
    const int slot = min((int)(u.PHOTON_SLOT * (float)W), W - 1);

    const Emission emission = sample_emission(scene, light, u.PHOTON_DIRECTION, u.PHOTON_POSITION);
    float3 origin = emission.origin;
    float3 direction = emission.direction;
    PathWeight weight;
    weight.scale = emission.power;
    weight.slot = SLOT_ALL;
    for (int b = 0; b < BLOCKS; ++b)
        weight.spectrum.block[b] = vloadv(b, spectrum_row(scene->pass_table, light->spectrum));

    const uint4 key = pcg4d((uint4)(path, STREAM_PHOTON, pass, seed));
    bool bounced = false;
    for (int depth = 0; depth < MAX_DEPTH; ++depth) {
        const Hit hit = closest_hit(scene, origin, direction);
        if (hit.triangle < 0)
            return;
        const Interaction it = make_interaction(scene, &hit);
        const global SurfaceMaterial* material = scene->materials + it.material;
        const float v = random_step(key.x, (uint)depth);
        if (material->kind == MATERIAL_DIFFUSE) {
            float cosine;
            const float3 n = facing_normal(&it, -direction, &cosine).normal;
            if (depth > 0 || DIRECT_PHOTONS)
                store_photon(scene, store, &it, n, material->reflectance, &weight);
            if (!reflect_diffusely(scene, material->reflectance, v, &weight))
                return;
            const float2 u_bounce = bounced ? (float2)(random_step(key.y, (uint)depth), random_step(key.z, (uint)depth))
                                            : u.PHOTON_FIRST_BOUNCE;
            bounced = true;
            const Frame frame = make_frame(n);
            direction = frame_to_world(&frame, sample_cosine_hemisphere(u_bounce));
        }
#if HAS_DIELECTRIC
        if (material->kind == MATERIAL_DIELECTRIC)
            direction = scatter_dielectric(scene, material, &it, direction, v, slot, false, &weight);
#endif
#if HAS_CONDUCTOR
        if (material->kind == MATERIAL_CONDUCTOR)
            direction = scatter_conductor(scene, material, &it, direction, &weight);
#endif
        origin = leave_surface(&it, direction);
    }
}

// One work-item per PATHS_PER_ITEM paths. It fills photons[item·capacity …] and says in item_counts[item] how many it
// would have stored, which may be more than the capacity, and adds its rays to item_rays[item].
kernel void photon_pass(SCENE_PARAMETERS, uint seed, uint pass, uint paths_per_pass, uint capacity, global Photon* photons,
                        global float* photon_spectra, global uint* item_counts, global uint* item_rays) {
    SCENE_FROM_PARAMETERS;
    const uint item = (uint)get_global_id(0);
    PhotonStore store = {photons, photon_spectra, item * capacity, (item + 1u) * capacity};
    const uint first = item * PATHS_PER_ITEM;
    const uint last = min(first + PATHS_PER_ITEM, paths_per_pass);
    uint8 scramble;
    uint epoch = UINT_MAX;
    for (uint path = first; path < last; ++path) {
        // The sequence runs on over the passes; where its 32-bit index begins anew, the scrambling changes.
        const ulong number = (ulong)pass * paths_per_pass + path;
        if (epoch != (uint)(number >> 32)) {
            epoch = (uint)(number >> 32);
            scramble = (uint8)(pcg4d((uint4)(epoch, STREAM_PHOTON, 0u, seed)), pcg4d((uint4)(epoch, STREAM_PHOTON, 1u, seed)));
        }
        trace_photon(&scene, seed, pass, path, sobol8(sobol_table, (uint)number, scramble), &store);
    }
    item_counts[item] = store.next - item * capacity;
    item_rays[item] += ray_counts.closest;
}
