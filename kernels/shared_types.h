// Structs that host and device share. Plain 4-byte floats and ints only: a vector type would bring padding that differs
// between the two. The host checks sizes and offsets with static_assert, the tests ask the device for its own.
#ifndef TRISTIM_SHARED_TYPES_H
#define TRISTIM_SHARED_TYPES_H

#ifdef __OPENCL_VERSION__
#include "config.h"
typedef uint tristim_uint;
#else
#include <cstdint>
namespace tristim {
typedef std::uint32_t tristim_uint;
#endif

// The pass's wavelengths and every spectrum of the scene at them, filled by wavelengths.cl: rows of W_PADDED floats.
//   row 0         λ in nm
//   rows 1 to 3   weights c_w of X, Y and Z: XYZ = Σ_w c_w L(λ_w); zero in the padding
//   row 4 + s     spectrum s of the scene; behind them the rows that film_tables.cl fills
#define PASS_TABLE_SPECTRA 4

// Nodes and leaves of the BVH are rows of BVH_WIDTH values each, so that a device reads a row at once. These are the rows' numbers;
// of three coordinates the first is x. The host writes them as host/bvh/bvh.h's BvhBlocks, with a width for each device.
#define BVH_LOW 0
#define BVH_HIGH 3
#define BVH_CHILD 6
#define BVH_NODE_ROWS 8
#define BVH_V0 0
#define BVH_V1 3
#define BVH_V2 6
#define BVH_ID 9
#define BVH_LEAF_ROWS 10

#ifdef __OPENCL_VERSION__
// BVH_WIDTH children; 256 bytes if that is 8. child >= 0 is a node, child < 0 is ~leaf. Empty slots have bounds low = +1e18,
// high = -1e18.
typedef struct BvhNode {
    float low_x[BVH_WIDTH], low_y[BVH_WIDTH], low_z[BVH_WIDTH];
    float high_x[BVH_WIDTH], high_y[BVH_WIDTH], high_z[BVH_WIDTH];
    int child[BVH_WIDTH];
    int unused[BVH_WIDTH];
} BvhNode;

// BVH_WIDTH triangles; 320 bytes if that is 8. Empty lanes have id = -1 and degenerate vertices.
typedef struct BvhLeaf {
    float v0_x[BVH_WIDTH], v0_y[BVH_WIDTH], v0_z[BVH_WIDTH];
    float v1_x[BVH_WIDTH], v1_y[BVH_WIDTH], v1_z[BVH_WIDTH];
    float v2_x[BVH_WIDTH], v2_y[BVH_WIDTH], v2_z[BVH_WIDTH];
    int id[BVH_WIDTH];
} BvhLeaf;
#endif

// A ray for the stand-alone traversal kernel, 32 bytes. Hits lie at 0 < t < t_max in units of |direction|, which should be
// about 1.
typedef struct Ray {
    float origin_x, origin_y, origin_z;
    float t_max;
    float direction_x, direction_y, direction_z;
    float unused;
} Ray;

// Where a ray hit, 16 bytes: point = (1-u-v) v0 + u v1 + v v2; triangle = -1 if it hit nothing.
typedef struct RayHit {
    float t;
    int triangle;
    float u, v;
} RayHit;

// The camera, the scene's extent and what is the same for every pass, 128 bytes. A raster point (x, y), in pixels from the
// top left corner of the whole image, is seen along corner + x·right + y·down (not normalised; its component along the
// camera's axis is 1, so that focal_distance times it lies in the plane of focus).
typedef struct SceneConstants {
    float camera_x, camera_y, camera_z;
    float lens_radius;
    float corner_x, corner_y, corner_z;
    float focal_distance;
    float right_x, right_y, right_z;
    int light_count;
    float down_x, down_y, down_z;
    int region_x;
    float centre_x, centre_y, centre_z;  // of the scene's bounding sphere
    float radius;
    float lens_right_x, lens_right_y, lens_right_z;  // unit vectors that span the lens
    int region_y;
    float lens_up_x, lens_up_y, lens_up_z;
    int region_width;
    int region_height;
    int infinite_light;  // index of the light that a ray sees that hits nothing, or -1
    int image_width;
    int image_height;
} SceneConstants;

// A triangle as the shading needs it, 64 bytes: point = v0 + u edge1 + v edge2.
typedef struct Triangle {
    float v0_x, v0_y, v0_z;
    int material;
    float edge1_x, edge1_y, edge1_z;
    int light;  // the area light on it, or -1
    float edge2_x, edge2_y, edge2_z;
    int attributes;  // index of its first vertex attribute, or -1: three normals (0: as the triangle), then three pairs u, v if HAS_UV
    float normal_x, normal_y, normal_z;  // unit geometric normal
    float extent;  // largest |coordinate| of its vertices, see offset_from_triangle
} Triangle;

#define MATERIAL_DIFFUSE 0
#define MATERIAL_DIELECTRIC 1
#define MATERIAL_CONDUCTOR 2

// A material, 64 bytes; reflectance, eta, k and internal_reflectance are rows of the table of spectra.
typedef struct SurfaceMaterial {
    int kind;
    int reflectance;
    int eta;
    int k;
    int dispersive;  // a dielectric whose eta depends on the wavelength
    int film;        // index of its film's outermost layer, the others follow
    int film_layers;
    int film_texture;  // thickness of the first layer in nm, or -1
    float alpha_u, alpha_v;  // GGX roughness along the surface's tangent and across; 0: smooth
    int takes_photons;  // rough enough to be a visible point
    // Of a coated diffuse surface: the reflectance of its film for diffuse light from below, in internal_rows rows (0: not
    // tabulated) for thicknesses of the first layer from internal_thickness nm on in steps of internal_step.
    int internal_reflectance, internal_rows;
    float internal_thickness, internal_step;
    int unused;
} SurfaceMaterial;

// A layer of a thin film, 16 bytes: index eta + ik, rows of the table of spectra.
typedef struct SceneFilmLayer {
    float thickness;  // nm
    int eta;
    int k;
    int unused;
} SceneFilmLayer;

#define TEXTURE_BILINEAR 0
#define TEXTURE_IMAGE 1
#define MAPPING_UV 0
#define MAPPING_PLANAR 1
#define MAPPING_SPHERICAL 2
#define MAPPING_CYLINDRICAL 3
#define WRAP_REPEAT 0
#define WRAP_CLAMP 1
#define WRAP_BLACK 2

// A texture of single values, 96 bytes. to_texture, row by row, takes a world point as a column vector to texture space (planar
// mapping: to s, t); for uv mapping to_texture[0] and [5] scale u and v, [3] and [7] shift them. An image's texels lie row by
// row from the top.
typedef struct SceneTexture {
    int kind;
    int mapping;
    int wrap;
    int first_texel;
    int width, height;
    float corners[4];  // values at (0,0), (0,1), (1,0), (1,1)
    float outside;  // of an image with WRAP_BLACK, beyond its border
    int unused;
    float to_texture[12];
} SceneTexture;

#define LIGHT_POINT 0
#define LIGHT_SPOT 1
#define LIGHT_DISTANT 2
#define LIGHT_INFINITE 3
#define LIGHT_AREA 4

// A light, 96 bytes. An area light is one triangle: position is v0, direction its unit normal.
typedef struct SceneLight {
    int kind;
    int spectrum;       // row of the table of spectra, normalised to Y = 1
    float scale;        // times the spectrum: intensity, irradiance or radiance, as host/scene/scene.h says
    float probability;  // with which it is chosen, in proportion to its power
    float position_x, position_y, position_z;
    float cos_total_width;
    float direction_x, direction_y, direction_z;
    float cos_falloff_start;
    float edge1_x, edge1_y, edge1_z;
    float area;
    float edge2_x, edge2_y, edge2_z;
    int two_sided;
    float extent;  // of an area light's triangle
    int unused[3];
} SceneLight;

// Values of slot in visible points and photons that are not the number of a single wavelength.
#define SLOT_ALL (-1)   // every wavelength of the pass
#define SLOT_NONE (-2)  // no visible point: the camera path ended without meeting a diffuse surface

// Where a camera path met a diffuse surface, 48 bytes. throughput is the same for every wavelength it holds for, unless
// the scene has coloured specular surfaces (COLOURED_EYE), when slot = SLOT_ALL refers to a row of its own.
typedef struct VisiblePoint {
    float x, y, z;
    tristim_uint normal;  // octahedral, on the side that the path came from
    float throughput;
    int slot;
    float direct_x, direct_y, direct_z;  // XYZ of emission seen and of direct light, throughput included
    float radius;                        // of this pass's search for photons, scene units
    tristim_uint camera_rays, shadow_rays;  // traced for it
} VisiblePoint;

// A photon on a diffuse surface, 32 bytes. Flux is multiplied by the surface's BRDF (reflectance/π), so that the
// reflected radiance is a plain sum: X, Y, Z over every wavelength that the photon carries.
typedef struct Photon {
    float x, y, z;
    tristim_uint normal;  // octahedral, on the side that the photon came from
    float flux_x, flux_y, flux_z;
    int slot;
} Photon;

// What a rough surface does to a photon depends on directions, 20 bytes beside each visible point; material = -1 on a diffuse
// surface.
typedef struct VisibleSurface {
    int material;
    int outside;            // whether the camera path came from outside
    tristim_uint outgoing;  // octahedral, towards the camera path
    tristim_uint tangent;   // octahedral, of the frame in which the roughness is given
    float thickness;        // nm, of the film's first layer
} VisibleSurface;

// Beside each photon, 8 bytes: where it lies, and where it came from. On a rough surface its flux is not multiplied by anything.
typedef struct PhotonSurface {
    int side;               // -1 on a diffuse surface; else twice the material, and 1 more if it came from outside
    tristim_uint incident;  // octahedral, back along the photon's path
} PhotonSurface;

// The least radius of a search for photons. Points of a triangle are known to a few units in the last place of its largest coordinate,
// 2^-23 of Triangle::extent. Discs of two such units' radius and less hold up to a quarter too many or too few photons (measured by
// `tristim selftest`), from four on as many as they should. And below SMALLEST_RADIUS squares are no normal floats.
#define SMALLEST_RELATIVE_RADIUS 0x1p-20f
#define SMALLEST_RADIUS 0x1p-60f
// Beyond this they come near to overflow.
#define LARGEST_RADIUS 0x1p60f

// Running sums of one pixel, in floats that do not overlap, 96 bytes. The samples' sum has some 72 bits, so that the order of the
// passes does not show (film.cl).
typedef struct FilmPixel {
    float sum_high[3], sum_middle[3], sum_low[3];
    float square_high[3], square_low[3];  // square_high is infinite once a sample was too large to be squared
    tristim_uint samples;
    tristim_uint rejected;  // samples that were not finite
    float statistics_radius, statistics_radius_low;  // --radius statistics: r,
    float statistics_count, statistics_count_low;    // and the photons counted so far
    tristim_uint camera_rays, shadow_rays;  // traced so far, modulo 2^32
    tristim_uint ray_carries;  // how often these ran over: camera rays in the low 16 bits, shadow rays in the high ones
} FilmPixel;

// What errors are estimated from: planes of one float for each pixel. Three (X, Y, Z) for each group of each level, then the sums of
// the bias and of its square. A level's batches are 4 times as long as those of the one before; the first one's hold 2 passes.
#define ERROR_LEVELS 6
#define ERROR_GROUP_BITS 3
#define ERROR_GROUPS (1 << ERROR_GROUP_BITS)
#define ERROR_BIAS_PLANE (3 * ERROR_LEVELS * ERROR_GROUPS)
#define ERROR_PLANES (ERROR_BIAS_PLANE + 6)

// Counts of values that were not finite, by the kernel that left them out: two uints each, the low one first. The film counts by
// pixel. Behind them, of work-items whose loops the device ended early.
#define NON_FINITE_EYE 0
#define NON_FINITE_PHOTON 1
#define NON_FINITE_GATHER 2
#define CUT_LOOPS 3
#define NON_FINITE_COUNTS 4

#ifndef __OPENCL_VERSION__
static_assert(sizeof(Ray) == 32 && sizeof(RayHit) == 16);
static_assert(sizeof(SceneConstants) == 128 && sizeof(Triangle) == 64 && sizeof(SurfaceMaterial) == 64);
static_assert(sizeof(SceneFilmLayer) == 16 && sizeof(SceneTexture) == 96);
static_assert(sizeof(SceneLight) == 96 && sizeof(VisiblePoint) == 48 && sizeof(Photon) == 32);
static_assert(sizeof(FilmPixel) == 96 && sizeof(VisibleSurface) == 20 && sizeof(PhotonSurface) == 8);
} // namespace tristim
#endif

#endif
