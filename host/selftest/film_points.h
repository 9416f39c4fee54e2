#pragma once

// Films as the kernels' film_optics is asked for them, in batches on a device and one by one from the oracle.

#include "selftest/case.h"
#include "selftest/film_oracle.h"

#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace tristim::selftest {

/// A film at one wavelength and angle, in floats, so that kernel and oracle are given the same.
struct FilmPoint {
    struct Layer {
        float thickness = 0.0F; ///< nm
        float n = 1.0F, k = 0.0F;
    };
    float lambda = 550.0F; ///< nm
    float n0 = 1.0F;       ///< of the outside
    float base_n = 1.5F, base_k = 0.0F;
    float cos_i = 1.0F;        ///< in the medium that the light comes from
    bool from_outside = true;  ///< else from the base, whose k must be 0
    std::vector<Layer> layers; ///< the outermost first
};

std::string describe(const FilmPoint& point);
bool has_absorbing_layer(const FilmPoint& point);

/// By the oracle.
oracle::FilmOptics exact_optics(const FilmPoint& point);

/// A point with the value of the parameter that its case varies.
struct FilmInput {
    double parameter = 0.0;
    FilmPoint point;
};

/// The kernels of kernels/selftest/film.cl, each way to compile them built when it is first needed.
class FilmKernels {
  public:
    /// Builds the program for a setting with macros LANES, HAS_ABSORBING_FILM and so on.
    using Builder = std::function<::cl::Program(const Setting&, const Macros&)>;
    explicit FilmKernels(Builder builder) : builder_(std::move(builder)) {}

    /// What film_optics answers to each point; without `absorbing`, the program has no code for layers that absorb.
    /// Points that share layers' thicknesses and direction are quick if they lie side by side, eight at a time.
    std::vector<oracle::FilmOptics> optics(const Setting& setting, const std::vector<FilmPoint>& points,
                                           bool absorbing);

    /// internal_reflectance of each point's film for diffuse light from its base, by at most so many quadrature points;
    /// the point's angle does not count.
    std::vector<double> internal_reflectances(const Setting& setting, const std::vector<FilmPoint>& points,
                                              bool absorbing, int most_quadrature_points);

  private:
    template <typename Store, typename... Arguments>
    void run(const Setting& setting, const char* kernel, std::size_t rows, bool absorbing,
             const std::vector<FilmPoint>& points, const Store& store, const Arguments&... more);
    const ::cl::Program& program(const Setting& setting, bool absorbing);

    Builder builder_;
    std::map<std::tuple<cl_context, bool, bool>, ::cl::Program> programs_;
};

/// The largest of the four differences; infinite if one is no number.
double largest_difference(const oracle::FilmOptics& a, const oracle::FilmOptics& b);

/// An error of what the kernel answered.
using FilmError = std::function<double(const FilmPoint& point, const oracle::FilmOptics& answer)>;

/// Measures the kernel's error at every input: where no layer absorbs, with and without code for layers that do.
Measurement measure_films(FilmKernels& kernels, const Setting& setting, const std::vector<FilmInput>& inputs,
                          const FilmError& error);

/// Against the oracle.
double absolute_error(const FilmPoint& point, const oracle::FilmOptics& answer);

/// How far reflected and transmitted share miss 1 together, or, if something absorbs, exceed it; how far any share is
/// negative.
double power_error(const FilmPoint& point, const oracle::FilmOptics& answer);

} // namespace tristim::selftest
