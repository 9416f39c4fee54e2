#pragma once

#include "bvh/bvh.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tristim {

/// Embree's own traversal (rtcIntersect1, rtcOccluded1), which ours is measured against.
class EmbreeTracer {
  public:
    /// `robust` sets RTC_SCENE_FLAG_ROBUST. Throws Error if Embree fails.
    EmbreeTracer(const TriangleSoup& triangles, bool robust);
    ~EmbreeTracer();
    EmbreeTracer(const EmbreeTracer&) = delete;
    EmbreeTracer& operator=(const EmbreeTracer&) = delete;

    /// The nearest hit of each ray, by `threads` threads. `hits` must be as long as `rays`.
    void trace_closest(const std::vector<Ray>& rays, unsigned threads, std::vector<RayHit>& hits) const;

    /// 1 for each ray that hits anything, else 0. `occluded` must be as long as `rays`.
    void trace_any(const std::vector<Ray>& rays, unsigned threads, std::vector<std::int32_t>& occluded) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace tristim
