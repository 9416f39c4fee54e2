#pragma once

#include "opencl/device.h"
#include "render/options.h"
#include "scene/scene.h"
#include "test_device.h"

#include <cstdlib>
#include <functional>
#include <string>

namespace tristim::test {

/// Whether the long statistical tests were asked for (TRISTIM_LONG_TESTS=1 in the environment).
bool long_tests();

/// A folder of this process for what a failed test leaves to look at.
std::string failure_folder();

/// A camera at `eye` that looks at `target`; fov in degrees over the shorter side of the image.
Camera look_at(const V3d& eye, const V3d& target, const V3d& up, double fov_degrees);

/// Add a material and return its index.
int add_diffuse(Scene& scene, const Spectrum& reflectance);
int add_dielectric(Scene& scene, const Spectrum& eta);
int add_conductor(Scene& scene, const Spectrum& eta, const Spectrum& k);

/// Puts a film on a material, and returns the material.
int with_film(Scene& scene, int material, const std::vector<FilmLayer>& layers);

/// A uniform environment of radiance 1 times the spectrum.
Light environment(const Spectrum& emission);

/// Adds an area light and returns its index.
int add_area_light(Scene& scene, const Spectrum& emission, double radiance);

/// Add triangles. A parallelogram's normal is edge1 × edge2; a box faces outwards, or inwards; a sphere faces outwards.
void add_parallelogram(Scene& scene, const V3d& corner, const V3d& edge1, const V3d& edge2, int material,
                       int area_light = -1);
void add_box(Scene& scene, const V3d& low, const V3d& high, bool inwards, int material, int area_light = -1);
void add_sphere(Scene& scene, double radius, int subdivisions, bool vertex_normals, int material,
                const V3d& centre = V3d(0.0));

/// The horizontal square |x|, |y| <= half_side at height z, facing up or down.
void add_horizontal_square(Scene& scene, double half_side, double z, bool up, int material);

/// A large horizontal plane of reflectance 0.5 at height 0, seen from above, under a point light of D65 at `light`.
Scene plane_under_point_light(const V3d& light, double fov_degrees);

/// Its radiance at a point of the plane, over the spectrum: E/π times the reflectance, E = I h/d³.
double plane_radiance(const Light& light, const V3d& point);

/// Options for a small image of a scene with an initial radius given.
RenderOptions small_render(const std::string& method, int width, int height, int photons, double radius, int max_depth);

/// A ray of the camera, computed in double precision by the convention of scene.h; raster coordinates in pixels.
struct CameraRay {
    V3d origin;
    V3d direction; ///< unit
};
CameraRay camera_ray(const Camera& camera, int width, int height, double raster_x, double raster_y);

/// The mean of a function over the area of a pixel: 8×8 midpoints, for functions that are smooth there.
double pixel_mean(const Camera& camera, int width, int height, int x, int y,
                  const std::function<double(const CameraRay&)>& radiance);

/// Where a ray meets the plane z = height.
V3d at_height(const CameraRay& ray, double height);

/// The mean over a disc of squared radius r² about the origin of a function of a horizontal offset, exact for quadratic
/// ones: what photon density estimation in a plane measures.
double disc_mean(double squared_radius, const std::function<double(double, double)>& f);

/// The mean of r²_i over passes 0 … passes − 1 of the global schedule.
double mean_squared_radius(double initial_radius, int passes);

} // namespace tristim::test
