#pragma once

#include "selftest/geometry_kernels.h"
#include "selftest/geometry_oracle.h"

namespace tristim::selftest {

/// What the cases of geometry_cases.cpp measure, for any build of the kernels.

/// hit_error() of triangles of all shapes in a cube of ±scale, by the scale; and by the distance from the origin in
/// units of the triangles' size, the aspect ratio of needles, and the cosine between ray and normal.
Measurement hits_by_scale(const GeometryKernels& kernels, const Setting& setting);
Measurement hits_by_distance(const GeometryKernels& kernels, const Setting& setting);
Measurement hits_by_aspect(const GeometryKernels& kernels, const Setting& setting);
Measurement hits_by_cosine(const GeometryKernels& kernels, const Setting& setting);

/// Rays that get out of closed meshes, aimed at vertices, at edges and anywhere, by the meshes' scale and by their
/// distance from the origin in units of their size.
Measurement leaks_by_scale(const GeometryKernels& kernels, const Setting& setting);
Measurement leaks_by_distance(const GeometryKernels& kernels, const Setting& setting);

/// Of `rays` rays from inside a mesh, those that meet nothing.
std::size_t leaks(const GeometryKernels& kernels, const GeometryMesh& mesh, const V3d& centre, double scale,
                  std::size_t rays, Random& random);

/// Rays that leave a surface and meet it again, or pass through another one close by: at a distance of `gap` times the
/// spacing of floats at the largest coordinate. By scale, by distance as above, by the cosine between the leaving ray
/// and the normal, and by the aspect ratio.
Measurement leaving_by_scale(const GeometryKernels& kernels, const Setting& setting);
Measurement leaving_by_distance(const GeometryKernels& kernels, const Setting& setting);
Measurement leaving_by_cosine(const GeometryKernels& kernels, const Setting& setting);
Measurement leaving_by_aspect(const GeometryKernels& kernels, const Setting& setting);

/// Half the spacing of floats at the largest coordinate, times this, is how close surfaces may lie to each other.
inline constexpr double near_gap = 64.0;

/// A rectangle, its neighbours on both sides, and rays that leave it.
struct LeavingCase {
    double scale = 1.0;    ///< half the rectangle's longer side
    double aspect = 1.0;   ///< of its sides
    double distance = 0.0; ///< from the origin to its centre, over scale
    double cosine = -1.0;  ///< of leaving rays with the normal; negative: any
    double gap = near_gap; ///< to the neighbours
};
/// How many of `rays` go wrong: meet the rectangle or miss the neighbour.
std::size_t leaving_errors(const GeometryKernels& kernels, const LeavingCase& c, std::size_t rays, Random& random);

/// Rays that leave a finely faceted sphere outwards and meet it again, or inwards and get out: also from edges and
/// vertices.
Measurement leaving_meshes(const GeometryKernels& kernels, const Setting& setting);

/// An area light and a surface that face each other.
struct ShadowCase {
    double light_size = 1.0;
    double distance = 1.0; ///< over the light's size
    bool origin_on_light = false;
};
/// How many of `rays` shadow rays meet anything, and of as many photons meet the light again.
std::size_t shadow_errors(const GeometryKernels& kernels, const ShadowCase& c, std::size_t rays, Random& random);

/// Shadow rays and photons between an area light and a surface with nothing between them that meet something, by the
/// distance over the light's size.
Measurement shadows_by_distance(const GeometryKernels& kernels, const Setting& setting);

} // namespace tristim::selftest
