#include "bvh/ray_tracer.h"

namespace tristim {

Macros traversal_macros(const Bvh& bvh) {
    constexpr int step = 32;
    return {{"BVH_WIDTH", std::to_string(bvh.width)},
            {"BVH_STACK_SIZE", std::to_string((bvh.stack_size / step + 1) * step)}};
}

RayTracer::RayTracer(const Device& device, const Bvh& bvh, const BuildOptions& options)
    : device_(device), nodes_(device, "BVH nodes", bvh.nodes.words()),
      leaves_(device, "BVH leaves", bvh.leaves.words()) {
    const ::cl::Program program = build_program(device, "trace_rays.cl", traversal_macros(bvh), options);
    closest_ = ::cl::Kernel(program, "trace_closest");
    any_ = ::cl::Kernel(program, "trace_any");
}

void RayTracer::set_rays(const std::vector<Ray>& rays) {
    if (rays.size() > rays_.size()) {
        rays_ = Buffer<Ray>(device_, "rays", rays.size());
        hits_ = Buffer<RayHit>(device_, "hits", rays.size());
        occluded_ = Buffer<std::int32_t>(device_, "occluded", rays.size());
    }
    ray_count_ = rays.size();
    rays_.write(device_, rays);
}

void RayTracer::run(::cl::Kernel& kernel, const ::cl::Buffer& results) {
    if (ray_count_ == 0)
        return;
    kernel.setArg(0, nodes_.cl());
    kernel.setArg(1, leaves_.cl());
    kernel.setArg(2, rays_.cl());
    kernel.setArg(3, results);
    kernel.setArg(4, static_cast<cl_uint>(ray_count_));
    const std::size_t group = device_.tuning.pixel_group;
    const std::size_t padded = (ray_count_ + group - 1) / group * group;
    device_.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(padded), ::cl::NDRange(group));
    device_.queue.finish();
}

void RayTracer::run_closest() {
    run(closest_, hits_.cl());
}

void RayTracer::run_any() {
    run(any_, occluded_.cl());
}

std::vector<RayHit> RayTracer::trace_closest(const std::vector<Ray>& rays) {
    set_rays(rays);
    run_closest();
    return hits();
}

std::vector<std::int32_t> RayTracer::trace_any(const std::vector<Ray>& rays) {
    set_rays(rays);
    run_any();
    return occluded();
}

} // namespace tristim
