#include "scene/scene_builder.h"

#include "scene/materials.h"
#include "scene/shapes.h"
#include "scene/transforms.h"

#include <algorithm>
#include <filesystem>

namespace tristim {

SceneBuilder::SceneBuilder(const std::string& path, std::optional<RgbUpsampling> rgb_upsampling,
                           std::size_t most_triangles)
    : folder_(std::filesystem::path(path).parent_path().string()), rgb_upsampling_(rgb_upsampling),
      most_triangles_(most_triangles) {
    scene_.path = path;
}

void SceneBuilder::note(const SourceLocation& where, const std::string& text) {
    scene_.notes.push_back(where.text() + ": " + text);
}

std::string SceneBuilder::resolve_path(const std::string& name, const SourceLocation& where) const {
    namespace fs = std::filesystem;
    const fs::path beside_scene = fs::path(folder_) / name;
    const fs::path beside_includer = fs::path(*where.file).parent_path() / name;
    std::error_code ignored;
    if (!fs::exists(beside_scene, ignored) && fs::exists(beside_includer, ignored))
        return beside_includer.string();
    return beside_scene.string();
}

void SceneBuilder::require_world(const std::string& directive, const SourceLocation& where) const {
    if (!in_world_)
        fail_at(where, "\"{}\" must come after \"WorldBegin\"", directive);
}

void SceneBuilder::require_options(const std::string& directive, const SourceLocation& where) const {
    if (in_world_)
        fail_at(where, "\"{}\" must come before \"WorldBegin\"", directive);
}

void SceneBuilder::coord_sys_transform(const std::string& name, const SourceLocation& where) {
    const auto it = coordinate_systems_.find(name);
    if (it == coordinate_systems_.end())
        fail_at(where, "no coordinate system \"{}\" is defined", name);
    state_.ctm = it->second;
}

void SceneBuilder::world_begin(const SourceLocation& where) {
    require_options("WorldBegin", where);
    in_world_ = true;
    state_.ctm = M44d();
    coordinate_systems_["world"] = state_.ctm;
}

void SceneBuilder::attribute_begin(const SourceLocation& where) {
    require_world("AttributeBegin", where);
    saved_.push_back({SavedState::Kind::Attribute, state_, where});
}

void SceneBuilder::transform_begin(const SourceLocation& where) {
    require_world("TransformBegin", where);
    saved_.push_back({SavedState::Kind::Transform, state_, where});
}

SceneBuilder::GraphicsState SceneBuilder::take_saved(SavedState::Kind kind, const char* begin, const char* end,
                                                     const SourceLocation& where) {
    if (saved_.empty() || saved_.back().kind != kind)
        fail_at(where, "\"{}\" closes no \"{}\"", end, begin);
    GraphicsState state = std::move(saved_.back().state);
    saved_.pop_back();
    return state;
}

void SceneBuilder::attribute_end(const SourceLocation& where) {
    state_ = take_saved(SavedState::Kind::Attribute, "AttributeBegin", "AttributeEnd", where);
}

void SceneBuilder::transform_end(const SourceLocation& where) {
    state_.ctm = take_saved(SavedState::Kind::Transform, "TransformBegin", "TransformEnd", where).ctm;
}

void SceneBuilder::reverse_orientation(const SourceLocation& where) {
    require_world("ReverseOrientation", where);
    state_.reverse_orientation = !state_.reverse_orientation;
}

void SceneBuilder::object_begin(const std::string& name, const SourceLocation& where) {
    require_world("ObjectBegin", where);
    if (!open_object_.empty())
        fail_at(where, "\"ObjectBegin\" stands inside the object \"{}\"", open_object_);
    if (name.empty() || objects_.contains(name))
        fail_at(where, "the object \"{}\" {}", name, name.empty() ? "has no name" : "is defined already");
    saved_.push_back({SavedState::Kind::Object, state_, where});
    open_object_ = name;
    objects_[name];
}

void SceneBuilder::object_end(const SourceLocation& where) {
    state_ = take_saved(SavedState::Kind::Object, "ObjectBegin", "ObjectEnd", where);
    open_object_.clear();
}

void SceneBuilder::object_instance(const std::string& name, const SourceLocation& where) {
    require_world("ObjectInstance", where);
    if (!open_object_.empty())
        fail_at(where, "\"ObjectInstance\" inside the object \"{}\" is not supported", open_object_);
    const auto it = objects_.find(name);
    if (it == objects_.end())
        fail_at(where, "no object \"{}\" is defined", name);
    for (const ObjectPart& part : it->second) {
        count_triangles(part.geometry.triangles.size(), where);
        const Geometry world = with_location(where, [&] { return transformed(part.geometry, state_.ctm, false); });
        add_shape(world, part.material, nullptr, where);
    }
}

void SceneBuilder::texture(const std::string& name, const std::string& type, const std::string& kind,
                           ParameterList parameters) {
    require_world("Texture", parameters.where());
    const auto resolve = [this](const std::string& file, const SourceLocation& from) {
        return resolve_path(file, from);
    };
    std::vector<std::string> remarks;
    textures_.define(name, type, kind, parameters, state_.ctm, resolve, remarks);
    for (const std::string& remark : remarks)
        note(parameters.where(), remark);
}

void SceneBuilder::material(const std::string& kind, ParameterList parameters) {
    require_world("Material", parameters.where());
    const auto resolve = [this](const std::string& name, const SourceLocation& from) {
        return resolve_path(name, from);
    };
    scene_.materials.push_back(make_material(kind, parameters, resolve, textures_));
    state_.material = static_cast<int>(scene_.materials.size()) - 1;
}

SceneBuilder::NamedMaterial& SceneBuilder::find_named_material(const std::string& name, const SourceLocation& where) {
    const auto it = named_materials_.find(name);
    if (it != named_materials_.end())
        return it->second;
    scene_.materials.emplace_back();
    const int index = static_cast<int>(scene_.materials.size()) - 1;
    return named_materials_.emplace(name, NamedMaterial{index, false, where}).first->second;
}

void SceneBuilder::make_named_material(const std::string& name, ParameterList parameters) {
    require_world("MakeNamedMaterial", parameters.where());
    NamedMaterial& entry = find_named_material(name, parameters.where());
    if (entry.defined)
        fail_at(parameters.where(), "the material \"{}\" is defined already", name);
    const std::string kind = parameters.text("type", "");
    if (kind.empty())
        fail_at(parameters.where(), "{} has no parameter \"string type\"", parameters.owner());
    const auto resolve = [this](const std::string& file, const SourceLocation& from) {
        return resolve_path(file, from);
    };
    Material& material = scene_.materials[static_cast<std::size_t>(entry.index)];
    material = make_material(kind, parameters, resolve, textures_);
    material.name = name;
    entry.defined = true;
}

void SceneBuilder::named_material(const std::string& name, const SourceLocation& where) {
    require_world("NamedMaterial", where);
    state_.material = find_named_material(name, where).index;
}

void SceneBuilder::light_source(const std::string& kind, ParameterList parameters) {
    require_world("LightSource", parameters.where());
    if (!open_object_.empty())
        fail_at(parameters.where(), "a light inside the object \"{}\" is not supported", open_object_);
    const auto resolve = [this](const std::string& name, const SourceLocation& from) {
        return resolve_path(name, from);
    };
    scene_.lights.push_back(make_light(kind, parameters, state_.ctm, resolve));
}

void SceneBuilder::area_light_source(const std::string& kind, ParameterList parameters) {
    require_world("AreaLightSource", parameters.where());
    const auto resolve = [this](const std::string& name, const SourceLocation& from) {
        return resolve_path(name, from);
    };
    state_.area_light = std::make_shared<const AreaLight>(make_area_light(kind, parameters, resolve));
}

void SceneBuilder::shape(const std::string& kind, ParameterList parameters) {
    require_world("Shape", parameters.where());
    if (!open_object_.empty() && state_.area_light)
        fail_at(parameters.where(), "an area light inside the object \"{}\" is not supported", open_object_);
    const auto resolve = [this](const std::string& name, const SourceLocation& from) {
        return resolve_path(name, from);
    };
    std::vector<std::string> remarks;
    const Geometry object = make_shape(kind, parameters, resolve, remarks);
    for (const std::string& remark : remarks)
        note(parameters.where(), remark);
    Geometry world =
        with_location(parameters.where(), [&] { return transformed(object, state_.ctm, state_.reverse_orientation); });
    count_triangles(world.triangles.size(), parameters.where());
    if (open_object_.empty())
        add_shape(world, state_.material, state_.area_light.get(), parameters.where());
    else
        objects_[open_object_].push_back({std::move(world), state_.material, parameters.where()});
}

namespace {

/// One mesh for each patch, all with the same vertices as pbrt's lights have.
std::vector<Mesh> split_patches(const BakedMesh& baked) {
    std::map<std::uint32_t, Mesh> by_patch;
    for (std::size_t i = 0; i < baked.mesh.triangles.size(); ++i) {
        Mesh& mesh = by_patch[baked.patches[i]];
        std::array<std::uint32_t, 3> triangle{};
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t vertex = baked.mesh.triangles[i][corner];
            triangle[corner] = static_cast<std::uint32_t>(mesh.positions.size());
            mesh.positions.push_back(baked.mesh.positions[vertex]);
            if (!baked.mesh.normals.empty())
                mesh.normals.push_back(baked.mesh.normals[vertex]);
            if (!baked.mesh.uv.empty())
                mesh.uv.push_back(baked.mesh.uv[vertex]);
        }
        mesh.triangles.push_back(triangle);
    }
    std::vector<Mesh> meshes;
    for (auto& [patch, mesh] : by_patch)
        meshes.push_back(std::move(mesh));
    return meshes;
}

} // namespace

