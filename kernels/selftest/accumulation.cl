// Many passes of film.cl's own sums, for host/selftest/accumulation_cases.cpp, which computes the same samples.
#include "film.cl"

// Of a pixel: its samples' exponents lie between `lowest` and lowest + span - 1, of which no more than the sign is random if `span`
// is 0; with `negative` every other one is less than zero. Up to `photons` are found in a pass, exactly as many if not `vary`.
typedef struct Stream {
    int lowest, span, negative, photons, vary;
} Stream;

uint mixed(uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ x >> 16;
}

float stream_value(const Stream* stream, uint pixel, uint pass, uint channel) {
    const uint bits = mixed(pass * 3u + channel + pixel * 0x9e3779b9u);
    const uint exponent = (uint)(127 + stream->lowest) + (stream->span > 0 ? mixed(bits) % (uint)stream->span : 0u);
    const uint sign = stream->negative != 0 ? bits & 0x80000000u : 0u;
    return as_float(sign | exponent << 23 | (stream->span > 0 ? bits >> 9 : 0x4ccccdu));
}

// One work-item per pixel: passes first to last - 1.
kernel void add_passes(const global Stream* streams, uint first, uint last, float alpha, global FilmPixel* film) {
    const uint pixel = (uint)get_global_id(0);
    const Stream stream = streams[pixel];
    VisiblePoint point;
    point.slot = SLOT_ALL;
    point.radius = 1.0f;
    point.camera_rays = 3;
    point.shadow_rays = 2;
    for (uint pass = first; pass < last; ++pass) {
        point.direct_x = stream_value(&stream, pixel, pass, 0);
        point.direct_y = stream_value(&stream, pixel, pass, 1);
        point.direct_z = stream_value(&stream, pixel, pass, 2);
        const uint found = stream.vary != 0 ? mixed(pass ^ pixel * 0x632be5abu) % (uint)(stream.photons + 1) : (uint)stream.photons;
        add_sample(film + pixel, &point, (float4)(0.0f, 0.0f, 0.0f, (float)found), alpha);
    }
}
