#pragma once

#include "scene/source_location.h"
#include "spectra/spectrum.h"

#include <Imath/ImathVec.h>

#include <string>
#include <vector>

namespace tristim {

using Imath::V2d;
using Imath::V3d;

/// One "type name" value(s) of a directive. Exactly one of the lists is filled, by type.
struct Parameter {
    std::string type;
    std::string name;
    std::vector<double> numbers; ///< integer, float, point, vector, normal, rgb, blackbody, spectrum samples
    std::vector<std::string> strings;
    std::vector<bool> bools;
    SourceLocation where;
    bool used = false;
};

/// The parameters of one directive. Every getter marks its parameter as used and throws Error "file:line: …" if it is
/// there with another type or number of values; finish() refuses the ones that nobody asked for.
class ParameterList {
  public:
    /// `owner` says whose parameters these are in messages: Shape "sphere".
    /// "rgb" parameters become spectra by `rgb_upsampling`.
    ParameterList(std::string owner, SourceLocation where, RgbUpsampling rgb_upsampling = RgbUpsampling::JakobHanika)
        : owner_(std::move(owner)), where_(std::move(where)), rgb_upsampling_(rgb_upsampling) {}
    ParameterList() = default;

    /// Throws Error if the name is already there.
    void add(Parameter parameter);

    bool has(const std::string& name) const;

    /// Where the parameter stands; the directive's line if it is absent.
    SourceLocation where(const std::string& name) const;
    const SourceLocation& where() const { return where_; }
    const std::string& owner() const { return owner_; }
    RgbUpsampling rgb_upsampling() const { return rgb_upsampling_; }

    double number(const std::string& name, double fallback);
    int integer(const std::string& name, int fallback);
    bool boolean(const std::string& name, bool fallback);
    std::string text(const std::string& name, const std::string& fallback);
    V3d point(const std::string& name, const V3d& fallback);
    /// A vector3.
    V3d vector(const std::string& name, const V3d& fallback);
    /// The name of a texture, empty if the parameter is absent or has another type.
    std::string texture(const std::string& name);

    /// Empty if absent.
    std::vector<double> numbers(const std::string& name);
    std::vector<int> integers(const std::string& name);
    std::vector<V3d> points(const std::string& name);
    std::vector<V3d> normals(const std::string& name);
    std::vector<V2d> points2(const std::string& name);
    std::vector<std::string> texts(const std::string& name);

    /// A "rgb", "spectrum" or "blackbody" parameter, or null if absent.
    const Parameter* spectrum(const std::string& name);

    /// The parameter of this name if it has this type, else null; nothing is marked or thrown.
    bool is_type(const std::string& name, const std::string& type) const;

    /// Accepts the parameter, if there, without effect; true if it was there.
    bool ignore(const std::string& name);

    /// Accepts all parameters that are left.
    void ignore_rest();

    /// Throws Error naming the first parameter that was never asked for.
    void finish() const;

  private:
    Parameter* find(const std::string& name);
    const Parameter* find(const std::string& name) const;
    Parameter* typed(const std::string& name, std::initializer_list<const char*> types);
    V3d single_triple(const std::string& name, const std::vector<V3d>& values, const V3d& fallback) const;
    std::vector<V3d> triples(const std::string& name, std::initializer_list<const char*> types);

    std::string owner_;
    SourceLocation where_;
    RgbUpsampling rgb_upsampling_ = RgbUpsampling::JakobHanika;
    std::vector<Parameter> parameters_;
};

} // namespace tristim
