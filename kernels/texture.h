// Textures of single values, as pbrt-v4 defines them ("bilerp" and "imagemap" with bilinear filtering; mappings "uv", "planar",
// "spherical" and "cylindrical").
#ifndef TRISTIM_TEXTURE_H
#define TRISTIM_TEXTURE_H

#include "shared_types.h"

// Texture coordinates (s, t) of a world point with the surface's coordinates uv.
float2 texture_coordinates(const global SceneTexture* texture, float3 point, float2 uv) {
    const global float* m = texture->to_texture;
    if (texture->mapping == MAPPING_UV)
        return (float2)(m[0] * uv.x + m[3], m[5] * uv.y + m[7]);
    const float3 p = (float3)(dot(vload3(0, m), point) + m[3], dot(vload3(0, m + 4), point) + m[7],
                              dot(vload3(0, m + 8), point) + m[11]);
    if (texture->mapping == MAPPING_PLANAR)
        return p.xy;
    const float half_turns = atan2pi(p.y, p.x);
    if (texture->mapping == MAPPING_CYLINDRICAL)
        return (float2)(0.5f + 0.5f * half_turns, p.z);
    // The polar angle by atan2, since acos loses half of its digits at the poles.
    return (float2)(atan2pi(length(p.xy), p.z), half_turns < 0.0f ? 1.0f + 0.5f * half_turns : 0.5f * half_turns);
}

float wrapped_texel(const global SceneTexture* texture, const global float* texels, int x, int y) {
    const int width = texture->width, height = texture->height;
    if (texture->wrap == WRAP_BLACK && (x < 0 || x >= width || y < 0 || y >= height))
        return texture->outside;
    if (texture->wrap == WRAP_REPEAT) {
        // Texture coordinates are in [0, 1] here, so that no texel is further away than one period.
        x = x < 0 ? x + width : (x >= width ? x - width : x);
        y = y < 0 ? y + height : (y >= height ? y - height : y);
    }
    return texels[texture->first_texel + clamp(y, 0, height - 1) * width + clamp(x, 0, width - 1)];
}

// The four texels around (s, t), whose centres are at half-integers and whose t runs up from the last row, weighted by nearness.
float image_value(const global SceneTexture* texture, const global float* texels, float2 st) {
    const float2 size = (float2)((float)texture->width, (float)texture->height);
    if (texture->wrap == WRAP_REPEAT)
        st -= floor(st);
    // Further out than a texel nothing changes; fmax and fmin also turn NaN into a number, so that no index is out of range.
    const float2 at = fmin(fmax((float2)(st.x, 1.0f - st.y) * size - 0.5f, -1.0f), size);
    const float2 low = floor(at);
    const float2 f = at - low;
    const int x = (int)low.x, y = (int)low.y;
    const float upper = mix(wrapped_texel(texture, texels, x, y), wrapped_texel(texture, texels, x + 1, y), f.x);
    const float lower = mix(wrapped_texel(texture, texels, x, y + 1), wrapped_texel(texture, texels, x + 1, y + 1), f.x);
    return mix(upper, lower, f.y);
}

// The texture at a world point of a surface with coordinates uv. texels are those of all textures.
float evaluate_texture(const global SceneTexture* texture, const global float* texels, float3 point, float2 uv) {
    const float2 st = texture_coordinates(texture, point, uv);
    if (texture->kind == TEXTURE_IMAGE)
        return image_value(texture, texels, st);
    const global float* v = texture->corners;
    return mix(mix(v[0], v[2], st.x), mix(v[1], v[3], st.x), st.y);
}

#endif
