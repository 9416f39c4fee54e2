// Step 2: one camera path per pixel, through specular surfaces to the first diffuse one, which becomes the pixel's visible
// point. Emission seen on the way and, unless DIRECT_PHOTONS, direct light at the visible point add to the pixel at once.
#define PATH_SPECTRUM COLOURED_EYE
#include "bsdf.h"
#include "lights.h"

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
    const float3 focus = *origin + c->focal_distance * *direction;
    const float2 lens = c->lens_radius * sample_disc(u_lens);
    *origin += lens.x * (float3)(c->lens_right_x, c->lens_right_y, c->lens_right_z) +
               lens.y * (float3)(c->lens_up_x, c->lens_up_y, c->lens_up_z);
    *direction = focus - *origin;
#endif
    *direction = unit_vector(*direction);
}

// XYZ of throughput · spectrum[first] · spectrum[second], the second one left out if negative.
float3 weighted_xyz(const Scene* scene, const PathWeight* weight, int first, int second) {
    const global float* a = spectrum_row(scene->pass_table, first);
    const global float* b = spectrum_row(scene->pass_table, max(second, 0));
    if (weight->slot >= 0) {
        const float value = a[weight->slot] * (second >= 0 ? b[weight->slot] : 1.0f);
        return weight->scale * value * slot_weight(scene->pass_table, weight->slot);
    }
    Spectrum product;
    for (int i = 0; i < BLOCKS; ++i) {
        product.block[i] = vloadv(i, a);
        if (second >= 0)
            product.block[i] *= vloadv(i, b);
#if PATH_SPECTRUM
        product.block[i] *= weight->spectrum.block[i];
#endif
    }
    return weight->scale * spectrum_to_xyz(scene->pass_table, &product);
}

float3 direct_light(const Scene* scene, const Interaction* it, float3 n, int reflectance, const PathWeight* weight,
                    float u_light, float2 u_point) {
    const int chosen = choose_light(scene, u_light);
    const DirectLight light = sample_direct(scene->lights + chosen, it, n, u_point);
    // Negated, so that a NaN goes on to the film, which counts it.
    if (light.irradiance <= 0.0f || is_occluded(scene, light.origin, light.direction, light.t_max))
        return 0.0f;
    return INV_PI * light.irradiance * weighted_xyz(scene, weight, light.spectrum, reflectance);
}

// One work-item per pixel of the region. radius0[pixel] is the initial radius, times radius_scale that of this pass.
kernel void eye_pass(SCENE_PARAMETERS, uint seed, uint pass, const global float* radius0, float radius_scale,
                     const global FilmPixel* film, global VisiblePoint* visible_points, global float* eye_spectra) {
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
    // Over W passes a pixel visits every slot once; neighbours begin at different ones.
    const int slot = (int)(((scramble.s0 >> 8) + pass) % (uint)W);

    float3 origin, direction;
    camera_ray(constants, (float2)((float)x, (float)y) + u.EYE_FILM, u.EYE_LENS, &origin, &direction);

    PathWeight weight;
    weight.scale = 1.0f;
    weight.slot = SLOT_ALL;
#if PATH_SPECTRUM
    for (int b = 0; b < BLOCKS; ++b)
        weight.spectrum.block[b] = 1.0f;
#endif
    float3 radiance = 0.0f;
    VisiblePoint point;
    point.slot = SLOT_NONE;
    for (int depth = 0; depth < MAX_DEPTH; ++depth) {
        const Hit hit = closest_hit(&scene, origin, direction);
        if (hit.triangle < 0) {
#if HAS_INFINITE_LIGHT
            const global SceneLight* light = lights + constants->infinite_light;
            radiance += light->scale * weighted_xyz(&scene, &weight, light->spectrum, -1);
#endif
            break;
        }
        const Interaction it = make_interaction(&scene, &hit);
#if HAS_AREA_LIGHT
        if (it.light >= 0) {
            const global SceneLight* light = lights + it.light;
            if (light->two_sided || dot(direction, it.normal) < 0.0f)
                radiance += light->scale * weighted_xyz(&scene, &weight, light->spectrum, -1);
        }
#endif
        const global SurfaceMaterial* material = materials + it.material;
        if (material->kind == MATERIAL_DIFFUSE) {
            float cosine;
            const float3 n = facing_normal(&it, -direction, &cosine).normal;
#if !DIRECT_PHOTONS
            radiance += direct_light(&scene, &it, n, material->reflectance, &weight, u.EYE_LIGHT,
                                     u.EYE_LIGHT_POINT);
#endif
            point.x = it.point.x;
            point.y = it.point.y;
            point.z = it.point.z;
            point.normal = pack_normal(n);
            point.slot = weight.slot;
            break;
        }
#if HAS_DIELECTRIC
        if (material->kind == MATERIAL_DIELECTRIC) {
            const float v = depth == 0 ? u.EYE_FIRST_SCATTER
                                       : random_step(scramble.s2 + pass * 0x632be5abu, (uint)depth);
            direction = scatter_dielectric(&scene, material, &it, direction, v, slot, true, &weight);
        }
#endif
#if HAS_CONDUCTOR
        if (material->kind == MATERIAL_CONDUCTOR)
            direction = scatter_conductor(&scene, material, &it, direction, &weight);
#endif
        origin = leave_surface(&it, direction);
    }
    point.throughput = weight.scale;
    point.direct_x = radiance.x;
    point.direct_y = radiance.y;
    point.direct_z = radiance.z;
#if RADIUS_STATISTICS
    point.radius = film[pixel].statistics_radius;
#else
    point.radius = radius0[pixel] * radius_scale;
#endif
    point.camera_rays = ray_counts.closest;
    point.shadow_rays = ray_counts.any;
    visible_points[pixel] = point;
#if COLOURED_EYE
    for (int b = 0; b < BLOCKS; ++b)
        vstorev(weight.spectrum.block[b], b, eye_spectra + (size_t)pixel * W_PADDED);
#endif
}
