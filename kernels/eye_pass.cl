// Step 2: one camera path per pixel, through specular surfaces to the first diffuse one, which becomes the pixel's visible
// point. Emission seen on the way and, unless DIRECT_PHOTONS, direct light at the visible point add to the pixel at once.
#define PATH_SPECTRUM COLOURED_EYE
#include "direct_light.h"
#include "finite.h"
#include "grid.h"
#include "loops.h"

// Dimensions of a pixel's low-discrepancy sequence over the passes.
#define EYE_FILM s01
#define EYE_FIRST_SCATTER s2
#define EYE_LIGHT s3
#define EYE_LIGHT_POINT s45
#define EYE_LENS s67
#define EYE_USES_UPPER_DIMENSIONS (HAS_AREA_LIGHT || HAS_INFINITE_LIGHT || HAS_THIN_LENS)

void camera_ray(const global SceneConstants* c, float2 raster, float2 u_lens, float3* origin, float3* direction) {
    *origin = (float3)(c->camera_x, c->camera_y, c->camera_z);
    *direction = (float3)(c->corner_x, c->corner_y, c->corner_z) + raster.x * (float3)(c->right_x, c->right_y, c->right_z) +
                 raster.y * (float3)(c->down_x, c->down_y, c->down_z);
#if HAS_THIN_LENS
    const float2 lens = c->lens_radius * sample_disc(u_lens);
    const float3 offset = lens.x * (float3)(c->lens_right_x, c->lens_right_y, c->lens_right_z) +
                          lens.y * (float3)(c->lens_up_x, c->lens_up_y, c->lens_up_z);
    *origin += offset;
    *direction -= offset / c->focal_distance;
#endif
    *direction = unit_vector(*direction);
}

// A camera path on its way.
typedef struct EyePath {
    float3 origin, direction;
    PathWeight weight;
    float3 radiance;  // XYZ gathered so far
    float pdf;        // [1/sr] with which a nearly specular surface chose the direction; 0 after any other, and at the camera
    float3 normal;    // of that surface, with which it looked for light
    bool both_sides;  // whether it did so on both of its sides
    uint non_finite;  // contributions and visible points that were left out for it
} EyePath;

void add_radiance(EyePath* path, float3 xyz) {
    if (is_finite3(xyz))
        path->radiance += xyz;
    else
        ++path->non_finite;
}

#if HAS_AREA_LIGHT || HAS_INFINITE_LIGHT
// Adds what a light emits along the path, in which the surface before has had its share already if it sampled the light with
// light_pdf (see rough_direct_light).
void add_emission(const Scene* scene, const global SceneLight* light, float light_pdf, EyePath* path) {
    const float share = path->pdf > 0.0f ? path->pdf / (path->pdf + light_pdf) : 1.0f;
    add_radiance(path, share * light->scale * weighted_xyz(scene, &path->weight, light->spectrum, -1));
}
#endif

void see_nothing(const Scene* scene, EyePath* path) {
#if HAS_INFINITE_LIGHT
    if (scene->constants->infinite_light < 0)
        return;
    const global SceneLight* light = scene->lights + scene->constants->infinite_light;
    float light_pdf = 0.0f;
#if HAS_NEARLY_SPECULAR
    light_pdf = infinite_light_pdf(light, fabs(dot(path->direction, path->normal)), path->both_sides);
#endif
    add_emission(scene, light, light_pdf, path);
#endif
}

void see_emission(const Scene* scene, const Interaction* it, float distance, EyePath* path) {
#if HAS_AREA_LIGHT
    if (it->light < 0)
        return;
    const global SceneLight* light = scene->lights + it->light;
    const float cosine = dot(path->direction, it->normal);
    if (!light->two_sided && cosine >= 0.0f)
        return;
    float light_pdf = 0.0f;
#if HAS_NEARLY_SPECULAR
    light_pdf = area_light_pdf(light, distance * distance, fabs(cosine));
#endif
    add_emission(scene, light, light_pdf, path);
#endif
}

// The visible point of a pixel, where its path ended, and what else the gather needs to know of it.
typedef struct EyeEnd {
    VisiblePoint point;
    VisibleSurface surface;
    float extent;  // of its triangle
} EyeEnd;

