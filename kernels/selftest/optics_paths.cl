// What surfaces do to paths, for `tristim selftest` (host/selftest/optics_path_cases.cpp).
#define PATH_SPECTRUM 1
#include "bsdf.h"

// Direction and material, numbers and the slot that a dispersive surface keeps; to the direction and whether the path goes on,
// (scale, slot, pdf), and the spectrum. The path begins with weight 1 at every wavelength; the surface is z = 0, its outside above.
kernel void scatter_path(const global float* pass_table, const global SurfaceMaterial* materials,
                         const global SceneFilmLayer* layers, const global float4* in, global float4* out) {
    const size_t i = get_global_id(0);
    Scene scene;
    scene.pass_table = pass_table;
    scene.film_layers = layers;
    Interaction it;
    it.point = 0.0f;
    it.normal = it.shading_normal = (float3)(0.0f, 0.0f, 1.0f);
    it.extent = 1.0f;
    it.material = (int)in[2 * i].w;
    it.light = -1;
    PathWeight weight;
    weight.scale = 1.0f;
    weight.slot = SLOT_ALL;
    for (int b = 0; b < BLOCKS; ++b)
        weight.spectrum.block[b] = 1.0f;
    float3 direction = in[2 * i].xyz;
    float pdf;
    const bool goes_on = scatter(&scene, materials + it.material, &it, &direction, in[2 * i + 1].xyz, (int)in[2 * i + 1].w,
                                 false, &weight, &pdf);
    out[3 * i] = (float4)(direction, goes_on ? 1.0f : 0.0f);
    out[3 * i + 1] = (float4)(weight.scale, (float)weight.slot, pdf, 0.0f);
    out[3 * i + 2] = weight.spectrum.block[0];
}
