#pragma once

// Running kernel functions from small kernels of a test's own, and judging random results.

#include "opencl/buffer.h"
#include "opencl/program.h"
#include "test_device.h"

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace tristim::kernel_test {

constexpr double unit_roundoff = 0x1p-24; ///< of float

using Vec3 = std::array<double, 3>;

inline Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec3 operator*(double s, const Vec3& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec3 cross(const Vec3& a, const Vec3& b);
double length(const Vec3& a);
Vec3 normalized(const Vec3& a);
inline Vec3 vec3(const cl_float4& v) {
    return {v.s[0], v.s[1], v.s[2]};
}

/// Two unit vectors that make an orthonormal basis with the unit vector n.
std::array<Vec3, 2> tangents(const Vec3& n);

/// The angle of (x, y) as a fraction of a turn, in [0, 1).
double turn(double x, double y);

using test::test_device;

/// A program of a test's own; its text may #include kernel headers and files.
::cl::Program build_test_program(const std::string& text, const Macros& macros = {});

/// Uniform numbers that owe nothing to kernels/rng.h. floats are multiples of 2^-24 in [0, 1), as the kernels' are.
class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    float operator()() { return static_cast<float>(engine_() >> 8) * 0x1p-24F; }
    double operator()(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_()) * 0x1p-32);
    }
    std::uint32_t bits() { return static_cast<std::uint32_t>(engine_()); }
    Vec3 direction();

  private:
    std::mt19937 engine_;
};

/// `count` points of the unit square.
std::vector<cl_float2> random_squares(std::size_t count, std::uint32_t seed);
/// `count` points of the unit hypercube.
std::vector<cl_float4> random_hypercubes(std::size_t count, std::uint32_t seed);

template <typename T>
void set_argument(::cl::Kernel& kernel, cl_uint index, const Buffer<T>& buffer) {
    kernel.setArg(index, buffer.cl());
}
template <typename T>
void set_argument(::cl::Kernel& kernel, cl_uint index, const T& value) {
    kernel.setArg(index, value);
}

/// Runs a kernel over a number of work-items.
template <typename... Arguments>
void run(const ::cl::Program& program, const char* name, std::size_t items, const Arguments&... arguments) {
    ::cl::Kernel kernel(program, name);
    cl_uint index = 0;
    (set_argument(kernel, index++, arguments), ...);
    test_device().queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(items));
}

/// As PhotonSorter::Enqueue: groups as they were asked for, where they divide the work-items.
inline void enqueue_in_groups(const ::cl::Kernel& kernel, std::size_t items, std::size_t group) {
    test_device().queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(items),
                                             items % group == 0 ? ::cl::NDRange(group) : ::cl::NullRange);
}

template <typename T>
Buffer<T> upload(const std::vector<T>& data) {
    return Buffer<T>(test_device(), "test input", data);
}
template <typename T>
Buffer<T> make_buffer(std::size_t count) {
    return Buffer<T>(test_device(), "test output", count);
}

/// The chance that a chi-squared variable with so many degrees of freedom exceeds `statistic`: Q(k/2, χ²/2), the
/// regularised incomplete gamma function (Abramowitz & Stegun 1964, 6.5.29 and 6.5.31).
double chi_squared_tail(double statistic, double degrees_of_freedom);

/// All statistical tests of the suite together report a right implementation as wrong with a chance of 0.01 at most:
/// each one of at most `statistical_tests` checks has the significance 1 - (1 - 0.01)^(1/statistical_tests) (Šidák
/// 1967).
constexpr int statistical_tests = 2000; // 1515 when last counted
double significance_of_one();

/// Counts per bin for expected probabilities (any scale): expect_distribution adds a failure unless a chi-squared test
/// accepts them. Bins that expect fewer than five are pooled; one that expects nothing must have nothing.
class Histogram {
  public:
    explicit Histogram(std::size_t bins) : counts_(bins, 0) {}
    void add(std::size_t bin) { ++counts_.at(bin); }
    /// The bin of position x in [0, 1] among `bins` equal ones.
    static std::size_t bin(double x, std::size_t bins);
    void expect_distribution(const std::string& what, const std::vector<double>& probabilities) const;
    void expect_uniform(const std::string& what) const;

  private:
    std::vector<std::uint64_t> counts_;
};

/// Adds a failure unless |value - expected| is within what a normal variable of this standard error, plus `rounding`,
/// keeps to at the suite's significance.
void expect_mean(const std::string& what, double value, double expected, double standard_error, double rounding = 0.0);

/// Mean and its standard error of a stream of values.
class Moments {
  public:
    void add(double value);
    double mean() const { return mean_; }
    double standard_error() const;

  private:
    double count_ = 0.0, mean_ = 0.0, squares_ = 0.0;
};

} // namespace tristim::kernel_test
