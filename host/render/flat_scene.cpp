#include "render/flat_scene.h"

#include "base/error.h"
#include "render/flat_texture.h"
#include "scene/geometry.h"
#include "scene/textures.h"
#include "spectra/colour.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tristim {
namespace {

using std::numbers::pi;

void store(const V3d& v, float& x, float& y, float& z) {
    x = static_cast<float>(v.x);
    y = static_cast<float>(v.y);
    z = static_cast<float>(v.z);
}

/// pbrt's perspective camera as the plane of directions that SceneConstants describes.
void place_camera(const Camera& camera, const V3d& coordinates, int width, int height, SceneConstants& c) {
    const double aspect = static_cast<double>(width) / height;
    std::array<double, 4> window =
        aspect > 1.0 ? std::array{-aspect, aspect, -1.0, 1.0} : std::array{-1.0, 1.0, -1.0 / aspect, 1.0 / aspect};
    if (camera.screen_window)
        window = *camera.screen_window;
    const double scale = std::tan(camera.fov_degrees * pi / 360.0);
    const auto to_world = [&camera](const V3d& v) {
        V3d result;
        camera.camera_to_world.multDirMatrix(v, result);
        return result;
    };
    const V3d right = to_world({1.0, 0.0, 0.0});
    const V3d up = to_world({0.0, 1.0, 0.0});
    const V3d corner = to_world({window[0] * scale, window[3] * scale, 1.0});
    V3d origin;
    camera.camera_to_world.multVecMatrix(V3d(0.0), origin);

    store(origin - coordinates, c.camera_x, c.camera_y, c.camera_z);
    store(corner, c.corner_x, c.corner_y, c.corner_z);
    store(right * ((window[1] - window[0]) * scale / width), c.right_x, c.right_y, c.right_z);
    store(up * ((window[2] - window[3]) * scale / height), c.down_x, c.down_y, c.down_z);
    store(right, c.lens_right_x, c.lens_right_y, c.lens_right_z);
    store(up, c.lens_up_x, c.lens_up_y, c.lens_up_z);
    c.lens_radius = static_cast<float>(camera.lens_radius);
    c.focal_distance = static_cast<float>(camera.focal_distance);
    c.image_width = width;
    c.image_height = height;
}

void add_film(const Film& film, FlatScene& flat, SurfaceMaterial& m) {
    m.film = static_cast<int>(flat.film_layers.size());
    m.film_layers = static_cast<int>(film.layers.size());
    m.film_texture = film.thickness_texture;
    for (const FilmLayer& layer : film.layers) {
        SceneFilmLayer l{};
        l.thickness = static_cast<float>(layer.thickness);
        l.eta = flat.spectra.add(layer.eta, SpectrumTable::Use::Index);
        l.k = flat.spectra.add(layer.k, SpectrumTable::Use::Index);
        flat.film_layers.push_back(l);
    }
}

/// Makes room for the internal reflectance of a film on a diffuse body, which film_tables.cl works out in every pass:
/// for one thickness, or for those between the texture's least and largest value. Reflectances of films that absorb may
/// change too much from row to row, and are worked out at each hit.
void add_internal_reflectance(const Scene& scene, const Film& film, SurfaceMaterial& m) {
    constexpr double step = 4.0; // nm, see tabulated_internal_reflectance
    constexpr double longest = 4096.0;
    double low = film.layers.front().thickness;
    double high = low;
    if (film.thickness_texture >= 0) {
        const auto range = value_range(scene.textures[static_cast<std::size_t>(film.thickness_texture)]);
        low = range[0];
        high = range[1];
    }
    if (high > low && (high - low > longest || absorbs(film)))
        return;
    m.internal_rows = high > low ? std::max(static_cast<int>(std::ceil((high - low) / step)) + 1, 4) : 1;
    m.internal_thickness = static_cast<float>(low);
    m.internal_step = static_cast<float>((high - low) / std::max(m.internal_rows - 1, 1));
}

/// Once all spectra are in the table: the film tables' rows lie behind them.
void place_film_tables(FlatScene& flat) {
    for (SurfaceMaterial& m : flat.materials) {
        m.internal_reflectance = flat.spectra.rows() + flat.film_table_rows;
        flat.film_table_rows += m.internal_rows;
    }
}

void add_materials(const Scene& scene, const Effects& effects, FlatScene& flat) {
    using Use = SpectrumTable::Use;
    for (const Material& material : scene.materials) {
        SurfaceMaterial m{};
        switch (material.kind) {
        case Material::Kind::Diffuse:
            m.kind = MATERIAL_DIFFUSE;
            m.reflectance = flat.spectra.add(material.reflectance, Use::Reflectance);
            if (!material.film.layers.empty()) {
                m.eta = flat.spectra.add(material.eta, Use::Index);
                add_internal_reflectance(scene, material.film, m);
            }
            break;
        case Material::Kind::Dielectric:
            m.kind = MATERIAL_DIELECTRIC;
            m.eta = flat.spectra.add(material.eta, Use::Index);
            m.dispersive = material.eta.is_constant() ? 0 : 1;
            break;
        case Material::Kind::Conductor:
            m.kind = MATERIAL_CONDUCTOR;
            m.eta = flat.spectra.add(material.eta, Use::Index);
            m.k = flat.spectra.add(material.k, Use::Index);
            break;
        }
        m.alpha_u = static_cast<float>(material.alpha_u);
        m.alpha_v = static_cast<float>(material.alpha_v);
        m.takes_photons = takes_photons(material, effects.photon_roughness) ? 1 : 0;
        add_film(material.film, flat, m);
        flat.materials.push_back(m);
    }
    for (const Texture& texture : scene.textures)
        flat.textures.push_back(flatten_texture(texture, flat.origin, flat.texels));
}

/// Where a mesh has no u and v, pbrt's.
constexpr std::array<std::array<float, 2>, 3> default_uv{{{0.0F, 0.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}}};

/// Returns the index of the triangle's attributes, or -1 if it needs none.
int add_attributes(const Mesh& mesh, const std::array<std::uint32_t, 3>& corners, const Effects& effects,
                   std::vector<float>& attributes) {
    if (mesh.normals.empty() && !effects.uv)
        return -1;
    const auto index = static_cast<int>(attributes.size());
    if (effects.shading_normals) {
        for (const std::uint32_t corner : corners) {
            const V3f n = mesh.normals.empty() ? V3f(0.0F) : mesh.normals[corner]; // 0: the triangle's own
            attributes.insert(attributes.end(), {n.x, n.y, n.z});
        }
    }
    if (effects.uv) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::array<float, 2> uv =
                mesh.uv.empty() ? default_uv[i] : std::array{mesh.uv[corners[i]].x, mesh.uv[corners[i]].y};
            attributes.insert(attributes.end(), uv.begin(), uv.end());
        }
    }
    return index;
}

