// Step 5: at each visible point, the photons within its radius on the same surface: Σ_w c_w T_w f_w Φ_w.
#include "finite.h"
#include "grid.h"
#include "loops.h"
#include "sampling.h"
#include "spectrum.h"
#if HAS_ROUGH_PHOTONS
#define PATH_SPECTRUM 1
#include "interface.h"
#endif

// Photons on surfaces that are turned further away than this do not count: round a corner, or on the back of a sheet.
#define SMALLEST_NORMAL_COSINE 0.5f

// Photons that are added up at once. A plain sum of n floats that are alike is wrong by some n 1e-8 of itself: by a hundredth for the
// million photons that a large radius may find. So they are added up in blocks, and these in blocks of as many.
#define SUM_BLOCK 1024u

typedef struct Flux {
    float3 xyz;
    float single;  // at the visible point's slot, of photons that carry every wavelength
#if COLOURED_EYE
    Spectrum spectrum;  // of photons that carry every wavelength
#endif
} Flux;

// What a visible point has gathered so far.
typedef struct Gathered {
    Flux flux;  // of the block that is not full yet
    uint count;
    Flux full;  // of full blocks, and of SUM_BLOCK of these each; holds nothing while there is none
    Flux many;
    uint full_count;
    uint non_finite;
} Gathered;

void clear_flux(Flux* flux) {
    flux->xyz = 0.0f;
    flux->single = 0.0f;
#if COLOURED_EYE
    for (int b = 0; b < BLOCKS; ++b)
        flux->spectrum.block[b] = 0.0f;
#endif
}

void add_flux(Flux* sum, const Flux* more) {
    sum->xyz += more->xyz;
    sum->single += more->single;
#if COLOURED_EYE
    for (int b = 0; b < BLOCKS; ++b)
        sum->spectrum.block[b] += more->spectrum.block[b];
#endif
}

void finish_block(Gathered* gathered) {
    if (gathered->full_count % SUM_BLOCK == 0u)
        gathered->full = gathered->flux;
    else
        add_flux(&gathered->full, &gathered->flux);
    clear_flux(&gathered->flux);
    gathered->count = 0;
    if (++gathered->full_count == SUM_BLOCK)
        gathered->many = gathered->full;
    else if (gathered->full_count % SUM_BLOCK == 0u)
        add_flux(&gathered->many, &gathered->full);
}

// The photons in all; their flux is put together.
float finish_sum(Gathered* gathered) {
    if (gathered->full_count % SUM_BLOCK != 0u)
        add_flux(&gathered->flux, &gathered->full);
    if (gathered->full_count >= SUM_BLOCK)
        add_flux(&gathered->flux, &gathered->many);
    return (float)(gathered->full_count * SUM_BLOCK + gathered->count);
}

typedef struct Search {
    const global Photon* photons;
    const global float* photon_spectra;
    const global uint2* pairs;
    const global SceneConstants* constants;
    const global float* eye_spectrum;
    float3 point, normal;
    uint packed_normal;
    bool rows_share_buckets;
    float radius2, scale;
    int slot;
#if HAS_ROUGH_PHOTONS
    const Scene* scene;  // its materials, films and spectra
    const global PhotonSurface* photon_surfaces;
    VisibleSurface surface;
    Frame frame;       // of a rough surface
    float3 outgoing;   // in that frame
#endif
} Search;

#if HAS_ROUGH_PHOTONS
// Whether a photon on the visible point's rough surface came from the side that the camera path came from.
bool is_on_same_side(const Search* search, uint index) {
    return (search->photon_surfaces[index].side & 1) == search->surface.outside;
}

