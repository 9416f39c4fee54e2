// kernels/gather.cl against a search of all photons in double precision.

#include "kernel_harness.h"
#include "render/photon_sorter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>

namespace tristim {
namespace {

using namespace kernel_test;

/// What the program is built for: wavelengths, their vectors, and the effects that decide what photons and camera paths
/// carry.
struct Build {
    std::string name;
    int w, lanes, blocks;
    bool spectral_flux, coloured_eye;
    int radix_bits;
    double scale;           ///< of the scene
    double radius = 0.0625; ///< the largest, of a scene of scale 1

    int padded() const { return lanes * blocks; }
    Macros macros() const {
        return {{"W", std::to_string(w)},
                {"LANES", std::to_string(lanes)},
                {"BLOCKS", std::to_string(blocks)},
                {"HAS_DIELECTRIC", spectral_flux ? "1" : "0"},
                {"HAS_DISPERSION", spectral_flux ? "1" : "0"},
                {"HAS_CONDUCTOR", coloured_eye ? "1" : "0"},
                {"RADIX_BITS", std::to_string(radix_bits)}};
    }
};

constexpr std::uint32_t capacity = 64;
constexpr std::uint32_t items = 300;
constexpr std::uint32_t paths = 5000;
constexpr std::size_t visible_points = 600;

/// Axes and, after them, vectors halfway between two: their cosines to the axes are 0, ±0.71 and ±1, far from the limit
/// of 0.5.
std::vector<Vec3> test_normals() {
    std::vector<Vec3> normals;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
            Vec3 n{};
            n[axis] = sign;
            normals.push_back(n);
        }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
            Vec3 n{};
            n[axis] = sign;
            n[(axis + 1) % 3] = 1.0;
            normals.push_back(normalized(n));
        }
    }
    return normals;
}

std::vector<std::uint32_t> packed(const std::vector<Vec3>& normals) {
    const ::cl::Program program = build_test_program(R"(
#include "config.h"
#include "sampling.h"
kernel void pack(const global float4* normals, global uint* out) {
    out[get_global_id(0)] = pack_normal(normals[get_global_id(0)].xyz);
}
)");
    std::vector<cl_float4> input;
    for (const Vec3& n : normals)
        input.push_back({{static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2]), 0.0F}});
    const Buffer<cl_uint> output = make_buffer<cl_uint>(normals.size());
    run(program, "pack", normals.size(), upload(input), output);
    return output.read(test_device());
}

struct Data {
    SceneConstants constants{};
    float largest_radius = 0.0F;
    std::vector<VisiblePoint> points;
    std::vector<std::size_t> point_normals, photon_normals;
    std::vector<std::uint32_t> item_counts;
    std::vector<Photon> photons;
    std::vector<float> photon_spectra, eye_spectra, pass_table;
};

Vec3 place(const VisiblePoint& p) {
    return {p.x, p.y, p.z};
}
Vec3 place(const Photon& p) {
    return {p.x, p.y, p.z};
}

