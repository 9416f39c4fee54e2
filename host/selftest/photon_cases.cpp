#include "selftest/photon_measures.h"

#include "bvh/bvh.h"
#include "opencl/buffer.h"
#include "render/radius_schedule.h"
#include "render/sobol.h"
#include "selftest/photon_oracle.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>

namespace tristim::selftest {
namespace photon {
namespace {

/// One size of work-groups for all: PoCL compiles a kernel for each.
constexpr std::size_t group = 16;

using Vector = std::array<double, 3>;

/// Runs a kernel over inputs that are a multiple of a group.
template <typename... Buffers>
void run(const Setting& setting, const ::cl::Program& program, const char* name, std::size_t items,
         const Buffers&... buffers) {
    ::cl::Kernel kernel(program, name);
    cl_uint index = 0;
    (kernel.setArg(index++, buffers.cl()), ...);
    setting.device.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(items), ::cl::NDRange(group));
}

std::size_t whole_groups(std::size_t count) {
    return (count + group - 1) / group * group;
}

} // namespace

::cl::Program build_cores(const Setting& setting) {
    return build(setting, "photon.cl",
                 {{"BVH_WIDTH", std::to_string(setting.device.tuning.bvh_width)}, {"BVH_STACK_SIZE", "8"}});
}

/// pcg4d, the numbers made of it and Sobol' numbers, bit by bit.
Measurement known_answers(const Setting& setting, const ::cl::Program& cores) {
    std::vector<cl_uint4> coordinates{
        {{0U, 0U, 0U, 0U}}, {{1U, 2U, 3U, 4U}}, {{~0U, ~0U, ~0U, ~0U}}, {{0x80000000U, 1U, 0x7fffffffU, 0U}}};
    std::mt19937 engine(1);
    const auto random = [&engine] { return static_cast<std::uint32_t>(engine()); };
    const std::size_t count = whole_groups(inputs(setting, 4096, 32));
    while (coordinates.size() < count)
        coordinates.push_back({{random(), random(), random(), random()}});
    const Buffer<cl_uint4> in(setting.device, "selftest input", coordinates);
    const Buffer<std::uint32_t> table(setting.device, "Sobol' table", sobol_table());
    const Buffer<cl_uint8> hashed(setting.device, "selftest hashes", count);
    const Buffer<cl_uint8> drawn(setting.device, "selftest numbers", count);
    run(setting, cores, "random_numbers", count, in, table, hashed, drawn);
    const std::vector<cl_uint8> hashes = hashed.read(setting.device);
    const std::vector<cl_uint8> numbers = drawn.read(setting.device);
    const auto unit = [](std::uint32_t bits24) {
        return std::bit_cast<std::uint32_t>(std::ldexp(static_cast<float>(bits24), -24));
    };
    Measurement found;
    for (std::size_t i = 0; i < count; ++i) {
        const auto& [x, y, z, w] = coordinates[i].s;
        const auto a = pcg4d({x, y, z, w});
        // random4(seed w, pass z, path x, dimension y) hashes (path, dimension, pass, seed): the same four.
        const std::array<std::uint32_t, 8> expected{
            a[0], a[1], a[2], a[3], unit(step_hash(x, y) >> 8U), unit(a[0] >> 8U), unit(a[1] >> 8U), unit(z >> 8U)};
        const std::array<std::uint32_t, 8> scrambles{x, y, z, w, a[0], a[1], a[2], a[3]};
        const auto at = [&] { return fmt::format("({}, {}, {}, {})", x, y, z, w); };
        for (std::size_t k = 0; k < 8; ++k) {
            found.add(static_cast<double>(i), std::popcount(expected[k] ^ hashes[i].s[k]), at);
            const std::uint32_t sobol = unit(scrambled_sobol(static_cast<int>(k), x, scrambles[k]));
            found.add(static_cast<double>(i), std::popcount(sobol ^ numbers[i].s[k]), at);
        }
    }
    return found;
}

/// What the kernels' test says of values, against their bits.
Measurement finite_values(const Setting& setting, const ::cl::Program& cores) {
    constexpr float inf = std::numeric_limits<float>::infinity();
    const std::vector<float> special{0.0F,
                                     -0.0F,
                                     1.0F,
                                     -2.5F,
                                     1e-45F,
                                     -1e-40F,
                                     3e38F,
                                     -3e38F,
                                     inf,
                                     -inf,
                                     std::numeric_limits<float>::quiet_NaN(),
                                     -std::numeric_limits<float>::quiet_NaN(),
                                     std::bit_cast<float>(0x7f800001U),
                                     1e20F};
    std::vector<cl_float2> values;
    for (const float a : special) {
        for (const float b : special)
            values.push_back({{a, b}});
    }
    const std::size_t given = values.size();
    values.resize(whole_groups(given));
    const Buffer<cl_float2> in(setting.device, "selftest input", values);
    const Buffer<cl_float4> made(setting.device, "selftest values", values.size());
    const Buffer<cl_int4> said(setting.device, "selftest answers", values.size());
    const Buffer<cl_int2> of_inputs(setting.device, "selftest answers of inputs", values.size());
    run(setting, cores, "finite_values", values.size(), in, made, said, of_inputs);
    const std::vector<cl_float4> results = made.read(setting.device);
    const std::vector<cl_int4> answers = said.read(setting.device);
    const std::vector<cl_int2> input_answers = of_inputs.read(setting.device);
    Measurement found;
    const auto check = [&](float value, int answer, std::size_t i) {
        const bool is = (std::bit_cast<std::uint32_t>(value) & 0x7f800000U) != 0x7f800000U;
        found.add(static_cast<double>(i), is == (answer != 0) ? 0.0 : 1.0,
                  [&] { return fmt::format("{}, of {} and {}", value, values[i].s[0], values[i].s[1]); });
    };
    for (std::size_t i = 0; i < given; ++i) {
        for (std::size_t k = 0; k < 4; ++k)
            check(results[i].s[k], answers[i].s[k], i);
        check(values[i].s[0], input_answers[i].s[0], i);
        check(std::isfinite(values[i].s[0]) && std::isfinite(values[i].s[1]) ? 0.0F : inf, input_answers[i].s[1], i);
    }
    return found;
}

/// The radius of a pass, from the first to the last that has a number; none is raised to the floor.
Measurement radius_of_passes(const Setting& setting, const ::cl::Program& cores) {
    constexpr float initial = 0.01F;
    std::vector<std::uint32_t> passes{0, 1, 2};
    while (passes.back() < 0xfffffffeU)
        passes.push_back(static_cast<std::uint32_t>(std::min(1.37 * passes.back() + 1.0, 4294967294.0)));
    std::vector<double> alphas{0.1, 0.5, radius_alpha, 0.9};
    std::vector<cl_float4> in;
    for (const double alpha : alphas) {
        for (const std::uint32_t pass : passes)
            in.push_back({{initial, static_cast<float>(radius_scale(pass, alpha)), 0.0F, 0.0F}});
    }
    const std::size_t given = in.size();
    in.resize(whole_groups(given), in.back());
    const Buffer<cl_float4> input(setting.device, "selftest input", in);
    const Buffer<float> output(setting.device, "selftest radii", in.size());
    run(setting, cores, "radii", in.size(), input, output);
    const std::vector<float> radii = output.read(setting.device);
    Measurement found;
    for (std::size_t i = 0; i < given; ++i) {
        const std::uint32_t pass = passes[i % passes.size()];
        const double alpha = alphas[i / passes.size()];
        const double exact = double{initial} * exact_radius_scale(pass, alpha);
        found.add(pass, std::abs(radii[i] / exact - 1.0), [&] { return fmt::format("pass {}, α = {}", pass, alpha); });
    }
    return found;
}

/// Photons that rays straight down leave on a triangle of extent 1 around a point near the middle of it, at random
/// within a square; how many the disc of the search radius holds, of how many it should. The radius is a multiple of
/// 2^-23, the rounding of the triangle's points.
Measurement density(const Setting& setting, const ::cl::Program& cores) {
    const auto corner = [](float x, float y) { return std::array{x, y, 0.37F}; };
    const std::array<std::array<float, 3>, 3> vertices{corner(-1.0F, -0.9F), corner(0.93F, -1.0F), corner(0.11F, 1.0F)};
    Triangle triangle{};
    BvhBlocks leaf = empty_leaves(1, setting.device.tuning.bvh_width);
    set_triangle(leaf, 0, 0, {V3f(vertices[0]), V3f(vertices[1]), V3f(vertices[2])}, 0);
    triangle.v0_x = vertices[0][0];
    triangle.v0_y = vertices[0][1];
    triangle.v0_z = vertices[0][2];
    triangle.edge1_x = vertices[1][0] - vertices[0][0];
    triangle.edge1_y = vertices[1][1] - vertices[0][1];
    triangle.edge2_x = vertices[2][0] - vertices[0][0];
    triangle.edge2_y = vertices[2][1] - vertices[0][1];
    triangle.normal_z = 1.0F;
    triangle.extent = 1.0F;
    const Buffer<std::uint32_t> leaves(setting.device, "selftest leaf", leaf.words());
    const Buffer<Triangle> triangles(setting.device, "selftest triangle", std::vector{triangle});

    const std::size_t rays = whole_groups(inputs(setting, 65536, 512));
    constexpr std::size_t centres = 16;
    std::mt19937_64 random(2);
    const auto uniform = [&random](double low, double high) {
        return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
    };
    Measurement found;
    for (const double units : {0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 256.0, 4096.0}) {
        const Buffer<cl_float4> wanted(
            setting.device, "selftest input",
            std::vector<cl_float4>(group, {{static_cast<float>(units * 0x1p-23), 1.0F, 1.0F, 0.0F}}));
        const Buffer<float> radii(setting.device, "selftest radii", group);
        run(setting, cores, "radii", group, wanted, radii);
        const double radius = radii.read(setting.device)[0];
        const double side = 3.0 * radius;
        double inside = 0.0;
        double expected = 0.0;
        for (std::size_t centre = 0; centre < centres; ++centre) {
            // Near zero, where a float's own spacing is far finer than the triangle's points.
            const Vector at{uniform(-1e-2, 1e-2), uniform(-1e-2, 1e-2), 1.0};
            std::vector<cl_float4> origins;
            for (std::size_t i = 0; i < rays / centres / group * group; ++i) {
                const bool first = i == 0;
                origins.push_back(
                    {{static_cast<float>(at[0] + (first ? 0.0 : uniform(-0.5, 0.5) * side)),
                      static_cast<float>(at[1] + (first ? 0.0 : uniform(-0.5, 0.5) * side)), 1.0F, 0.0F}});
            }
            const Buffer<cl_float4> in(setting.device, "selftest rays", origins);
            const Buffer<cl_float4> out(setting.device, "selftest points", origins.size());
            run(setting, cores, "points_below", origins.size(), leaves, triangles, in, out);
            const std::vector<cl_float4> points = out.read(setting.device);
            for (std::size_t i = 1; i < points.size(); ++i) {
                double squared = 0.0;
                for (std::size_t c = 0; c < 3; ++c)
                    squared += std::pow(double{points[i].s[c]} - points[0].s[c], 2);
                inside += points[i].s[3] > 0.0F && squared <= radius * radius ? 1.0 : 0.0;
            }
            expected += static_cast<double>(points.size() - 1) * 3.14159265358979 * radius * radius / (side * side);
        }
        // Chance explains three standard deviations.
        const double chance = 3.0 / std::sqrt(expected);
        found.add(units, std::max(0.0, std::abs(inside / expected - 1.0) - chance),
                  [&] { return fmt::format("a radius of {} × 2^-23 of the triangle's extent", units); });
    }
    return found;
}

} // namespace photon