// A photon on a rough surface: the BSDF for its direction and the visible point's, for each wavelength.
void add_rough_photon(const Search* search, uint index, Gathered* gathered) {
    const global Photon* photon = search->photons + index;
    const global SurfaceMaterial* material = search->scene->materials + search->surface.material;
    const bool outside = search->surface.outside;
    // Of the path's wavelengths and the photon's.
    const int slot = is_single(search->slot) ? search->slot : photon->slot;
    if (is_single(photon->slot) && photon->slot != slot)
        return;
    const float3 incident = frame_from_world(&search->frame, unpack_normal(search->photon_surfaces[index].incident));
    const bool reflected = is_on_same_side(search, index);
    if (reflected != (incident.z > 0.0f))
        return;  // on a curved surface: below the visible point's horizon
    const RoughScattering rough =
        evaluate_rough(search->scene, material, search->surface.thickness, outside, search->outgoing, incident, slot);
    if (rough.geometry <= 0.0f)
        return;
    const Spectrum* share = reflected ? &rough.optics.reflected : &rough.optics.transmitted;
    float factor = rough.geometry;
    if (!reflected) {
        const float inverse_eta = inverse_relative_eta(search->scene, material, outside, slot);
        factor *= inverse_eta * inverse_eta;  // radiance
    }
    if (!is_finite(factor * (is_single(slot) ? spectrum_at(share, slot) : spectrum_sum(share)))) {
        ++gathered->non_finite;
        return;
    }
    ++gathered->count;
    if (is_single(photon->slot)) {
        const float throughput = is_single(search->slot) ? 1.0f : search->eye_spectrum[slot];
        gathered->flux.xyz += factor * spectrum_at(share, slot) * throughput * (float3)(photon->flux_x, photon->flux_y, photon->flux_z);
        return;
    }
    const global float* spectrum = search->photon_spectra + (size_t)index * W_PADDED;
    if (is_single(slot)) {
        gathered->flux.single += factor * spectrum_at(share, slot) * spectrum[slot];
    } else {
        for (int b = 0; b < BLOCKS; ++b)
            gathered->flux.spectrum.block[b] += factor * share->block[b] * vloadv(b, spectrum);
    }
}
#endif

bool normals_agree(uint packed, float3 normal) {
    const float3 direction = unpack_direction(packed);
    const float cosine = dot(direction, normal); // times the length of direction
    return cosine > 0.0f && cosine * cosine >= SMALLEST_NORMAL_COSINE * SMALLEST_NORMAL_COSINE * dot(direction, direction);
}

// Whether a photon lies on the visible point's surface, as far as normals and materials tell, on the side that counts: through a
// rough surface light may also come from the other one. A thin slab's other face has the same normals, but the other way round.
bool is_on_surface(const Search* search, uint index) {
    const uint packed = search->photons[index].normal;
#if HAS_ROUGH_PHOTONS
    const int side = search->photon_surfaces[index].side;
    const int material = side < 0 ? -1 : side / 2;
    if (material != search->surface.material)
        return false;
    if (material >= 0)
        return normals_agree(packed, is_on_same_side(search, index) ? search->normal : -search->normal);
#endif
    return packed == search->packed_normal || normals_agree(packed, search->normal);
}

void add_photon(const Search* search, uint index, Gathered* gathered) {
    const global Photon* photon = search->photons + index;
    const float3 flux = (float3)(photon->flux_x, photon->flux_y, photon->flux_z);
#if STORE_SPECTRAL_FLUX
    if (is_single(search->slot)) {
        if (photon->slot == SLOT_ALL)
            gathered->flux.single += search->photon_spectra[(size_t)index * W_PADDED + search->slot];
        else if (photon->slot == search->slot)
            gathered->flux.xyz += flux;
        else
            return;
        ++gathered->count;
        return;
    }
#endif
    ++gathered->count;
#if COLOURED_EYE
    if (is_single(photon->slot)) {
        gathered->flux.xyz += search->eye_spectrum[photon->slot] * flux;
    } else {
        for (int b = 0; b < BLOCKS; ++b)
            gathered->flux.spectrum.block[b] += vloadv(b, search->photon_spectra + (size_t)index * W_PADDED);
    }
#else
    gathered->flux.xyz += flux;
#endif
}