float largest_coordinate(const std::array<V3f, 3>& vertices) {
    float largest = 0.0F;
    for (const V3f& v : vertices)
        largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return largest;
}

/// Adds a shape's triangles; `area_light` and its spectrum's row apply if the shape emits.
void add_triangles(const Shape& shape, const Effects& effects, const Light* area_light, int spectrum, FlatScene& flat) {
    for (const auto& corners : shape.mesh.triangles) {
        const V3f v0(shape.mesh.positions[corners[0]] - flat.origin);
        const V3f v1(shape.mesh.positions[corners[1]] - flat.origin);
        const V3f v2(shape.mesh.positions[corners[2]] - flat.origin);
        if (is_degenerate(V3d(v0), V3d(v1), V3d(v2)))
            continue; // too thin for single precision
        Triangle t = flat_triangle(v0, v1, v2);
        t.material = shape.material;
        t.attributes = add_attributes(shape.mesh, corners, effects, flat.attributes);
        if (area_light != nullptr) {
            SceneLight light = flat_area_light(v0, v1, v2);
            light.spectrum = spectrum;
            light.scale = static_cast<float>(area_light->scale);
            light.two_sided = area_light->two_sided ? 1 : 0;
            t.light = static_cast<int>(flat.lights.size());
            flat.lights.push_back(light);
        }
        flat.triangles.push_back(t);
        flat.soup.v0.push_back(v0);
        flat.soup.v1.push_back(v1);
        flat.soup.v2.push_back(v2);
    }
}

