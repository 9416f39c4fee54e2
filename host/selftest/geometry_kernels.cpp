#include "selftest/geometry_kernels.h"

#include "base/error.h"
#include "render/flat_scene.h"

namespace tristim::selftest {
namespace {

constexpr int stack_size = 96;
constexpr std::size_t work_group_size = 64; // one for all, as PoCL compiles anew for each

Macros macros(const Device& device) {
    return {{"BVH_WIDTH", std::to_string(device.tuning.bvh_width)},
            {"BVH_STACK_SIZE", std::to_string(stack_size)},
            {"HAS_AREA_LIGHT", "1"}};
}

} // namespace

GeometryMesh::GeometryMesh(const Device& device, const TriangleSoup& mesh) : soup(mesh) {
    const Bvh bvh = build_bvh(soup, device.tuning.bvh_width);
    if (bvh.stack_size > stack_size)
        fail("the tree of a mesh of {} triangles needs a stack of {}", soup.v0.size(), bvh.stack_size);
    for (std::size_t i = 0; i < soup.v0.size(); ++i)
        triangles.push_back(flat_triangle(soup.v0[i], soup.v1[i], soup.v2[i]));
    nodes = Buffer<std::uint32_t>(device, "BVH nodes", bvh.nodes.words());
    leaves = Buffer<std::uint32_t>(device, "BVH leaves", bvh.leaves.words());
    on_device = Buffer<Triangle>(device, "triangles", triangles);
}

GeometryKernels::GeometryKernels(const Setting& setting)
    : device_(setting.device), program_(build(setting, "geometry.cl", macros(setting.device))) {}

GeometryKernels::GeometryKernels(const Device& device, const std::string& text)
    : device_(device), program_(build_program_from_text(device, "geometry.cl", text, macros(device), {})) {}

template <typename... Arguments>
void GeometryKernels::run(const char* name, std::size_t count, const Arguments&... arguments) const {
    ::cl::Kernel kernel(program_, name);
    cl_uint index = 0;
    (kernel.setArg(index++, arguments.cl()), ...);
    kernel.setArg(index, static_cast<cl_uint>(count));
    const std::size_t padded = (count + work_group_size - 1) / work_group_size * work_group_size;
    device_.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(padded), ::cl::NDRange(work_group_size));
}

std::vector<RayHit> GeometryKernels::hit_leaves(const BvhBlocks& leaves, const std::vector<Ray>& rays) const {
    const Buffer<RayHit> hits(device_, "hits", rays.size());
    run("hit_leaves", rays.size(), Buffer<std::uint32_t>(device_, "leaves", leaves.words()),
        Buffer<Ray>(device_, "rays", rays), hits);
    return hits.read(device_);
}

std::vector<RayHit> GeometryKernels::closest(const GeometryMesh& mesh, const std::vector<Ray>& rays) const {
    const Buffer<RayHit> hits(device_, "hits", rays.size());
    run("trace_closest", rays.size(), mesh.nodes, mesh.leaves, Buffer<Ray>(device_, "rays", rays), hits);
    return hits.read(device_);
}

std::vector<std::int32_t> GeometryKernels::any(const GeometryMesh& mesh, const std::vector<Ray>& rays) const {
    const Buffer<std::int32_t> occluded(device_, "occluded", rays.size());
    run("trace_any", rays.size(), mesh.nodes, mesh.leaves, Buffer<Ray>(device_, "rays", rays), occluded);
    return occluded.read(device_);
}

std::vector<Ray> GeometryKernels::leave(const GeometryMesh& mesh, const std::vector<RayHit>& hits,
                                        const std::vector<cl_float4>& directions) const {
    const Buffer<Ray> leaving(device_, "rays", hits.size());
    run("leave_surfaces", hits.size(), mesh.on_device, Buffer<RayHit>(device_, "hits", hits),
        Buffer<cl_float4>(device_, "directions", directions), leaving);
    return leaving.read(device_);
}

std::vector<Ray> GeometryKernels::shadows(const GeometryMesh& mesh, const std::vector<RayHit>& hits,
                                          const SceneLight& light, const std::vector<cl_float4>& u) const {
    const Buffer<Ray> shadows(device_, "rays", hits.size());
    run("shadow_rays", hits.size(), mesh.on_device, Buffer<RayHit>(device_, "hits", hits),
        Buffer<SceneLight>(device_, "light", std::vector{light}), Buffer<cl_float4>(device_, "u", u), shadows);
    return shadows.read(device_);
}

std::vector<Ray> GeometryKernels::emitted(const SceneLight& light, const std::vector<cl_float4>& u) const {
    const Buffer<Ray> rays(device_, "rays", u.size());
    run("emitted_rays", u.size(), Buffer<SceneLight>(device_, "light", std::vector{light}),
        Buffer<cl_float4>(device_, "u", u), rays);
    return rays.read(device_);
}

} // namespace tristim::selftest