Data make_data(const Build& build) {
    Random random(60);
    Data data;
    const double scale = build.scale;
    const Vec3 centre{0.25 * scale, -0.5 * scale, scale};
    data.constants.centre_x = static_cast<float>(centre[0]);
    data.constants.centre_y = static_cast<float>(centre[1]);
    data.constants.centre_z = static_cast<float>(centre[2]);
    data.largest_radius = static_cast<float>(build.radius * scale);
    const double cell = 2.0 * data.largest_radius;
    const std::vector<std::uint32_t> normals = packed(test_normals());

    // A coordinate anywhere near the centre, at times exactly on a border of cells or the next float
    // to it.
    const auto coordinate = [&](std::size_t axis) {
        const double x = centre[axis] + scale * random(-0.3, 0.3);
        if (random.bits() % 4 != 0)
            return static_cast<float>(x);
        const auto border = static_cast<float>(centre[axis] + cell * std::round((x - centre[axis]) / cell));
        const std::uint32_t kind = random.bits() % 3;
        return kind == 0 ? border : std::nextafter(border, kind == 1 ? -1e9F : 1e9F);
    };
    const auto slot = [&] {
        const bool all = !build.spectral_flux || random.bits() % 2 == 0;
        return all ? SLOT_ALL : static_cast<int>(random.bits() % static_cast<unsigned>(build.w));
    };
    for (std::size_t i = 0; i < visible_points; ++i) {
        VisiblePoint point{};
        point.x = coordinate(0);
        point.y = coordinate(1);
        point.z = coordinate(2);
        point.slot = i % 20 == 19 ? SLOT_NONE : slot();
        point.throughput = random() + 0.1F;
        constexpr std::array<float, 4> shares{1.0F, 0.9F, 0.3F, 0.1F};
        point.radius = data.largest_radius * shares[i % 4];
        data.point_normals.push_back(random.bits() % 6);
        point.normal = normals[data.point_normals.back()];
        data.points.push_back(point);
        for (int w = 0; w < build.padded(); ++w)
            data.eye_spectra.push_back(w < build.w ? random() : 0.0F);
    }
    // The rounding of point ± radius, one unit of coordinates up to 1.5 scale, decides near a sphere's surface: no
    // photon there.
    const double margin = 2.5e-7 * scale;
    const auto near_a_surface = [&](const Photon& photon) {
        return std::any_of(data.points.begin(), data.points.end(), [&](const VisiblePoint& point) {
            return std::abs(length(place(photon) - place(point)) - point.radius) < margin;
        });
    };
    for (std::uint32_t item = 0; item < items; ++item) {
        data.item_counts.push_back(random.bits() % (capacity + 1));
        for (std::uint32_t i = 0; i < capacity; ++i) {
            Photon photon{};
            do {
                photon.x = coordinate(0);
                photon.y = coordinate(1);
                photon.z = coordinate(2);
                if (i % 2 == 0) { // around a visible point
                    const VisiblePoint& point = data.points[random.bits() % data.points.size()];
                    photon.x = point.x + static_cast<float>(1.2 * point.radius * random(-1.0, 1.0));
                    photon.y = point.y + static_cast<float>(1.2 * point.radius * random(-1.0, 1.0));
                    photon.z = point.z + static_cast<float>(1.2 * point.radius * random(-1.0, 1.0));
                }
            } while (near_a_surface(photon));
            photon.flux_x = random();
            photon.flux_y = random();
            photon.flux_z = random();
            photon.slot = slot();
            data.photon_normals.push_back(random.bits() % normals.size());
            photon.normal = normals[data.photon_normals.back()];
            data.photons.push_back(photon);
            // Photons of one slot have no spectrum: nothing may read it.
            const float absent = std::numeric_limits<float>::quiet_NaN();
            for (int w = 0; w < build.padded(); ++w)
                data.photon_spectra.push_back(photon.slot != SLOT_ALL ? absent : w < build.w ? random() : 0.0F);
        }
    }
    for (int row = 0; row < 4; ++row)
        for (int w = 0; w < build.padded(); ++w)
            data.pass_table.push_back(w < build.w ? random() : 0.0F);
    return data;
}

struct Expected {
    Vec3 flux{};
    std::uint32_t count = 0;
};

Expected brute_force(const Build& build, const Data& data, std::size_t pixel) {
    static const std::vector<Vec3> normals = test_normals();
    Expected expected;
    const VisiblePoint& point = data.points[pixel];
    if (point.slot == SLOT_NONE)
        return expected;
    const auto padded = static_cast<std::size_t>(build.padded());
    const auto weight = [&](std::size_t w) {
        return Vec3{data.pass_table[padded + w], data.pass_table[2 * padded + w], data.pass_table[3 * padded + w]};
    };
    for (std::size_t index = 0; index < data.photons.size(); ++index) {
        if (index % capacity >= data.item_counts[index / capacity])
            continue;
        const Photon& photon = data.photons[index];
        if (length(place(photon) - place(point)) > point.radius)
            continue;
        if (dot(normals[data.point_normals[pixel]], normals[data.photon_normals[index]]) < 0.5)
            continue;
        const Vec3 flux{photon.flux_x, photon.flux_y, photon.flux_z};
        const float* spectrum = data.photon_spectra.data() + index * padded;
        const float* eye = data.eye_spectra.data() + pixel * padded;
        if (point.slot >= 0 && photon.slot == SLOT_ALL) {
            const auto s = static_cast<std::size_t>(point.slot);
            expected.flux = expected.flux + double{spectrum[s]} * weight(s);
        } else if (point.slot >= 0 && photon.slot != point.slot) {
            continue;
        } else if (point.slot >= 0 || !build.coloured_eye) {
            expected.flux = expected.flux + flux;
        } else if (photon.slot >= 0) {
            expected.flux = expected.flux + double{eye[photon.slot]} * flux;
        } else {
            for (std::size_t w = 0; w < static_cast<std::size_t>(build.w); ++w)
                expected.flux = expected.flux + double{spectrum[w]} * double{eye[w]} * weight(w);
        }
        ++expected.count;
    }
    expected.flux = (double{point.throughput} / paths) * expected.flux;
    return expected;
}

