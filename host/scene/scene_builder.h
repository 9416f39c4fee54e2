#pragma once

#include "scene/geometry.h"
#include "scene/lights.h"
#include "scene/parameters.h"
#include "scene/scene.h"
#include "scene/source_location.h"
#include "scene/textures.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tristim {

/// The most triangles that a scene may have, instances counted one by one: they take some ten gigabytes.
inline constexpr std::size_t max_triangles = std::size_t{1} << 26;

/// Keeps pbrt's graphics state and collects the scene that the directives describe. One method per directive; each
/// throws Error "file:line: …".
class SceneBuilder {
  public:
    /// `path` is the main scene file: other files are sought beside it. `rgb_upsampling` overrides the scene's option.
    /// A scene of more than `most_triangles` triangles is refused.
    explicit SceneBuilder(const std::string& path, std::optional<RgbUpsampling> rgb_upsampling = std::nullopt,
                          std::size_t most_triangles = max_triangles);

    /// How the "rgb" parameters of what comes next become spectra.
    RgbUpsampling rgb_upsampling() const { return rgb_upsampling_.value_or(scene_rgb_upsampling_); }

    void set_transform(const M44d& matrix) { state_.ctm = matrix; }
    /// pbrt's CTM = CTM · matrix (see transforms.h).
    void concat_transform(const M44d& matrix) { state_.ctm = matrix * state_.ctm; }
    void coordinate_system(const std::string& name) { coordinate_systems_[name] = state_.ctm; }
    void coord_sys_transform(const std::string& name, const SourceLocation& where);
    void world_begin(const SourceLocation& where);
    void attribute_begin(const SourceLocation& where);
    void attribute_end(const SourceLocation& where);
    void transform_begin(const SourceLocation& where);
    void transform_end(const SourceLocation& where);
    void reverse_orientation(const SourceLocation& where);

    void object_begin(const std::string& name, const SourceLocation& where);
    void object_end(const SourceLocation& where);
    void object_instance(const std::string& name, const SourceLocation& where);

    void camera(const std::string& kind, ParameterList parameters);
    void film(const std::string& kind, ParameterList parameters);
    void sampler(const std::string& kind, ParameterList parameters);
    void pixel_filter(const std::string& kind, ParameterList parameters);
    void integrator(const std::string& kind, ParameterList parameters);
    void accelerator(const std::string& kind, ParameterList parameters);
    void option(const std::string& name, ParameterList parameters);
    void color_space(const std::string& name, const SourceLocation& where);

    void texture(const std::string& name, const std::string& type, const std::string& kind, ParameterList parameters);
    void material(const std::string& kind, ParameterList parameters);
    void make_named_material(const std::string& name, ParameterList parameters);
    void named_material(const std::string& name, const SourceLocation& where);
    void light_source(const std::string& kind, ParameterList parameters);
    void area_light_source(const std::string& kind, ParameterList parameters);
    void shape(const std::string& kind, ParameterList parameters);

    /// A file named in the scene: beside the main scene file as in pbrt, else beside the file that names it.
    std::string resolve_path(const std::string& name, const SourceLocation& where) const;

    /// The scene once everything is read. Throws Error if it has no camera, light or geometry or an open block.
    Scene finish();

  private:
    struct GraphicsState {
        M44d ctm;
        bool reverse_orientation = false;
        int material = -1;                           ///< index into scene_.materials; -1: pbrt's default material
        std::shared_ptr<const AreaLight> area_light; ///< null: surfaces do not emit
    };
    struct SavedState {
        enum class Kind { Attribute, Transform, Object };
        Kind kind;
        GraphicsState state;
        SourceLocation where;
    };
    struct ObjectPart {
        Geometry geometry;
        int material = -1;
        SourceLocation where;
    };
    struct NamedMaterial {
        int index;
        bool defined = false;
        SourceLocation where;
    };

    GraphicsState take_saved(SavedState::Kind kind, const char* begin, const char* end, const SourceLocation& where);
    void require_world(const std::string& directive, const SourceLocation& where) const;
    void require_options(const std::string& directive, const SourceLocation& where) const;
    void note(const SourceLocation& where, const std::string& text);
    NamedMaterial& find_named_material(const std::string& name, const SourceLocation& where);
    void count_triangles(std::size_t count, const SourceLocation& where);
    void add_shape(const Geometry& world, int material, const AreaLight* area_light, const SourceLocation& where);
    int default_material();
    void remove_unused_materials();
    void check_thickness(const Shape& shape) const;
    void collect_textures();
    void note_coarse_shapes();

    Scene scene_;
    std::string folder_;
    std::optional<RgbUpsampling> rgb_upsampling_;
    RgbUpsampling scene_rgb_upsampling_ = RgbUpsampling::JakobHanika;
    GraphicsState state_;
    std::vector<SavedState> saved_;
    std::map<std::string, M44d> coordinate_systems_;
    TextureTable textures_;
    std::map<std::string, NamedMaterial> named_materials_;
    std::map<std::string, std::vector<ObjectPart>> objects_;
    std::string open_object_;   ///< the name between ObjectBegin and ObjectEnd
    int default_material_ = -1; ///< index into scene_.materials once a shape needs it
    std::size_t most_triangles_;
    std::size_t triangles_ = 0; ///< of all shapes and instances so far
    bool in_world_ = false;
    bool has_camera_ = false;
};

} // namespace tristim