void bound(FlatScene& flat) {
    V3d low(0.0), high(0.0);
    bool first = true;
    for (const auto* corner : {&flat.soup.v0, &flat.soup.v1, &flat.soup.v2}) {
        for (const V3f& v : *corner) {
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = first ? v[axis] : std::min(low[axis], static_cast<double>(v[axis]));
                high[axis] = first ? v[axis] : std::max(high[axis], static_cast<double>(v[axis]));
            }
            first = false;
        }
    }
    SceneConstants& c = flat.constants;
    store(0.5 * (low + high), c.centre_x, c.centre_y, c.centre_z);
    if (first)
        high = V3d(1.0); // nothing but an infinite light: any sphere will do
    // A little more than the half diagonal, so that rays from the sphere start outside of every triangle.
    c.radius = static_cast<float>(0.5 * (high - low).length() * 1.0001);
}

SceneLight flatten_light(const Light& light, const V3d& origin, int spectrum) {
    SceneLight l{};
    l.spectrum = spectrum;
    l.scale = static_cast<float>(light.scale);
    store(light.position - origin, l.position_x, l.position_y, l.position_z);
    store(light.direction, l.direction_x, l.direction_y, l.direction_z);
    l.cos_total_width = static_cast<float>(light.cos_total_width);
    l.cos_falloff_start = static_cast<float>(light.cos_falloff_start);
    switch (light.kind) {
    case Light::Kind::Point:
        l.kind = LIGHT_POINT;
        break;
    case Light::Kind::Spot:
        l.kind = LIGHT_SPOT;
        break;
    case Light::Kind::Distant:
        l.kind = LIGHT_DISTANT;
        break;
    case Light::Kind::Infinite:
        l.kind = LIGHT_INFINITE;
        break;
    case Light::Kind::Area:
        l.kind = LIGHT_AREA;
        break;
    }
    return l;
}

/// The power of a light over its spectrum, as kernels/lights.h emits it.
double geometric_power(const SceneLight& light, double scene_radius) {
    const double disc = pi * scene_radius * scene_radius;
    switch (light.kind) {
    case LIGHT_POINT:
        return 4.0 * pi * light.scale;
    case LIGHT_SPOT:
        return 2.0 * pi * light.scale *
               ((1.0 - light.cos_falloff_start) + 0.5 * (light.cos_falloff_start - light.cos_total_width));
    case LIGHT_DISTANT:
        return disc * light.scale;
    case LIGHT_INFINITE:
        return 4.0 * pi * disc * light.scale;
    default:
        return pi * light.area * light.scale * (light.two_sided != 0 ? 2.0 : 1.0);
    }
}

/// Shares out the numbers that kernels draw, the multiples of 2^-24 (unit_float): one to each light that emits, so that
/// none is missed however faint beside the others, and the rest by power. The probabilities are those of the shares,
/// exactly.
void choose_by_power(const std::vector<double>& powers, double total, FlatScene& flat) {
    constexpr double numbers = 0x1p24;
    const auto emitting =
        static_cast<double>(std::count_if(powers.begin(), powers.end(), [](double p) { return p > 0.0; }));
    if (emitting > 0.5 * numbers)
        fail("the scene has {:.0f} lights (an area light is one for each triangle); at most {:.0f} can be told apart",
             emitting, 0.5 * numbers);
    double before = 0.0, sum = 0.0, lights = 0.0;
    flat.light_cdf.push_back(0.0F);
    for (std::size_t i = 0; i < powers.size(); ++i) {
        sum += powers[i];
        lights += powers[i] > 0.0 ? 1.0 : 0.0;
        const double end = lights + std::round((numbers - emitting) * std::min(sum / total, 1.0));
        flat.lights[i].probability = static_cast<float>((end - before) / numbers);
        flat.light_cdf.push_back(static_cast<float>(end / numbers));
        before = end;
    }
}