void make_visible_point(const Interaction* it, float3 n, int slot, EyeEnd* end) {
    end->point.x = it->point.x;
    end->point.y = it->point.y;
    end->point.z = it->point.z;
    end->point.normal = pack_normal(n);
    end->point.slot = slot;
    end->surface.material = -1;
    end->extent = it->extent;
}

// Whether what the gather is to multiply and where it is to look are finite.
bool end_is_finite(const EyePath* path, const EyeEnd* end) {
    float sum = path->weight.scale;
#if PATH_SPECTRUM
    sum += carried_total(&path->weight);
#endif
    return is_finite(sum) && is_finite3((float3)(end->point.x, end->point.y, end->point.z));
}

// At a diffuse surface; returns whether the path goes on, reflected by a film.
__attribute__((always_inline))
bool meet_diffuse(const Scene* scene, const global SurfaceMaterial* material, const Interaction* it, float u_lobe, float u_light,
                  float2 u_point, EyePath* path, EyeEnd* end) {
    float cosine;
    const Facing facing = facing_normal(it, -path->direction, &cosine);
    const float3 n = facing.normal;
#if HAS_COATED_DIFFUSE
    if (material->film_layers > 0) {
        const InterfaceOptics optics = interface_optics(scene, material, film_thickness(scene, material, it), true, cosine,
                                                        path->weight.slot);
        const float probability = reflection_probability(&path->weight, &optics);
        if (u_lobe < probability) {
            multiply_weight(&path->weight, &optics.reflected, 1.0f / probability);
            path->direction = mirror(it, facing, cosine, path->direction);
            path->pdf = 0.0f;
            return true;
        }
        multiply_weight(&path->weight, &optics.transmitted, 1.0f / (1.0f - probability));
    }
#endif
#if !DIRECT_PHOTONS
    add_radiance(path, diffuse_direct_light(scene, material, it, n, &path->weight, u_light, u_point));
#endif
    make_visible_point(it, n, path->weight.slot, end);
    return false;
}

#if HAS_ROUGH
// At a rough surface, before it scatters the path; returns whether the path goes on.
bool meet_rough(const Scene* scene, const global SurfaceMaterial* material, const Interaction* it, int slot, float u_light,
                float2 u_point, EyePath* path, EyeEnd* end) {
    meet_dispersion(material, slot, &path->weight);
    float cosine;
    const Facing facing = facing_normal(it, -path->direction, &cosine);
    const Frame frame = surface_frame(material, it, facing.normal);
    float3 wo = frame_from_world(&frame, -path->direction);
    wo.z = cosine;
    path->normal = facing.normal;
    path->both_sides = is_dielectric(material);
    // With DIRECT_PHOTONS direct light comes with the photons, but only where photons are taken.
    if (!DIRECT_PHOTONS || !takes_photons(material))
        add_radiance(path, rough_direct_light(scene, material, it, &frame, wo, facing.outside, &path->weight, u_light, u_point));
    if (!takes_photons(material))
        return true;
    make_visible_point(it, facing.normal, path->weight.slot, end);
    end->surface.material = it->material;
    end->surface.outgoing = pack_normal(-path->direction);
    end->surface.tangent = pack_normal(frame.s);
    end->surface.thickness = film_thickness(scene, material, it);
    end->surface.outside = facing.outside ? 1 : 0;
    return false;
}
#endif