// A row of cells that a search covers.
typedef struct Row {
    int y, z;
    uint bucket;
} Row;

__attribute__((always_inline)) void take_photon(const Search* search, uint index, Gathered* gathered) {
#if HAS_ROUGH_PHOTONS
    if (search->surface.material >= 0)
        add_rough_photon(search, index, gathered);
    else
#endif
        add_photon(search, index, gathered);
    if (gathered->count == SUM_BLOCK)
        finish_block(gathered);
}

// The photons between two positions of the sorted pairs. If the search's rows share buckets, only those that lie in this
// one: the others are met again in their own. `inner`, with ERROR_ESTIMATE, takes those within half the disc's area. Inlined, the
// gather takes a tenth less time on PoCL.
__attribute__((always_inline)) void add_range(const Search* search, uint begin, uint end, const Row* row, Gathered* gathered,
                                              Gathered* inner) {
    for (uint i = begin; i < end; ++i) {
        const uint index = search->pairs[i].y;
        const global Photon* photon = search->photons + index;
        const float3 position = (float3)(photon->x, photon->y, photon->z);
        const float3 offset = position - search->point;
        if (dot(offset, offset) > search->radius2)
            continue;
        if (search->rows_share_buckets) {
            const int3 cell = cell_of(position, search->constants, search->scale);
            if (cell.y != row->y || cell.z != row->z)
                continue;
        }
        if (!is_on_surface(search, index))
            continue;
        take_photon(search, index, gathered);
#if ERROR_ESTIMATE
        if (dot(offset, offset) <= 0.5f * search->radius2)
            take_photon(search, index, inner);
#endif
    }
}

// Whether two of the rows, each `span` + 1 cells long, have buckets in common.
bool share_buckets(const Row* rows, int count, uint span) {
    for (int i = 1; i < count; ++i) {
        for (int j = 0; j < i; ++j) {
            // Distance on the ring of buckets, at most span for an overlap.
            if (((rows[i].bucket - rows[j].bucket + span) & BUCKET_MASK) <= 2u * span)
                return true;
        }
    }
    return false;
}

void clear_gathered(Gathered* gathered) {
    clear_flux(&gathered->flux);
    gathered->count = gathered->full_count = gathered->non_finite = 0;
}

// The XYZ of Σ flux / photon paths, throughput included, and the number of photons.
// Inlined, so that `gathered` stays in registers: with all effects compiled in the gather takes 0.6 of the time on PoCL.
__attribute__((always_inline)) float4 finish_gathered(const Search* search, const VisiblePoint* point,
                                                      const global float* pass_table, uint paths_per_pass,
                                                      Gathered* gathered) {
    const float found = finish_sum(gathered);
    float3 flux = gathered->flux.xyz;
    if (is_single(point->slot))
        flux += gathered->flux.single * slot_weight(pass_table, point->slot);
#if COLOURED_EYE
    if (!is_single(point->slot)) {
        for (int b = 0; b < BLOCKS; ++b)
            gathered->flux.spectrum.block[b] *= vloadv(b, search->eye_spectrum);
        flux += spectrum_to_xyz(pass_table, &gathered->flux.spectrum);
    }
#endif
    flux *= point->throughput / (float)paths_per_pass;
    if (!is_finite3(flux)) {
        flux = 0.0f;
        ++gathered->non_finite;
    }
    return (float4)(flux, found);
}

