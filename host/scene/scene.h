#pragma once

#include "scene/source_location.h"
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
using Imath::V2f;
using Imath::V3d;
using Imath::V3f;

/// One homogeneous layer of a thin film, of complex index eta + ik.
struct FilmLayer {
    double thickness = 0.0; ///< nm, ≥ 0
    Spectrum eta = Spectrum::constant(1.5);
    Spectrum k = Spectrum::constant(0.0); ///< ≥ 0
};

/// A stack of layers on a surface, the outermost first; no layers: no film. What lies outside has index 1.
struct Film {
    std::vector<FilmLayer> layers;
    int thickness_texture = -1; ///< index into Scene::textures: thickness of the first and only layer; -1: none
};

/// A surface's scattering. Spectra that a kind does not use stay at their defaults.
struct Material {
    enum class Kind { Diffuse, Dielectric, Conductor };
    Kind kind = Kind::Diffuse;
    std::string name;                               ///< for messages: the user's, else the kind
    SourceLocation where;                           ///< where it was made; as all `where`s, of no file if in code
    Spectrum reflectance = Spectrum::constant(0.5); ///< Diffuse: albedo in [0,1]
    Spectrum eta = Spectrum::constant(1.5);         ///< Dielectric: index inside over outside. Conductor: real part.
                                                    ///< Diffuse with a film: index of what lies under the film
    Spectrum k = Spectrum::constant(0.0);           ///< Conductor: imaginary part of the index, ≥ 0
    double alpha_u = 0.0; ///< GGX roughness along ∂p/∂u (Trowbridge–Reitz α, after pbrt's remapping); 0: smooth
    double alpha_v = 0.0; ///< and across it
    Film film;
};

/// A grey image or pattern over a surface, pbrt's "float" textures.
struct Texture {
    enum class Kind { Bilinear, Image };
    enum class Mapping { Uv, Planar, Spherical, Cylindrical };
    enum class Wrap { Repeat, Clamp, Black };
    std::string name;     ///< for messages
    SourceLocation where; ///< of the directive
    Kind kind = Kind::Bilinear;
    Mapping mapping = Mapping::Uv;
    M44d world_to_texture;                      ///< Imath convention; Planar: (x, y) of the result is (s, t)
    std::array<double, 4> uv_scale{1, 1, 0, 0}; ///< Uv: s = u·[0] + [2], t = v·[1] + [3]
    std::array<double, 4> corners{}; ///< Bilinear: values at (0,0), (0,1), (1,0), (1,1) (pbrt's v00 v01 v10 v11)
    int width = 0, height = 0;       ///< Image: texels, row by row from the top, scaled and decoded
    std::vector<float> texels;
    Wrap wrap = Wrap::Repeat;
    double outside = 0.0; ///< Image with Wrap::Black: the value beyond the border
};

/// Triangles in world space, in double precision until single-precision coordinates can count from the scene's middle
/// (FlatScene::origin). `normals` is empty or holds one unit shading normal per vertex. The geometric normal of a
/// triangle is (v1−v0)×(v2−v0), already turned for ReverseOrientation and mirroring transforms; area lights emit and
/// "inside" lies on the side away from it.
struct Mesh {
    std::vector<V3d> positions;
    std::vector<V3f> normals;
    std::vector<V2f> uv; ///< empty (then pbrt's (0,0), (1,0), (1,1) for each triangle) or one per vertex
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// One mesh with its material and, if it emits, its area light.
struct Shape {
    Mesh mesh;
    int material = 0;          ///< index into Scene::materials
    int area_light = -1;       ///< index into Scene::lights, or -1
    SourceLocation where = {}; ///< of the directive, Shape or ObjectInstance
};

/// A light. `emission` is normalised to Y = 1 (paper's equation 3), `scale` carries everything else, so that
/// emission·scale is intensity (point, spot: W·sr⁻¹·nm⁻¹), irradiance at normal incidence (distant: W·m⁻²·nm⁻¹) or
/// radiance (infinite, area: W·m⁻²·sr⁻¹·nm⁻¹). For a light given as "rgb", emission is the coloured spectrum
/// normalised by its white part only, as in pbrt-v4.
struct Light {
    enum class Kind { Point, Spot, Distant, Infinite, Area };
    Kind kind = Kind::Point;
    SourceLocation where; ///< of the directive
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
    SourceLocation where; ///< of the directive
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
    std::vector<Texture> textures;
    std::vector<Light> lights;
    std::vector<Shape> shapes;
    std::vector<std::string> notes; ///< "file:line: …" for accepted but ignored directives and dropped triangles
};

/// Reads a scene file in pbrt-v4 syntax (the subset in README) with its includes and meshes. `rgb_upsampling` overrides
/// the scene's Option "string rgbupsampling". Throws Error "file:line: …" for anything unknown, missing, malformed or
/// non-finite.
Scene load_scene(const std::string& path, std::optional<RgbUpsampling> rgb_upsampling = std::nullopt);

} // namespace tristim
