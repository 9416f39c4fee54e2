#include "selftest/geometry_measures.h"

#include <map>
#include <utility>

namespace tristim::selftest {
namespace {

using Measure = Measurement (*)(const GeometryKernels&, const Setting&);

/// The kernels as the cases share them, built once for each device and arithmetic.
const GeometryKernels& shared_kernels(const Setting& setting) {
    static std::map<std::pair<cl_device_id, bool>, GeometryKernels>& built =
        *new std::map<std::pair<cl_device_id, bool>, GeometryKernels>; // outlives the OpenCL implementation
    const auto key = std::pair{setting.device.device(), setting.fast_math};
    const auto found = built.find(key);
    return found != built.end() ? found->second : built.emplace(key, GeometryKernels(setting)).first->second;
}

Case geometry_case(const char* name, const char* parameter, const char* error, double bound, Measure measure) {
    return {"geometry", name, parameter, error, bound, bound, [measure](const Setting& setting) {
                return measure(shared_kernels(setting), setting);
            }};
}

} // namespace

std::vector<Case> geometry_cases() {
    // Translating and shearing a vertex takes some ten roundings of 2^-24 (see offset_from_triangle), 6e-7 if all are
    // at their worst, weighting the vertices three more each.
    constexpr double rounding = 1e-6;
    const char* hit = "hit point, over coordinates from the ray's origin";
    const char* leaked = "rays that get out";
    const char* wrong = "rays that meet what they left";
    return {
        geometry_case("hits, scale 1e-6 to 1e6", "scale", hit, rounding, hits_by_scale),
        geometry_case("hits, 0.1 to 1e6 sizes from the origin", "distance / size", hit, rounding, hits_by_distance),
        geometry_case("hits on needles, aspect ratio 1 to 1e7", "aspect ratio", hit, rounding, hits_by_aspect),
        geometry_case("hits, cosine 1 to 1e-8", "cosine", hit, rounding, hits_by_cosine),
        geometry_case("closed meshes, scale 1e-6 to 1e6", "scale", leaked, 0.0, leaks_by_scale),
        geometry_case("closed meshes, 1 to 1e4 sizes away", "distance / size", leaked, 0.0, leaks_by_distance),
        geometry_case("leaving, scale 1e-6 to 1e6", "scale", wrong, 0.0, leaving_by_scale),
        geometry_case("leaving, 0.1 to 1e4 sizes from the origin", "distance / size", wrong, 0.0, leaving_by_distance),
        geometry_case("leaving, cosine 1 to 1e-7", "cosine", wrong, 0.0, leaving_by_cosine),
        geometry_case("leaving needles, aspect ratio 1 to 1e6", "aspect ratio", wrong, 0.0, leaving_by_aspect),
        geometry_case("leaving edges and corners of meshes", "distance / size", wrong, 0.0, leaving_meshes),
        geometry_case("shadow rays, light 1 to 1e6 sizes away", "distance / size", "rays that meet something", 0.0,
                      shadows_by_distance),
    };
}

} // namespace tristim::selftest
