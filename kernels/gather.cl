// Step 5: at each visible point, the photons within its radius on the same surface side: Σ_w c_w T_w f_w Φ_w.
#include "grid.h"
#include "sampling.h"
#include "spectrum.h"

// Photons on surfaces that are turned further away than this do not count: round a corner, or on the back of a sheet.
#define SMALLEST_NORMAL_COSINE 0.5f

// What a visible point has gathered so far.
typedef struct Gathered {
    float3 flux;   // XYZ
    float single;  // flux at the visible point's slot, of photons that carry every wavelength
    uint count;
#if COLOURED_EYE
    Spectrum spectrum;  // flux of photons that carry every wavelength
#endif
} Gathered;

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
} Search;

bool normals_agree(uint packed, float3 normal) {
    const float3 direction = unpack_direction(packed);
    const float cosine = dot(direction, normal); // times the length of direction
    return cosine > 0.0f && cosine * cosine >= SMALLEST_NORMAL_COSINE * SMALLEST_NORMAL_COSINE * dot(direction, direction);
}

void add_photon(const Search* search, uint index, Gathered* gathered) {
    const global Photon* photon = search->photons + index;
    const float3 flux = (float3)(photon->flux_x, photon->flux_y, photon->flux_z);
#if STORE_SPECTRAL_FLUX
    if (search->slot >= 0) {
        if (photon->slot == SLOT_ALL)
            gathered->single += search->photon_spectra[(size_t)index * W_PADDED + search->slot];
        else if (photon->slot == search->slot)
            gathered->flux += flux;
        else
            return;
        ++gathered->count;
        return;
    }
#endif
    ++gathered->count;
#if COLOURED_EYE
    if (photon->slot >= 0) {
        gathered->flux += search->eye_spectrum[photon->slot] * flux;
    } else {
        for (int b = 0; b < BLOCKS; ++b)
            gathered->spectrum.block[b] += vloadv(b, search->photon_spectra + (size_t)index * W_PADDED);
    }
#else
    gathered->flux += flux;
#endif
}

// A row of cells that a search covers.
typedef struct Row {
    int y, z;
    uint bucket;
} Row;

// The photons between two positions of the sorted pairs. If the search's rows share buckets, only those that lie in this
// one: the others are met again in their own. Inlined, the gather takes a tenth less time on PoCL.
__attribute__((always_inline)) void add_range(const Search* search, uint begin, uint end, const Row* row, Gathered* gathered) {
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
        if (photon->normal == search->packed_normal || normals_agree(photon->normal, search->normal))
            add_photon(search, index, gathered);
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

// One work-item per pixel. gathered_flux[pixel] becomes the XYZ of Σ flux / photon paths, throughput included, and the number
// of photons found; the film divides by the area π r².
kernel void gather(const global SceneConstants* constants, const global float* pass_table,
                   const global VisiblePoint* visible_points, const global float* eye_spectra, const global Photon* photons,
                   const global float* photon_spectra, const global uint2* pairs, const global uint* bucket_begin,
                   const global uint* largest_radius, uint paths_per_pass, global float4* gathered_flux) {
    const uint pixel = (uint)get_global_id(0);
    const VisiblePoint point = visible_points[pixel];
    if (point.slot == SLOT_NONE) {
        gathered_flux[pixel] = 0.0f;
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

    Gathered gathered;
    gathered.flux = 0.0f;
    gathered.single = 0.0f;
    gathered.count = 0;
#if COLOURED_EYE
    for (int b = 0; b < BLOCKS; ++b)
        gathered.spectrum.block[b] = 0.0f;
#endif
    const int3 low = cell_of(search.point - point.radius, constants, search.scale);
    const int3 high = cell_of(search.point + point.radius, constants, search.scale);
    Row rows[9];  // two in y and z each; three where a coordinate rounds by more than a cell exceeds the sphere
    int count = 0;
    for (int z = low.z; z <= high.z; ++z) {
        for (int y = low.y; y <= high.y; ++y) {
            const Row row = {y, z, row_bucket(y, z)};
            rows[count++] = row;
        }
    }
    search.rows_share_buckets = share_buckets(rows, count, (uint)(high.x - low.x));
    for (int i = 0; i < count; ++i) {
        const uint first = (rows[i].bucket + (uint)low.x) & BUCKET_MASK;
        const uint last = (rows[i].bucket + (uint)high.x) & BUCKET_MASK;
        if (first <= last) {
            add_range(&search, bucket_begin[first], bucket_begin[last + 1], &rows[i], &gathered);
        } else {
            add_range(&search, bucket_begin[first], bucket_begin[BUCKET_COUNT], &rows[i], &gathered);
            add_range(&search, 0, bucket_begin[last + 1], &rows[i], &gathered);
        }
    }
    float3 flux = gathered.flux;
    if (point.slot >= 0)
        flux += gathered.single * slot_weight(pass_table, point.slot);
#if COLOURED_EYE
    if (point.slot == SLOT_ALL) {
        for (int b = 0; b < BLOCKS; ++b)
            gathered.spectrum.block[b] *= vloadv(b, search.eye_spectrum);
        flux += spectrum_to_xyz(pass_table, &gathered.spectrum);
    }
#endif
    flux *= point.throughput / (float)paths_per_pass;
    gathered_flux[pixel] = (float4)(flux, (float)gathered.count);
}