// One work-item per pixel. gathered_flux[pixel] becomes the XYZ of Σ flux / photon paths, throughput included, and the number
// of photons found; the film divides by the area π r². What is not finite is left out and counted in non_finite. With
// ERROR_ESTIMATE inner_flux[pixel] becomes the same of the photons within radius/√2.
kernel void gather(const global SceneConstants* constants, const global float* pass_table,
                   const global VisiblePoint* visible_points, const global float* eye_spectra, const global Photon* photons,
                   const global float* photon_spectra, const global uint2* pairs, const global uint* bucket_begin,
                   const global uint* largest_radius, uint paths_per_pass, const global VisibleSurface* visible_surfaces,
                   const global PhotonSurface* photon_surfaces, const global SurfaceMaterial* materials,
                   const global SceneFilmLayer* film_layers, global float4* gathered_flux, global uint* non_finite
#if ERROR_ESTIMATE
                   , global float4* inner_flux
#endif
) {
    const uint pixel = (uint)get_global_id(0);
    const VisiblePoint point = visible_points[pixel];
    if (point.slot == SLOT_NONE) {
        gathered_flux[pixel] = 0.0f;
#if ERROR_ESTIMATE
        inner_flux[pixel] = 0.0f;
#endif
        return;
    }
    Search search;
    search.photons = photons;
    search.photon_spectra = photon_spectra;
    search.pairs = pairs;
    search.constants = constants;
    search.eye_spectrum = eye_spectra + (size_t)pixel * W_PADDED;
    search.point = (float3)(point.x, point.y, point.z);
    search.normal = unpack_normal(point.normal);
    search.packed_normal = point.normal;
    search.radius2 = point.radius * point.radius;
    search.scale = cell_scale(largest_radius);
    search.slot = point.slot;
#if HAS_ROUGH_PHOTONS
    Scene scene;
    scene.materials = materials;
    scene.film_layers = film_layers;
    scene.pass_table = pass_table;
    search.scene = &scene;
    search.photon_surfaces = photon_surfaces;
    search.surface = visible_surfaces[pixel];
    if (search.surface.material >= 0) {
        search.frame.n = search.normal;
        search.frame.s = unpack_normal(search.surface.tangent);
        search.frame.t = cross(search.frame.n, search.frame.s);
        search.outgoing = frame_from_world(&search.frame, unpack_normal(search.surface.outgoing));
    }
#endif

    Gathered gathered, inner;
    clear_gathered(&gathered);
#if ERROR_ESTIMATE
    clear_gathered(&inner);
#endif
    const int3 low = cell_of(search.point - point.radius, constants, search.scale);
    const int3 high = cell_of(search.point + point.radius, constants, search.scale);
    // Two in y and z each; three where a coordinate rounds by more than a cell exceeds the sphere, and never more while radii are
    // above their least (search_radius).
    Row rows[9];
    int count = 0;
    for (int z = low.z; z <= min(high.z, low.z + 2); ++z) {
        for (int y = low.y; y <= min(high.y, low.y + 2); ++y) {
            const Row row = {y, z, row_bucket(y, z)};
            rows[count++] = row;
        }
    }
    search.rows_share_buckets = share_buckets(rows, count, (uint)(high.x - low.x));
    for (int i = 0; i < count; ++i) {
        const uint first = (rows[i].bucket + (uint)low.x) & BUCKET_MASK;
        const uint last = (rows[i].bucket + (uint)high.x) & BUCKET_MASK;
        if (first <= last) {
            add_range(&search, bucket_begin[first], bucket_begin[last + 1], &rows[i], &gathered, &inner);
        } else {
            add_range(&search, bucket_begin[first], bucket_begin[BUCKET_COUNT], &rows[i], &gathered, &inner);
            add_range(&search, 0, bucket_begin[last + 1], &rows[i], &gathered, &inner);
        }
    }
    gathered_flux[pixel] = finish_gathered(&search, &point, pass_table, paths_per_pass, &gathered);
#if ERROR_ESTIMATE
    inner_flux[pixel] = finish_gathered(&search, &point, pass_table, paths_per_pass, &inner);
#endif
    count_non_finite(non_finite, NON_FINITE_GATHER, gathered.non_finite);
    count_cut_loops(non_finite);
}
