#include "test_scenes.h"

#include "meshes/icosphere.h"
#include "scene/geometry.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <unistd.h>

namespace tristim::test {
namespace {

V3f to_float(const V3d& v) {
    return V3f(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
}

int add_material(Scene& scene, const Material& material) {
    scene.materials.push_back(material);
    return static_cast<int>(scene.materials.size()) - 1;
}

} // namespace

bool long_tests() {
    const char* value = std::getenv("TRISTIM_LONG_TESTS");
    return value != nullptr && std::string(value) == "1";
}

std::string failure_folder() {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("tristim-failed-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    return folder.string();
}

Camera look_at(const V3d& eye, const V3d& target, const V3d& up, double fov_degrees) {
    const V3d forward = (target - eye).normalized();
    const V3d right = forward.cross(up).normalized();
    const V3d upwards = right.cross(forward);
    Camera camera;
    camera.fov_degrees = fov_degrees;
    camera.camera_to_world = M44d(right.x, right.y, right.z, 0, upwards.x, upwards.y, upwards.z, 0, forward.x,
                                  forward.y, forward.z, 0, eye.x, eye.y, eye.z, 1);
    return camera;
}

int add_diffuse(Scene& scene, const Spectrum& reflectance) {
    Material material;
    material.kind = Material::Kind::Diffuse;
    material.reflectance = reflectance;
    return add_material(scene, material);
}

int add_dielectric(Scene& scene, const Spectrum& eta) {
    Material material;
    material.kind = Material::Kind::Dielectric;
    material.eta = eta;
    return add_material(scene, material);
}

int add_conductor(Scene& scene, const Spectrum& eta, const Spectrum& k) {
    Material material;
    material.kind = Material::Kind::Conductor;
    material.eta = eta;
    material.k = k;
    return add_material(scene, material);
}

int with_film(Scene& scene, int material, const std::vector<FilmLayer>& layers) {
    scene.materials[static_cast<std::size_t>(material)].film.layers = layers;
    return material;
}

Light environment(const Spectrum& emission) {
    Light light;
    light.kind = Light::Kind::Infinite;
    light.emission = emission;
    return light;
}

int add_area_light(Scene& scene, const Spectrum& emission, double radiance) {
    Light light;
    light.kind = Light::Kind::Area;
    light.emission = emission;
    light.scale = radiance;
    scene.lights.push_back(light);
    return static_cast<int>(scene.lights.size()) - 1;
}

void add_parallelogram(Scene& scene, const V3d& corner, const V3d& edge1, const V3d& edge2, int material,
                       int area_light) {
    scene.shapes.push_back(parallelogram(corner, edge1, edge2, material, area_light));
}

void add_box(Scene& scene, const V3d& low, const V3d& high, bool inwards, int material, int area_light) {
    const V3d size = high - low;
    for (int axis = 0; axis < 3; ++axis) {
        V3d u(0.0);
        V3d v(0.0);
        V3d w(0.0);
        u[(axis + 1) % 3] = size[(axis + 1) % 3];
        v[(axis + 2) % 3] = size[(axis + 2) % 3];
        w[axis] = size[axis];
        add_parallelogram(scene, low, inwards ? u : v, inwards ? v : u, material, area_light);
        add_parallelogram(scene, low + w, inwards ? v : u, inwards ? u : v, material, area_light);
    }
}

void add_sphere(Scene& scene, double radius, int subdivisions, bool vertex_normals, int material, const V3d& centre) {
    const Icosphere sphere = make_icosphere(subdivisions);
    Shape shape;
    for (const V3d& position : sphere.positions) {
        shape.mesh.positions.push_back(centre + radius * position);
        if (vertex_normals)
            shape.mesh.normals.push_back(to_float(position));
    }
    shape.mesh.triangles = sphere.triangles;
    shape.material = material;
    scene.shapes.push_back(shape);
}

void add_horizontal_square(Scene& scene, double half_side, double z, bool up, int material) {
    const V3d x(2.0 * half_side, 0.0, 0.0);
    const V3d y(0.0, 2.0 * half_side, 0.0);
    add_parallelogram(scene, {-half_side, -half_side, z}, up ? x : y, up ? y : x, material);
}

Scene plane_under_point_light(const V3d& light, double fov_degrees) {
    Scene scene;
    scene.path = "plane";
    scene.camera = look_at({0, 0, 3}, {0.0, 0.01, 0}, {0, 1, 0}, fov_degrees);
    add_horizontal_square(scene, 4.0, 0.0, true, add_diffuse(scene, Spectrum::constant(0.5)));
    Light lamp;
    lamp.emission = Spectrum::named("stdillum-D65");
    lamp.position = light;
    lamp.scale = 5.0;
    scene.lights.push_back(lamp);
    return scene;
}

double plane_radiance(const Light& light, const V3d& point) {
    const V3d towards = light.position - point;
    return 0.5 / 3.14159265358979 * light.scale * towards.z / std::pow(towards.length(), 3.0);
}

RenderOptions small_render(const std::string& method, int width, int height, int photons, double radius,
                           int max_depth) {
    RenderOptions options;
    options.method = parse_method(method);
    options.width = width;
    options.height = height;
    options.region = {0, 0, width, height};
    options.photons_per_pass = photons;
    options.radius = radius;
    options.max_depth = max_depth;
    return options;
}

CameraRay camera_ray(const Camera& camera, int width, int height, double raster_x, double raster_y) {
    const double aspect = static_cast<double>(width) / height;
    const double half_width = std::max(aspect, 1.0);
    const double half_height = std::max(1.0 / aspect, 1.0);
    const double tangent = std::tan(camera.fov_degrees * std::numbers::pi / 360.0);
    const V3d in_camera((2.0 * raster_x / width - 1.0) * half_width * tangent,
                        (1.0 - 2.0 * raster_y / height) * half_height * tangent, 1.0);
    CameraRay ray;
    camera.camera_to_world.multDirMatrix(in_camera, ray.direction);
    ray.direction.normalize();
    camera.camera_to_world.multVecMatrix(V3d(0.0), ray.origin);
    return ray;
}

double pixel_mean(const Camera& camera, int width, int height, int x, int y,
                  const std::function<double(const CameraRay&)>& radiance) {
    constexpr int points = 8;
    double sum = 0.0;
    for (int i = 0; i < points; ++i) {
        for (int j = 0; j < points; ++j)
            sum += radiance(camera_ray(camera, width, height, x + (i + 0.5) / points, y + (j + 0.5) / points));
    }
    return sum / (points * points);
}

V3d at_height(const CameraRay& ray, double height) {
    return ray.origin + (height - ray.origin.z) / ray.direction.z * ray.direction;
}

double disc_mean(double squared_radius, const std::function<double(double, double)>& f) {
    // Four points at distance r/√2 have the disc's second moments.
    const double half = 0.5 * std::sqrt(squared_radius);
    return 0.25 * (f(half, half) + f(-half, half) + f(half, -half) + f(-half, -half));
}

double mean_squared_radius(double initial_radius, int passes) {
    constexpr double alpha = 2.0 / 3.0; // Knaus & Zwicker 2011, equation 15, as a product
    double squared = initial_radius * initial_radius;
    double sum = 0.0;
    for (int i = 1; i <= passes; ++i) {
        sum += squared;
        squared *= (i + alpha) / (i + 1.0);
    }
    return sum / passes;
}

} // namespace tristim::test