void check(const Build& build) {
    SCOPED_TRACE(build.name);
    const Device& device = test_device();
    const Data data = make_data(build);
    PhotonSorter sorter(device, build.macros(), {}, build.radix_bits);
    sorter.allocate(device, items, capacity);
    sorter.count(device, upload(data.item_counts), enqueue_in_groups);
    const Buffer<SceneConstants> constants = upload(std::vector{data.constants});
    const Buffer<Photon> photons = upload(data.photons);
    const Buffer<std::uint32_t> radius = upload(std::vector{std::bit_cast<std::uint32_t>(data.largest_radius)});
    sorter.sort(constants, photons, radius, enqueue_in_groups);
    const Buffer<cl_float4> gathered = make_buffer<cl_float4>(visible_points);
    run(build_program(device, "gather.cl", build.macros(), {}), "gather", visible_points, constants,
        upload(data.pass_table), upload(data.points), upload(data.eye_spectra), photons, upload(data.photon_spectra),
        sorter.pairs(), sorter.bucket_begin(), radius, paths, make_buffer<VisibleSurface>(0),
        make_buffer<PhotonSurface>(0), make_buffer<SurfaceMaterial>(0), make_buffer<SceneFilmLayer>(0), gathered,
        make_buffer<cl_uint>(2 * NON_FINITE_COUNTS));
    const std::vector<cl_float4> results = gathered.read(device);

    std::uint64_t found = 0;
    for (std::size_t pixel = 0; pixel < visible_points; ++pixel) {
        const VisiblePoint& point = data.points[pixel];
        const Expected expected = brute_force(build, data, pixel);
        const std::string at = fmt::format("pixel {} at ({}, {}, {}), radius {}, slot {}", pixel, point.x, point.y,
                                           point.z, point.radius, point.slot);
        ASSERT_EQ(results[pixel].s[3], static_cast<float>(expected.count)) << at;
        found += expected.count;
        for (std::size_t c = 0; c < 3; ++c) {
            // Sums of positive terms: one rounding for each photon and wavelength, and a few for the products.
            const double tolerance = (expected.count + build.w + 16.0) * unit_roundoff * expected.flux[c];
            ASSERT_NEAR(results[pixel].s[c], expected.flux[c], tolerance) << at << ", channel " << c;
        }
    }
    EXPECT_GT(found, 300U) << "too few photons near the points to tell anything";
}

TEST(KernelGather, FindsThePhotonsOfGreyScenes) {
    check({"grey", 3, 4, 1, false, false, 8, 1.0});
    check({"grey, 256 buckets", 3, 4, 1, false, false, 4, 1.0});
    check({"grey, small scene", 3, 4, 1, false, false, 7, 1.0 / 1024.0});
    check({"grey, large scene", 3, 4, 1, false, false, 7, 4096.0});
    check({"grey, radius of 1/1000", 3, 4, 1, false, false, 7, 1.0, 1e-3});
    check({"grey, radius of 1/10000, a thousand roundings of a coordinate", 3, 4, 1, false, false, 7, 1.0, 1e-4});
    check({"grey, radius of a few roundings of a coordinate", 3, 4, 1, false, false, 7, 1.0, 2e-6});
}

TEST(KernelGather, MatchesSlotsWhereGlassDisperses) {
    check({"dispersion", 3, 4, 1, true, false, 8, 1.0});
    check({"dispersion, 12 wavelengths, 256 buckets", 12, 16, 1, true, false, 4, 1.0});
}

TEST(KernelGather, WeighsSpectraOfColouredCameraPaths) {
    check({"coloured", 3, 4, 1, true, true, 8, 1.0});
    check({"coloured, 18 wavelengths in two blocks, 256 buckets", 18, 16, 2, true, true, 4, 1.0});
    check({"coloured, 6 wavelengths", 6, 8, 1, true, true, 6, 1.0});
}

} // namespace
} // namespace tristim
