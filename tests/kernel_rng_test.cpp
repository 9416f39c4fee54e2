// pcg4d and the numbers made of it: kernels/rng.h.

#include "kernel_harness.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace kernel_test;

const char* const rng_source = R"(
#include "rng.h"
kernel void hash(const global uint4* inputs, global uint4* outputs) {
    outputs[get_global_id(0)] = pcg4d(inputs[get_global_id(0)]);
}
kernel void numbers(const global uint4* coordinates, global float4* outputs) {
    const uint4 c = coordinates[get_global_id(0)];
    outputs[get_global_id(0)] = random4(c.x, c.y, c.z, c.w);
}
kernel void floats(const global uint* bits, global float* outputs) {
    outputs[get_global_id(0)] = unit_float(bits[get_global_id(0)]);
}
)";

struct Coordinates {
    std::uint32_t seed, pass, path, dimension;
};

std::vector<cl_float4> numbers(const std::vector<Coordinates>& coordinates) {
    const ::cl::Program program = build_test_program(rng_source);
    std::vector<cl_uint4> inputs;
    for (const Coordinates& c : coordinates)
        inputs.push_back({{c.seed, c.pass, c.path, c.dimension}});
    const Buffer<cl_uint4> input = upload(inputs);
    const Buffer<cl_float4> output = make_buffer<cl_float4>(inputs.size());
    run(program, "numbers", inputs.size(), input, output);
    return output.read(test_device());
}

/// pcg4d once more, from the text of Jarzynski & Olano 2020, section 4.2: a linear congruential step of each component,
/// two rounds of x += y w, y += z x, z += x y, w += y z, and between them an xor with the upper halves.
std::array<std::uint32_t, 4> pcg4d(std::array<std::uint32_t, 4> v) {
    for (std::uint32_t& component : v)
        component = component * 1664525U + 1013904223U;
    constexpr std::array<std::array<std::size_t, 3>, 4> round{{{0, 1, 3}, {1, 2, 0}, {2, 0, 1}, {3, 1, 2}}};
    const auto mix = [&] {
        for (const auto& [target, a, b] : round)
            v[target] += v[a] * v[b];
    };
    for (int i = 0; i < 2; ++i) {
        mix();
        for (std::uint32_t& component : v)
            component ^= component >> 16;
    }
    return v;
}

TEST(KernelRng, HashIsPcg4d) {
    Random random(1);
    std::vector<cl_uint4> inputs{{{0, 0, 0, 0}}, {{~0U, ~0U, ~0U, ~0U}}, {{1, 2, 3, 4}}};
    for (int i = 0; i < 1000; ++i)
        inputs.push_back({{random.bits(), random.bits(), random.bits(), random.bits()}});
    const Buffer<cl_uint4> output = make_buffer<cl_uint4>(inputs.size());
    run(build_test_program(rng_source), "hash", inputs.size(), upload(inputs), output);
    const std::vector<cl_uint4> hashes = output.read(test_device());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const auto expected = pcg4d({inputs[i].s[0], inputs[i].s[1], inputs[i].s[2], inputs[i].s[3]});
        for (std::size_t c = 0; c < 4; ++c)
            ASSERT_EQ(hashes[i].s[c], expected[c]) << "input " << i << ", component " << c;
    }
}

TEST(KernelRng, UnitFloatsStayBelowOneAndKeep24Bits) {
    const std::vector<std::uint32_t> bits{0U, 0xffU, 0x100U, 0x80000000U, 0xffffff00U, 0xffffffffU};
    const std::vector<float> expected{0.0F, 0.0F, 0x1p-24F, 0.5F, 0x1.fffffep-1F, 0x1.fffffep-1F};
    const Buffer<float> output = make_buffer<float>(bits.size());
    run(build_test_program(rng_source), "floats", bits.size(), upload(bits), output);
    EXPECT_EQ(output.read(test_device()), expected);
}

constexpr std::size_t samples = 1 << 18;

