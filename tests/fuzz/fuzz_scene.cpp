// Scene text through load_scene(). One input holds the scene and, after lines "#file NAME", files that it may name:
// it can read no others, since '/' becomes '_'.

#include "line_mutator.h"
#include "scratch.h"

#include "scene/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace tristim::fuzz {

namespace {

const std::array<std::string, 5> file_names{"scene.pbrt", "part.pbrt", "mesh.obj", "mesh.ply", "table.spd"};

std::map<std::string, std::string> split_files(std::string text) {
    std::replace(text.begin(), text.end(), '/', '_');
    const std::string marker = "#file ";
    std::map<std::string, std::string> files;
    std::string name = file_names.front();
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
        const std::string line = text.substr(begin, end - begin);
        begin = end;
        if (!line.starts_with(marker)) {
            files[name] += line;
            continue;
        }
        const std::string wanted = line.substr(marker.size(), line.find_last_not_of("\r\n") + 1 - marker.size());
        if (std::find(file_names.begin(), file_names.end(), wanted) != file_names.end())
            name = wanted;
    }
    return files;
}

std::size_t count(const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + word.size()))
        ++found;
    return found;
}

/// Spheres have 20,480 triangles each, and instances multiply them: a few lines may well describe a large scene, which
/// is no fault and takes its time.
bool is_large(const std::string& text) {
    constexpr std::size_t most_spheres = 24;
    return (count(text, "sphere") + 1) * (count(text, "ObjectInstance") + 1) * (count(text, "Include") + 1) >
           most_spheres;
}

bool is_float(double value) {
    return std::isfinite(static_cast<float>(value));
}

bool is_float(const V3d& v) {
    return is_float(v.x) && is_float(v.y) && is_float(v.z);
}

bool is_float(const Spectrum& spectrum) {
    const WavelengthBins bins = spectrum.bins();
    return std::all_of(bins.begin(), bins.end(), [](double value) { return is_float(value); });
}

bool is_float(const M44d& matrix) {
    const double* const entries = &matrix[0][0];
    return std::all_of(entries, entries + 16, [](double value) { return is_float(value); });
}

bool is_index(int index, std::size_t count) {
    return index >= 0 && static_cast<std::size_t>(index) < count;
}

void check_camera(const Scene& scene) {
    const Camera& camera = scene.camera;
    require(is_float(camera.camera_to_world), "the camera's matrix is finite");
    require(camera.fov_degrees > 0.0 && camera.fov_degrees < 180.0, "the field of view lies between 0 and 180");
    require(camera.lens_radius >= 0.0 && is_float(camera.lens_radius), "the lens radius is finite");
    require(camera.focal_distance > 0.0 && is_float(camera.focal_distance), "the focal distance is finite");
    if (camera.screen_window) {
        const auto& [x0, x1, y0, y1] = *camera.screen_window;
        require(x0 < x1 && y0 < y1 && is_float(x1 - x0) && is_float(y1 - y0), "the screen window is finite");
    }
    const RenderSettings& settings = scene.settings;
    require(settings.width > 0 && settings.height > 0, "the image has pixels");
    require(settings.passes.value_or(1) > 0 && settings.max_depth.value_or(1) > 0, "passes and depth are positive");
    require(settings.photons_per_pass.value_or(1) > 0, "there are photons");
    require(settings.initial_radius.value_or(1.0) > 0.0 && is_float(settings.initial_radius.value_or(1.0)),
            "the radius is positive and finite");
}

void check_materials(const Scene& scene) {
    for (const Material& material : scene.materials) {
        require(is_float(material.reflectance) && is_float(material.eta) && is_float(material.k),
                "a material's spectra are finite");
        for (const double alpha : {material.alpha_u, material.alpha_v})
            require(alpha >= 0.0 && alpha <= 1.0, "roughness lies in [0, 1]");
        for (const FilmLayer& layer : material.film.layers) {
            require(layer.thickness >= 0.0 && is_float(layer.thickness), "a film's thickness is finite");
            require(is_float(layer.eta) && is_float(layer.k), "a film's index is finite");
        }
        const int texture = material.film.thickness_texture;
        require(texture == -1 || is_index(texture, scene.textures.size()), "a film's texture exists");
    }
    for (const Texture& texture : scene.textures) {
        require(is_float(texture.world_to_texture), "a texture's matrix is finite");
        for (const auto& values : {texture.uv_scale, texture.corners})
            require(std::all_of(values.begin(), values.end(), [](double value) { return is_float(value); }),
                    "a texture's values are finite");
    }
}

void check_lights(const Scene& scene) {
    constexpr double rounding = 1e-6;
    for (const Light& light : scene.lights) {
        require(light.scale > 0.0 && is_float(light.scale), "a light's scale is positive and finite");
        const WavelengthBins bins = light.emission.bins();
        require(std::all_of(bins.begin(), bins.end(), [](double value) { return value >= 0.0 && is_float(value); }),
                "emission is finite and not negative");
        require(is_float(light.position), "a light's position is finite");
        require(std::abs(light.direction.length() - 1.0) < rounding, "a light's direction is a unit vector");
        require(std::abs(light.cos_total_width) <= 1.0 && std::abs(light.cos_falloff_start) <= 1.0,
                "a cone's cosines are cosines");
    }
}

void check_shapes(const Scene& scene) {
    constexpr double rounding = 1e-3;
    for (const Shape& shape : scene.shapes) {
        const Mesh& mesh = shape.mesh;
        require(is_index(shape.material, scene.materials.size()), "a shape's material exists");
        require(shape.area_light == -1 || is_index(shape.area_light, scene.lights.size()), "a shape's light exists");
        require(!mesh.triangles.empty(), "a shape has triangles");
        require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size(), "each vertex has a normal");
        require(mesh.uv.empty() || mesh.uv.size() == mesh.positions.size(), "each vertex has texture coordinates");
        for (const auto& triangle : mesh.triangles) {
            for (const std::uint32_t vertex : triangle)
                require(vertex < mesh.positions.size(), "a triangle's vertex exists");
        }
        for (const auto& position : mesh.positions)
            require(is_float(V3d(position)), "positions are finite");
        for (const V3f& normal : mesh.normals)
            require(std::abs(V3d(normal).length() - 1.0) < rounding, "normals are unit vectors");
        for (const V2f& uv : mesh.uv)
            require(std::isfinite(uv.x) && std::isfinite(uv.y), "texture coordinates are finite");
    }
}

} // namespace

} // namespace tristim::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tristim;
    using namespace tristim::fuzz;
    static const Scratch scratch;
    const std::string text(data, data + size);
    if (is_large(text))
        return 0;
    const std::map<std::string, std::string> files = split_files(text);
    for (const std::string& name : file_names) {
        const auto file = files.find(name);
        if (file != files.end())
            scratch.write(name, file->second);
        else
            scratch.remove(name);
    }
    expect_value_or_error([&] {
        const Scene scene = load_scene(scratch.path(file_names.front()));
        check_camera(scene);
        check_materials(scene);
        check_lights(scene);
        check_shapes(scene);
    });
    return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    return tristim::fuzz::mutate_text(data, size, max_size, seed);
}