void SceneBuilder::count_triangles(std::size_t count, const SourceLocation& where) {
    triangles_ += count;
    if (triangles_ > most_triangles_)
        fail_at(where, "the scene has more than {} triangles here, which is the most that is supported",
                most_triangles_);
}

void SceneBuilder::add_shape(const Geometry& world, int material, const AreaLight* area_light,
                             const SourceLocation& where) {
    BakedMesh baked = with_location(where, [&] { return bake(world); });
    if (baked.degenerate > 0)
        note(where,
             fmt::format("dropped {} degenerate triangle{}", baked.degenerate, baked.degenerate == 1 ? "" : "s"));
    if (area_light && area(baked.mesh) <= 0.0)
        fail_at(where, "zero-area light: the surface that should emit has no area");
    if (baked.mesh.triangles.empty())
        return;
    std::vector<Mesh> meshes;
    if (area_light && area_light->power)
        meshes = split_patches(baked);
    else
        meshes.push_back(std::move(baked.mesh));
    for (Mesh& mesh : meshes) {
        int light = -1;
        if (area_light) {
            scene_.lights.push_back(light_of_area(*area_light, area(mesh)));
            check_light(scene_.lights.back(), where);
            light = static_cast<int>(scene_.lights.size()) - 1;
        }
        scene_.shapes.push_back({std::move(mesh), material < 0 ? default_material() : material, light, where});
    }
}