/// Chooses lights in proportion to the Y of their power, and sums up what they emit. rows[i] is the spectrum of
/// scene.lights[i].
void weigh_lights(const Scene& scene, const std::vector<int>& rows, FlatScene& flat) {
    std::vector<double> of_row(static_cast<std::size_t>(flat.spectra.rows()), 0.0);
    std::vector<double> luminances = of_row;
    for (std::size_t i = 0; i < rows.size(); ++i)
        luminances[static_cast<std::size_t>(rows[i])] = spectrum_to_xyz(scene.lights[i].emission)[1];
    std::vector<double> powers;
    double total = 0.0;
    for (const SceneLight& light : flat.lights) {
        const double geometric = geometric_power(light, flat.constants.radius);
        of_row[static_cast<std::size_t>(light.spectrum)] += geometric;
        powers.push_back(geometric * luminances[static_cast<std::size_t>(light.spectrum)]);
        total += powers.back();
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto bins = scene.lights[i].emission.bins();
        for (std::size_t bin = 0; bin < bins.size(); ++bin)
            flat.emission[bin] += of_row[static_cast<std::size_t>(rows[i])] * bins[bin];
    }
    if (!(total > 0.0) || !std::isfinite(total))
        fail("{}: the lights emit nothing that is visible", scene.path);
    choose_by_power(powers, total, flat);
}

} // namespace

Triangle flat_triangle(const V3f& v0, const V3f& v1, const V3f& v2) {
    const V3d edge1 = V3d(v1) - V3d(v0);
    const V3d edge2 = V3d(v2) - V3d(v0);
    Triangle t{};
    store(V3d(v0), t.v0_x, t.v0_y, t.v0_z);
    store(edge1, t.edge1_x, t.edge1_y, t.edge1_z);
    store(edge2, t.edge2_x, t.edge2_y, t.edge2_z);
    store(edge1.cross(edge2).normalized(), t.normal_x, t.normal_y, t.normal_z);
    t.extent = largest_coordinate({v0, v1, v2});
    t.light = -1;
    t.attributes = -1;
    return t;
}

SceneLight flat_area_light(const V3f& v0, const V3f& v1, const V3f& v2) {
    const V3d edge1 = V3d(v1) - V3d(v0);
    const V3d edge2 = V3d(v2) - V3d(v0);
    SceneLight light{};
    light.kind = LIGHT_AREA;
    light.scale = 1.0F;
    light.probability = 1.0F;
    light.area = static_cast<float>(0.5 * edge1.cross(edge2).length());
    light.extent = largest_coordinate({v0, v1, v2});
    store(V3d(v0), light.position_x, light.position_y, light.position_z);
    store(edge1.cross(edge2).normalized(), light.direction_x, light.direction_y, light.direction_z);
    store(edge1, light.edge1_x, light.edge1_y, light.edge1_z);
    store(edge2, light.edge2_x, light.edge2_y, light.edge2_z);
    return light;
}

FlatScene flatten_scene(const Scene& scene, const Effects& effects, int width, int height, const Region& region) {
    FlatScene flat;
    flat.origin = coordinate_origin(scene.shapes);
    add_materials(scene, effects, flat);

    std::vector<int> rows;
    for (const Light& light : scene.lights)
        rows.push_back(flat.spectra.add(light.emission, SpectrumTable::Use::Emission));
    place_film_tables(flat);
    SceneConstants& c = flat.constants;
    c.infinite_light = -1;
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        const Light::Kind kind = scene.lights[i].kind;
        if (kind == Light::Kind::Area)
            continue;
        if (kind == Light::Kind::Infinite) {
            if (c.infinite_light >= 0)
                fail("{}: more than one infinite light; add their radiances to one", scene.path);
            c.infinite_light = static_cast<int>(flat.lights.size());
        }
        flat.lights.push_back(flatten_light(scene.lights[i], flat.origin, rows[i]));
    }
    for (const Shape& shape : scene.shapes) {
        const bool emits = shape.area_light >= 0;
        const auto light = static_cast<std::size_t>(std::max(shape.area_light, 0));
        add_triangles(shape, effects, emits ? &scene.lights[light] : nullptr, emits ? rows[light] : -1, flat);
    }
    bound(flat);
    weigh_lights(scene, rows, flat);
    place_camera(scene.camera, flat.origin, width, height, c);
    c.light_count = static_cast<int>(flat.lights.size());
    c.region_x = region.x;
    c.region_y = region.y;
    c.region_width = region.width;
    c.region_height = region.height;
    return flat;
}

} // namespace tristim