std::vector<Case> photon_cases() {
    using namespace photon;
    const auto on = [](const Programs& programs, Measurement (*measure)(const Setting&, const ::cl::Program&)) {
        return [=](const Setting& setting) { return measure(setting, programs(setting)); };
    };
    const Programs cores = built_once(build_cores);
    const Programs gather = built_once(build_gather);
    return {
        {"photon", "known answers of the random numbers", "number", "wrong bits", 0.0, 0.0, on(cores, known_answers)},
        {"photon", "values that are not finite are told", "pair of values", "wrong answers", 0.0, 0.0,
         on(cores, finite_values)},
        // Two roundings in float.
        {"photon", "search radius of passes 1 to 2^32", "pass", "radius, relative", 2e-7, 2e-7,
         on(cores, radius_of_passes)},
        // The lattice of points within a circle of eight units' radius, beside what chance explains.
        {"photon", "density of photons at the least radii", "radius / (2^-23 extent)", "beyond 3 sigma, relative", 0.02,
         0.02, on(cores, density)},
        // A few tens of roundings.
        {"photon", "gather, scenes of 1e-12 to 1e12 and far away", "radius / extent", "flux, relative", 1e-6, 1e-6,
         on(gather, gather_everywhere)},
        // A plain sum of n like terms is wrong by 1e-8 n, and blocks are of 1024. No more photons, for llvmpipe's sake,
        // which (Mesa 22.3) ends a kernel's loops after 65535 steps.
        {"photon", "gather, 1 to 2^15 photons in a search", "photons", "flux, relative", 2e-5, 2e-5,
         on(gather, many_photons)},
        {"photon", "gather, photons of 1e-45 to 1e35", "flux", "relative", 2e-6, 2e-6, on(gather, faint_photons)},
    };
}

} // namespace tristim::selftest