/// Streams of numbers along each coordinate, which must be uniform, and independent of their neighbours.
std::vector<std::pair<std::string, std::vector<Coordinates>>> streams() {
    std::vector<std::pair<std::string, std::vector<Coordinates>>> result;
    const auto add = [&result](const char* name, auto coordinates) {
        std::vector<Coordinates> stream;
        for (std::uint32_t i = 0; i < samples; ++i)
            stream.push_back(coordinates(i));
        result.emplace_back(name, stream);
    };
    add("paths", [](std::uint32_t i) { return Coordinates{0, 0, i, 0x30000U}; });
    add("passes", [](std::uint32_t i) { return Coordinates{0, i, 0, 0x30000U}; });
    add("dimensions", [](std::uint32_t i) { return Coordinates{0, 0, 0, 0x30000U + i}; });
    add("seeds", [](std::uint32_t i) { return Coordinates{i, 0, 0, 0x30000U}; });
    add("dimensions of paths", [](std::uint32_t i) { return Coordinates{7, 3, i / 16, 0x20000U + i % 16}; });
    add("paths of passes", [](std::uint32_t i) { return Coordinates{1, i % 512, i / 512, 0x10000U}; });
    return result;
}

TEST(KernelRng, NumbersAreUniform) {
    for (const auto& [name, coordinates] : streams()) {
        const std::vector<cl_float4> values = numbers(coordinates);
        for (std::size_t c = 0; c < 4; ++c) {
            Histogram histogram(256);
            for (const cl_float4& value : values)
                histogram.add(Histogram::bin(value.s[c], 256));
            histogram.expect_uniform(fmt::format("component {} along {}", c, name));
        }
    }
}

TEST(KernelRng, NeighboursAreIndependent) {
    constexpr std::size_t side = 16;
    for (const auto& [name, coordinates] : streams()) {
        const std::vector<cl_float4> values = numbers(coordinates);
        for (std::size_t a = 0; a < 4; ++a) {
            for (std::size_t b = 0; b < 4; ++b) {
                Histogram neighbours(side * side);
                Histogram components(side * side);
                // Pairs do not overlap: every second one.
                for (std::size_t i = 0; i + 1 < values.size(); i += 2)
                    neighbours.add(Histogram::bin(values[i].s[a], side) * side +
                                   Histogram::bin(values[i + 1].s[b], side));
                neighbours.expect_uniform(fmt::format("components {} and {} of neighbours along {}", a, b, name));
                if (a >= b)
                    continue;
                for (const cl_float4& value : values)
                    components.add(Histogram::bin(value.s[a], side) * side + Histogram::bin(value.s[b], side));
                components.expect_uniform(fmt::format("components {} and {} along {}", a, b, name));
            }
        }
    }
}

/// Scramblings and slots are taken from the low bits, of neighbouring pixels in x and y too.
TEST(KernelRng, LowBitsOfNeighboursAreIndependent) {
    constexpr std::uint32_t low = 15;
    const ::cl::Program program = build_test_program(rng_source);
    const auto hashes = [&](std::uint32_t stream, std::uint32_t counter, std::uint32_t seed) {
        std::vector<cl_uint4> inputs;
        for (std::uint32_t pixel = 0; pixel < samples / 2; ++pixel)
            inputs.push_back({{pixel, stream, counter, seed}});
        const Buffer<cl_uint4> output = make_buffer<cl_uint4>(inputs.size());
        run(program, "hash", inputs.size(), upload(inputs), output);
        return output.read(test_device());
    };
    for (const std::uint32_t seed : {0U, 12345U}) {
        const std::vector<cl_uint4> here = hashes(0x20000U, 0, seed);
        const std::vector<cl_uint4> next = hashes(0x20000U, 1, seed);
        for (std::size_t a = 0; a < 4; ++a) {
            for (std::size_t b = 0; b < 4; ++b) {
                Histogram counters(256), pixels(256), rows(256);
                constexpr std::size_t width = 256;
                for (std::size_t i = 0; i + width < here.size(); ++i) {
                    const std::size_t value = 16U * (here[i].s[a] & low);
                    counters.add(value + (next[i].s[b] & low));
                    if (i % 2 == 0)
                        pixels.add(value + (here[i + 1].s[b] & low));
                    if (i / width % 2 == 0)
                        rows.add(value + (here[i + width].s[b] & low));
                }
                const std::string which = fmt::format(", components {} and {}, seed {}", a, b, seed);
                counters.expect_uniform("low bits of counters 0 and 1" + which);
                pixels.expect_uniform("low bits of neighbours" + which);
                rows.expect_uniform("low bits of neighbours in rows of 256" + which);
            }
        }
    }
}

} // namespace
} // namespace tristim
