#pragma once

#include "spectra/spectrum.h"

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tristim {

using Imath::M44d;
using Imath::V3d;
using Imath::V3f;

/// A surface's scattering. Spectra that a kind does not use stay at their defaults.
struct Material {
    enum class Kind { Diffuse, Dielectric, Conductor };
    Kind kind = Kind::Diffuse;
    std::string name;                               ///< for messages
    Spectrum reflectance = Spectrum::constant(0.5); ///< Diffuse: albedo in [0,1]
    Spectrum eta = Spectrum::constant(1.5);         ///< Dielectric: index inside over outside. Conductor: real part
    Spectrum k = Spectrum::constant(0.0);           ///< Conductor: imaginary part of the index, ≥ 0
};

/// Triangles in world space. `normals` is empty or holds one unit shading normal per vertex. The geometric normal of a
/// triangle is (v1−v0)×(v2−v0), already turned for ReverseOrientation and mirroring transforms; area lights emit and
/// "inside" lies on the side away from it.
struct Mesh {
    std::vector<V3f> positions;
    std::vector<V3f> normals;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// One mesh with its material and, if it emits, its area light.
struct Shape {
    Mesh mesh;
    int material = 0;    ///< index into Scene::materials
    int area_light = -1; ///< index into Scene::lights, or -1
};

/// A light. `emission` is normalised to Y = 1 (paper's equation 3), `scale` carries everything else, so that
/// emission·scale is intensity (point, spot: W·sr⁻¹·nm⁻¹), irradiance at normal incidence (distant: W·m⁻²·nm⁻¹) or
/// radiance (infinite, area: W·m⁻²·sr⁻¹·nm⁻¹). For a light given as "rgb", emission is the coloured spectrum
/// normalised by its white part only, as in pbrt-v4.
struct Light {
    enum class Kind { Point, Spot, Distant, Infinite, Area };
    Kind kind = Kind::Point;
    Spectrum emission = Spectrum::constant(1.0);
    double scale = 1.0;
    V3d position{0.0};              ///< world space; Point, Spot
    V3d direction{0.0, 0.0, 1.0};   ///< unit, world space, along the emitted light; Spot axis, Distant
    double cos_total_width = 0.0;   ///< Spot: zero intensity beyond (cos of "coneangle")
    double cos_falloff_start = 0.0; ///< Spot: full intensity within; cubic smoothstep between
    bool two_sided = false;         ///< Area
};

/// A pinhole or thin-lens perspective camera in pbrt's convention: camera space has x right, y up, z forward.
/// A raster point (x right, y down, in pixels) maps to the camera-space direction
/// (lerp(x/width, screen_min.x, screen_max.x)·tan(fov/2), lerp(y/height, screen_max.y, screen_min.y)·tan(fov/2), 1).
struct Camera {
    M44d camera_to_world; ///< Imath convention: row vectors, p_world = p_camera * camera_to_world
    double fov_degrees = 90.0;
    std::optional<std::array<double, 4>> screen_window; ///< x0, x1, y0, y1; default from the aspect ratio as in pbrt
    double lens_radius = 0.0;
    double focal_distance = 1e6;
};

/// What the scene file says of the render itself; flags override it.
struct RenderSettings {
    int width = 1280;
    int height = 720;
    std::string filename = "tristim.exr";
    std::optional<int> photons_per_pass;  ///< Integrator "sppm" "photonsperiteration"
    std::optional<double> initial_radius; ///< Integrator "sppm" "radius", scene units
    std::optional<int> max_depth;         ///< Integrator "maxdepth"
    std::optional<int> passes;            ///< Sampler "pixelsamples"
    std::optional<std::uint32_t> seed;
};

/// Everything that a scene file describes, with all instances and transforms applied.
struct Scene {
    std::string path;
    Camera camera;
    RenderSettings settings;
    std::vector<Material> materials;
    std::vector<Light> lights;
    std::vector<Shape> shapes;
    std::vector<std::string> notes; ///< "file:line: …" for accepted but ignored directives and dropped triangles
};

/// Reads a scene file in pbrt-v4 syntax (the subset in README) with its includes and meshes.
/// Throws Error "file:line: …" for anything unknown, missing, malformed or non-finite.
Scene load_scene(const std::string& path);

} // namespace tristim
