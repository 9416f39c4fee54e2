#include "bvh/embree_tracer.h"

#include "base/error.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <thread>

#include <embree3/rtcore.h>

namespace tristim {
namespace {

/// Calls work(begin, end) for pieces of [0, count) on `threads` threads.
template <typename Work>
void in_parallel(std::size_t count, unsigned threads, const Work& work) {
    constexpr std::size_t piece = 2048;
    std::atomic<std::size_t> next{0};
    const auto drain = [&] {
        for (std::size_t begin = next.fetch_add(piece); begin < count; begin = next.fetch_add(piece))
            work(begin, std::min(begin + piece, count));
    };
    std::vector<std::jthread> pool;
    for (unsigned i = 1; i < threads; ++i)
        pool.emplace_back(drain);
    drain();
}

RTCRay embree_ray(const Ray& ray) {
    RTCRay result{};
    result.org_x = ray.origin_x;
    result.org_y = ray.origin_y;
    result.org_z = ray.origin_z;
    result.tnear = 0.0f;
    result.dir_x = ray.direction_x;
    result.dir_y = ray.direction_y;
    result.dir_z = ray.direction_z;
    result.tfar = ray.t_max;
    result.mask = std::numeric_limits<unsigned>::max();
    return result;
}

} // namespace

struct EmbreeTracer::Impl {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Impl() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

EmbreeTracer::EmbreeTracer(const TriangleSoup& triangles, bool robust) : impl_(std::make_unique<Impl>()) {
    impl_->device = rtcNewDevice(nullptr);
    if (impl_->device == nullptr)
        fail("Embree cannot start (error {})", static_cast<int>(rtcGetDeviceError(nullptr)));
    impl_->scene = rtcNewScene(impl_->device);
    rtcSetSceneFlags(impl_->scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);

    const std::size_t count = triangles.v0.size();
    RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<V3f*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(V3f), 3 * count));
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), count));
    if (vertices == nullptr || indices == nullptr)
        fail("Embree has no memory for {} triangles", count);
    for (std::size_t i = 0; i < count; ++i) {
        vertices[3 * i] = triangles.v0[i];
        vertices[3 * i + 1] = triangles.v1[i];
        vertices[3 * i + 2] = triangles.v2[i];
        for (std::size_t corner = 0; corner < 3; ++corner)
            indices[3 * i + corner] = static_cast<unsigned>(3 * i + corner);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(impl_->scene);
    if (const RTCError error = rtcGetDeviceError(impl_->device); error != RTC_ERROR_NONE)
        fail("Embree cannot build a scene of {} triangles (error {})", count, static_cast<int>(error));
}

EmbreeTracer::~EmbreeTracer() = default;

void EmbreeTracer::trace_closest(const std::vector<Ray>& rays, unsigned threads, std::vector<RayHit>& hits) const {
    in_parallel(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        for (std::size_t i = begin; i < end; ++i) {
            RTCRayHit query{};
            query.ray = embree_ray(rays[i]);
            query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(impl_->scene, &context, &query);
            const bool missed = query.hit.geomID == RTC_INVALID_GEOMETRY_ID;
            hits[i] = {query.ray.tfar, missed ? -1 : static_cast<int>(query.hit.primID), query.hit.u, query.hit.v};
        }
    });
}

void EmbreeTracer::trace_any(const std::vector<Ray>& rays, unsigned threads,
                             std::vector<std::int32_t>& occluded) const {
    in_parallel(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        for (std::size_t i = begin; i < end; ++i) {
            RTCRay query = embree_ray(rays[i]);
            rtcOccluded1(impl_->scene, &context, &query);
            occluded[i] = query.tfar < 0.0f ? 1 : 0;
        }
    });
}

} // namespace tristim