// One work-item per pixel of the region. radius0[pixel] is the initial radius, times radius_scale that of this pass. What is not
// finite is left out and counted in non_finite.
kernel void eye_pass(SCENE_PARAMETERS, uint seed, uint pass, const global float* radius0, float radius_scale,
                     const global FilmPixel* film, global VisiblePoint* visible_points, global VisibleSurface* visible_surfaces,
                     global float* eye_spectra, global uint* non_finite) {
    SCENE_FROM_PARAMETERS;
    const uint pixel = (uint)get_global_id(0);
    const uint x = (uint)constants->region_x + pixel % (uint)constants->region_width;
    const uint y = (uint)constants->region_y + pixel / (uint)constants->region_width;
    const uint image_pixel = y * (uint)constants->image_width + x;

    uint8 scramble = (uint8)(pcg4d((uint4)(image_pixel, STREAM_EYE, 0u, seed)), (uint4)(0u));
#if EYE_USES_UPPER_DIMENSIONS
    scramble.hi = pcg4d((uint4)(image_pixel, STREAM_EYE, 1u, seed));
#endif
    const float8 u = sobol8(sobol_table, pass, scramble);
    // Over W passes a pixel visits every slot once; neighbours begin at different ones. The slots turn by the golden-ratio sequence
    // from one W passes to the next: else, with W a power of two, each would always see the same part of its stratum, since every
    // W-th point of the wavelengths' Sobol' sequence lies there.
    const uint turn = (uint)(unit_float(pass / (uint)W * 2654435769u) * (float)W);  // 2^32 / golden ratio
    const int slot = (int)(((scramble.s0 >> 8) + pass + turn) % (uint)W);

    EyePath path;
    camera_ray(constants, (float2)((float)x, (float)y) + u.EYE_FILM, u.EYE_LENS, &path.origin, &path.direction);
    path.weight.scale = 1.0f;
    path.weight.slot = SLOT_ALL;
#if PATH_SPECTRUM
    for (int b = 0; b < BLOCKS; ++b)
        path.weight.spectrum.block[b] = 1.0f;
#endif
    path.radiance = 0.0f;
    path.pdf = 0.0f;
    path.normal = 0.0f;
    path.both_sides = false;
    path.non_finite = 0;
    EyeEnd end;
    end.point.slot = SLOT_NONE;
    end.extent = 0.0f;
    for (int depth = 0; depth < MAX_DEPTH; ++depth) {
        const Hit hit = closest_hit(&scene, path.origin, path.direction);
        if (hit.triangle < 0) {
            if (is_finite3(path.direction))
                see_nothing(&scene, &path);
            else
                ++path.non_finite;
            break;
        }
        const Interaction it = make_interaction(&scene, &hit);
        see_emission(&scene, &it, hit.t, &path);
        const global SurfaceMaterial* material = materials + it.material;
        float3 v = 0.0f;
        if (!is_diffuse(material) || HAS_COATED_DIFFUSE)
            v.x = depth == 0 ? u.EYE_FIRST_SCATTER : random_step(scramble.s2 + pass * 0x632be5abu, (uint)depth);
        if (is_diffuse(material)) {
            if (!meet_diffuse(&scene, material, &it, v.x, u.EYE_LIGHT, u.EYE_LIGHT_POINT, &path, &end))
                break;
        } else {
#if HAS_ROUGH
            v.y = random_step(scramble.s0 + pass * 0x632be5abu, (uint)depth);
            v.z = random_step(scramble.s1 + pass * 0x632be5abu, (uint)depth);
            if (is_rough(material) &&
                !meet_rough(&scene, material, &it, slot, u.EYE_LIGHT, u.EYE_LIGHT_POINT, &path, &end))
                break;
#endif
            if (!scatter(&scene, material, &it, &path.direction, v, slot, true, &path.weight, &path.pdf))
                break;
        }
        path.origin = leave_surface(&it, path.direction);
    }
    if (end.point.slot != SLOT_NONE && !end_is_finite(&path, &end)) {
        end.point.slot = SLOT_NONE;
        ++path.non_finite;
    }
    end.point.throughput = path.weight.scale;
    end.point.direct_x = path.radiance.x;
    end.point.direct_y = path.radiance.y;
    end.point.direct_z = path.radiance.z;
#if RADIUS_STATISTICS
    const float radius = film[pixel].statistics_radius;
#else
    const float radius = radius0[pixel] * radius_scale;
#endif
    end.point.radius = search_radius(radius, end.extent);
    end.point.camera_rays = ray_counts.closest;
    end.point.shadow_rays = ray_counts.any;
    visible_points[pixel] = end.point;
    count_non_finite(non_finite, NON_FINITE_EYE, path.non_finite);
    count_cut_loops(non_finite);
#if HAS_ROUGH_PHOTONS
    visible_surfaces[pixel] = end.surface;
#endif
#if COLOURED_EYE
    for (int b = 0; b < BLOCKS; ++b)
        vstorev(path.weight.spectrum.block[b], b, eye_spectra + (size_t)pixel * W_PADDED);
#endif
}
