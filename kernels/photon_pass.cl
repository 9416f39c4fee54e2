// Step 3: photon paths that carry the fluxes of W wavelengths. Each diffuse or rough enough surface on the way stores a photon,
// from the path's second hit on, since direct light is sampled at the visible points (from the first with DIRECT_PHOTONS).
#define PATH_SPECTRUM 1
#include "bsdf.h"
#include "finite.h"
#include "lights.h"
#include "loops.h"

// Dimensions of the low-discrepancy sequence over all photons of the render.
#define PHOTON_DIRECTION s01
#define PHOTON_SLOT s2
#define PHOTON_LIGHT s3
#define PHOTON_POSITION s45
#define PHOTON_FIRST_BOUNCE s67

// Where a work-item puts its photons.
typedef struct PhotonStore {
    global Photon* photons;
    global PhotonSurface* surfaces;
    global float* spectra;
    uint next, end;
    uint non_finite;  // photons and paths that were left out for it
} PhotonStore;

// Stores a photon that arrived along `direction`; flux times `factor` is what a visible point is to add up, and
// `side` where it lies: see the structs. Past the end it only counts; the host then makes room and repeats the pass. A photon that
// is not finite is left out, since it would cost every pixel around it what they gather.
void store_photon(const Scene* scene, PhotonStore* store, const Interaction* it, float3 n, float3 direction, int side,
                  const PathWeight* flux, float factor) {
    const uint index = store->next;
    const bool has_room = index < store->end;
    const float scale = flux->scale * factor;
    float3 xyz;
    if (is_single(flux->slot)) {
        xyz = scale * slot_weight(scene->pass_table, flux->slot);
    } else {
        Spectrum scaled;
        for (int b = 0; b < BLOCKS; ++b) {
            scaled.block[b] = scale * flux->spectrum.block[b];
#if STORE_SPECTRAL_FLUX
            if (has_room)
                vstorev(scaled.block[b], b, store->spectra + (size_t)index * W_PADDED);
#endif
        }
        xyz = spectrum_to_xyz(scene->pass_table, &scaled);
    }
    if (!is_finite3(xyz) || !is_finite3(it->point)) {
        ++store->non_finite;
        return;
    }
    ++store->next;
    if (!has_room)
        return;
    const Photon photon = {it->point.x, it->point.y, it->point.z, pack_normal(n), xyz.x, xyz.y, xyz.z, flux->slot};
    store->photons[index] = photon;
#if HAS_ROUGH_PHOTONS
    const PhotonSurface surface = {side, pack_normal(-direction)};
    store->surfaces[index] = surface;
#endif
}

// The path's weight as a diffuse surface reflects it, π times the BRDF; `coat` is what a film on it transmits of the path.
PathWeight reflected_diffusely(const Scene* scene, const global SurfaceMaterial* material, float thickness, const Spectrum* coat,
                               const PathWeight* weight) {
    PathWeight reflected = *weight;
#if HAS_COATED_DIFFUSE
    if (material->film_layers > 0) {
        const Spectrum body = body_reflectance(scene, material, thickness, weight->slot);
        multiply_weight(&reflected, &body, 1.0f);
        multiply_weight(&reflected, coat, 1.0f);
        return reflected;
    }
#endif
    const global float* row = spectrum_row(scene->pass_table, material->reflectance);
    if (is_single(weight->slot)) {
        reflected.scale *= row[weight->slot];
    } else {
        for (int b = 0; b < BLOCKS; ++b)
            reflected.spectrum.block[b] *= vloadv(b, row);
    }
    return reflected;
}

// A photon path on its way.
typedef struct PhotonPath {
    float3 origin, direction;
    PathWeight weight;
    uint4 key;            // of its random numbers
    float2 first_bounce;  // its low-discrepancy numbers for the first direction that is drawn
    bool bounced;         // that one has been drawn
} PhotonPath;

// Whether what the path carries and where it goes are finite.
bool path_is_finite(const PhotonPath* path) {
    return is_finite(path->weight.scale) && is_finite(carried_total(&path->weight)) && is_finite3(path->direction) &&
           is_finite3(path->origin);
}

float2 direction_numbers(const PhotonPath* path, uint depth) {
    return path->bounced ? (float2)(random_step(path->key.y, depth), random_step(path->key.z, depth)) : path->first_bounce;
}