int SceneBuilder::default_material() {
    if (default_material_ < 0) {
        scene_.materials.emplace_back().name = "default";
        default_material_ = static_cast<int>(scene_.materials.size()) - 1;
    }
    return default_material_;
}

void SceneBuilder::remove_unused_materials() {
    std::vector<int> renamed(scene_.materials.size(), -1);
    std::vector<Material> used;
    for (Shape& shape : scene_.shapes) {
        int& index = renamed[static_cast<std::size_t>(shape.material)];
        if (index < 0) {
            index = static_cast<int>(used.size());
            used.push_back(std::move(scene_.materials[static_cast<std::size_t>(shape.material)]));
        }
        shape.material = index;
    }
    scene_.materials = std::move(used);
}

/// A bilinear thickness was checked within its unit square; beyond it, it goes on and may fall below 0.
void SceneBuilder::check_thickness(const Shape& shape) const {
    const Material& material = scene_.materials[static_cast<std::size_t>(shape.material)];
    if (material.film.thickness_texture < 0)
        return;
    const FloatTexture& texture = textures_.used(material.film.thickness_texture);
    if (texture.pattern->kind != Texture::Kind::Bilinear)
        return;
    const auto [low, high] = value_range(*texture.pattern);
    // Rounding at the edge of the unit square, where a corner may be 0, is no error.
    constexpr double rounding = 1e-6;
    const double least = least_value(*texture.pattern, shape.mesh);
    if (least < -rounding * (high - low))
        fail_at(shape.where,
                "the film on this shape would be {} nm thick somewhere: the texture \"{}\" is negative there", least,
                texture.name);
}

void SceneBuilder::collect_textures() {
    std::map<int, int> renamed;
    for (Material& material : scene_.materials) {
        int& index = material.film.thickness_texture;
        if (index < 0)
            continue;
        const auto [it, is_new] = renamed.try_emplace(index, static_cast<int>(scene_.textures.size()));
        if (is_new) {
            const FloatTexture& texture = textures_.used(index);
            scene_.textures.push_back(*texture.pattern);
            scene_.textures.back().name = texture.name;
            scene_.textures.back().where = texture.where;
        }
        index = it->second;
    }
}

void SceneBuilder::note_coarse_shapes() {
    const V3d origin = coordinate_origin(scene_.shapes);
    std::size_t worst = 0;
    double coarsest = 0.0;
    for (std::size_t i = 0; i < scene_.shapes.size(); ++i) {
        const double spacing = relative_spacing(scene_.shapes[i].mesh.positions, origin);
        if (spacing > coarsest) {
            coarsest = spacing;
            worst = i;
        }
    }
    if (coarsest > coarse_spacing)
        note(scene_.shapes[worst].where,
             fmt::format(
                 "this shape lies so far from the middle of the scene, or the scene so far from the origin, that "
                 "its coordinates are precise to {:.2g} of its size only: expect flaws, as from {:.2g} on",
                 coarsest, coarse_spacing));
}

Scene SceneBuilder::finish() {
    if (!saved_.empty())
        fail_at(saved_.back().where, "the block that begins here is never closed");
    if (!has_camera_)
        fail("{}: the scene has no camera", scene_.path);
    if (!in_world_)
        fail("{}: the scene has no \"WorldBegin\"", scene_.path);
    for (const auto& [name, entry] : named_materials_) {
        if (!entry.defined)
            fail_at(entry.where, "no material \"{}\" is defined", name);
    }
    if (scene_.lights.empty())
        fail("{}: the scene has no light", scene_.path);
    const bool sky = std::any_of(scene_.lights.begin(), scene_.lights.end(),
                                 [](const Light& light) { return light.kind == Light::Kind::Infinite; });
    if (scene_.shapes.empty() && !sky)
        fail("{}: the scene has no geometry", scene_.path);
    for (const Shape& shape : scene_.shapes)
        check_thickness(shape);
    note_coarse_shapes();
    remove_unused_materials();
    collect_textures();
    return std::move(scene_);
}

} // namespace tristim