// At a diffuse surface: stores a photon if it is to, and ends the path by Russian roulette in proportion to what is reflected, so
// that the path's flux summed over its wavelengths stays the same. Returns whether the path goes on.
__attribute__((always_inline))
bool meet_diffuse(const Scene* scene, const global SurfaceMaterial* material, const Interaction* it, bool store_it, uint depth,
                  PhotonPath* path, PhotonStore* store) {
    const float u = random_step(path->key.x, depth);
    float cosine;
    const Facing facing = facing_normal(it, -path->direction, &cosine);
    const float3 n = facing.normal;
    const float before = carried_total(&path->weight);
    float mirrored = 0.0f;  // share of the flux that a film reflects
    float thickness = 0.0f;
    const Spectrum* coat = 0;
#if HAS_COATED_DIFFUSE
    InterfaceOptics optics;
    if (material->film_layers > 0) {
        thickness = film_thickness(scene, material, it);
        optics = interface_optics(scene, material, thickness, true, cosine, path->weight.slot);
        mirrored = carried_sum(&path->weight, &optics.reflected) / before;
        coat = &optics.transmitted;
    }
#endif
    PathWeight reflected = reflected_diffusely(scene, material, thickness, coat, &path->weight);
    const float remaining = carried_total(&reflected);
    if (!is_finite(remaining) || !is_finite(reflected.scale) || (before > 0.0f && !is_finite(mirrored))) {
        ++store->non_finite;
        return false;
    }
    if (store_it)
        store_photon(scene, store, it, n, path->direction, -1, &reflected, INV_PI);
#if HAS_COATED_DIFFUSE
    if (u < mirrored) {
        multiply_weight(&path->weight, &optics.reflected, 1.0f / mirrored);
        path->direction = mirror(it, facing, cosine, path->direction);
        return true;
    }
#endif
    // With a film this may exceed what is left beside `mirrored`; the weight then makes up for it.
    const float after = remaining / before * (reflected.scale / path->weight.scale);
    const float survival = min(after, 1.0f - mirrored);
    if (!(u < mirrored + survival))
        return false;
    const Frame frame = make_frame(n);
    const float3 sampled = sample_cosine_hemisphere(direction_numbers(path, depth));
    path->bounced = true;
    path->direction = frame_to_world(&frame, sampled);
    path->weight = reflected;
    path->weight.scale /= survival;
#if HAS_COATED_DIFFUSE
    if (material->film_layers > 0) {
        const Spectrum out = coat_transmittance(scene, material, thickness, sampled.z, path->weight.slot);
        multiply_weight(&path->weight, &out, 1.0f);
    }
#endif
    return true;
}

// u is the path's point of the low-discrepancy sequence.
void trace_photon(const Scene* scene, uint seed, uint pass, uint path_number, float8 u, PhotonStore* store) {
    const int chosen = choose_light(scene, u.PHOTON_LIGHT);
    const global SceneLight* light = scene->lights + chosen;
    const int slot = min((int)(u.PHOTON_SLOT * (float)W), W - 1);

    const Emission emission = sample_emission(scene, light, u.PHOTON_DIRECTION, u.PHOTON_POSITION);
    PhotonPath path;
    path.origin = emission.origin;
    path.direction = emission.direction;
    path.key = pcg4d((uint4)(path_number, STREAM_PHOTON, pass, seed));
    path.first_bounce = u.PHOTON_FIRST_BOUNCE;
    path.bounced = false;
    path.weight.scale = emission.power;
    path.weight.slot = SLOT_ALL;
    for (int b = 0; b < BLOCKS; ++b)
        path.weight.spectrum.block[b] = vloadv(b, spectrum_row(scene->pass_table, light->spectrum));
    if (carried_total(&path.weight) <= 0.0f)
        return;  // all of the pass's wavelengths lie between the light's lines

    for (int depth = 0; depth < MAX_DEPTH; ++depth) {
        const Hit hit = closest_hit(scene, path.origin, path.direction);
        if (hit.triangle < 0)
            break;
        const Interaction it = make_interaction(scene, &hit);
        const global SurfaceMaterial* material = scene->materials + it.material;
        const bool store_it = depth > 0 || DIRECT_PHOTONS;
        if (is_diffuse(material)) {
            if (!meet_diffuse(scene, material, &it, store_it, (uint)depth, &path, store))
                return;
        } else {
#if HAS_ROUGH_PHOTONS
            if (store_it && material->takes_photons) {
                float cosine;
                const Facing facing = facing_normal(&it, -path.direction, &cosine);
                const int side = 2 * it.material + (facing.outside ? 1 : 0);
                store_photon(scene, store, &it, facing.normal, path.direction, side, &path.weight, 1.0f);
            }
#endif
            float3 v;
            v.x = random_step(path.key.x, (uint)depth);
#if HAS_ROUGH
            v.yz = direction_numbers(&path, (uint)depth);
#endif
            float pdf;
            if (!scatter(scene, material, &it, &path.direction, v, slot, false, &path.weight, &pdf))
                break;
#if HAS_ROUGH
            path.bounced |= is_rough(material);
#endif
        }
        path.origin = leave_surface(&it, path.direction);
    }
    if (!path_is_finite(&path))
        ++store->non_finite;
}

// One work-item per PATHS_PER_ITEM paths. It fills photons[item·capacity …] and says in item_counts[item] how many it
// would have stored, which may be more than the capacity, and adds its rays to item_rays[item]. What is not finite is left out and
// counted in non_finite.
kernel void photon_pass(SCENE_PARAMETERS, uint seed, uint pass, uint paths_per_pass, uint capacity, global Photon* photons,
                        global PhotonSurface* photon_surfaces, global float* photon_spectra, global uint* item_counts, global ulong* item_rays,
                        global uint* non_finite) {
    SCENE_FROM_PARAMETERS;
    const uint item = (uint)get_global_id(0);
    PhotonStore store = {photons, photon_surfaces, photon_spectra, item * capacity, (item + 1u) * capacity, 0};
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
    count_non_finite(non_finite, NON_FINITE_PHOTON, store.non_finite);
    count_cut_loops(non_finite);
}
