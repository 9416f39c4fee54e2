// kernels/gather.cl on rough surfaces: photons weighed by the BSDF, against a sum over all photons in double precision.

#include "interface_kernel.h"
#include "microfacet_oracle.h"
#include "render/photon_sorter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>

namespace tristim::rough_gather_test {
namespace {

using namespace kernel_test;

constexpr std::uint32_t capacity = 64, items = 40, paths = 3000;
constexpr std::size_t visible_points = 80;
constexpr float radius = 0.2F;

Macros gather_macros() {
    Macros macros = interface_macros();
    macros.emplace_back("HAS_ROUGH_PHOTONS", "1");
    macros.emplace_back("RADIX_BITS", "6");
    return macros;
}

std::vector<std::uint32_t> packed(const std::vector<Vec3>& directions) {
    const ::cl::Program program = build_test_program(R"(
#include "config.h"
#include "sampling.h"
kernel void pack(const global float4* directions, global uint* out, global float4* unpacked) {
    out[get_global_id(0)] = pack_normal(directions[get_global_id(0)].xyz);
    unpacked[get_global_id(0)] = (float4)(unpack_normal(out[get_global_id(0)]), 0.0f);
}
)");
    std::vector<cl_float4> input;
    for (const Vec3& d : directions)
        input.push_back(float4_of(d));
    const Buffer<cl_uint> output = make_buffer<cl_uint>(directions.size());
    const Buffer<cl_float4> unpacked = make_buffer<cl_float4>(directions.size());
    run(program, "pack", directions.size(), upload(input), output, unpacked);
    return output.read(test_device());
}

/// What unpack_normal makes of 16 bits for each of two coordinates on the octahedron.
Vec3 unpacked(std::uint32_t bits) {
    const double x = static_cast<std::int16_t>(bits & 0xffffU) / 32767.0,
                 y = static_cast<std::int16_t>(bits >> 16) / 32767.0;
    Vec3 n{x, y, 1.0 - std::abs(x) - std::abs(y)};
    if (n[2] < 0.0)
        n = {std::copysign(1.0 - std::abs(y), x), std::copysign(1.0 - std::abs(x), y), n[2]};
    return normalized(n);
}

/// A sheet z = 0 with normal +z, whose u runs along a direction in it: visible points and photons on both of its sides.
struct Sheet {
    std::vector<VisiblePoint> points;
    std::vector<VisibleSurface> surfaces;
    std::vector<Photon> photons;
    std::vector<PhotonSurface> photon_surfaces;
    std::vector<std::uint32_t> item_counts;
    std::vector<float> photon_spectra, eye_spectra;
    std::vector<bool> on_other_face;
};

Sheet make_sheet(const CoatedSurface& surface) {
    Random random(80);
    Sheet sheet;
    std::vector<Vec3> directions;
    const auto pack = [&directions](const Vec3& d) {
        directions.push_back(d);
        return static_cast<std::uint32_t>(directions.size() - 1);
    };
    const auto side = [&random] { return random.bits() % 2 == 0 ? 1.0 : -1.0; };
    const auto towards = [&random](double sign) {
        Vec3 d = random.direction();
        d[2] = sign * (std::abs(d[2]) + 0.02); // within the horizon by more than the packing's error
        return normalized(d);
    };
    const auto slot = [&] {
        const bool all = random.bits() % 2 == 0;
        return all ? SLOT_ALL : static_cast<int>(random.bits() % test_wavelengths);
    };
    for (std::size_t i = 0; i < visible_points; ++i) {
        VisiblePoint point{};
        point.x = static_cast<float>(random(-0.5, 0.5));
        point.y = static_cast<float>(random(-0.5, 0.5));
        point.throughput = random() + 0.1F;
        point.radius = i % 2 == 0 ? radius : 0.5F * radius;
        // A path that disperses has chosen its wavelength before it stops here.
        point.slot = surface.dispersive ? static_cast<int>(random.bits() % test_wavelengths) : slot();
        const double up = surface.kind == MATERIAL_DIELECTRIC ? side() : 1.0;
        point.normal = pack({0.0, 0.0, up});
        VisibleSurface at{};
        at.material = 0;
        at.outside = up > 0.0 ? 1 : 0;
        at.outgoing = pack(towards(up));
        at.tangent = pack({0.6, 0.8, 0.0});
        at.thickness = surface.layers.empty() ? 0.0F : static_cast<float>(surface.layers[0].thickness);
        sheet.points.push_back(point);
        sheet.surfaces.push_back(at);
        for (std::size_t w = 0; w < padded_wavelengths; ++w)
            sheet.eye_spectra.push_back(w < test_wavelengths ? random() : 0.0F);
    }
    for (std::uint32_t item = 0; item < items; ++item) {
        sheet.item_counts.push_back(random.bits() % (capacity + 1));
        for (std::uint32_t i = 0; i < capacity; ++i) {
            Photon photon{};
            photon.x = static_cast<float>(random(-0.5, 0.5));
            photon.y = static_cast<float>(random(-0.5, 0.5));
            const double up = side();
            photon.normal = pack({0.0, 0.0, up});
            photon.flux_x = random();
            photon.flux_y = random();
            photon.flux_z = random();
            photon.slot = slot();
            sheet.photons.push_back(photon);
            // Some lie on other surfaces, here.
            const int outside = up > 0.0 ? 1 : 0;
            const int own_side = i % 8 == 7 ? (i % 16 == 7 ? -1 : 2 + outside) : outside;
            // And some on the other face of a slab that is all but as thin as a sheet: its outside is this one's
            // inside.
            const bool other_face = random.bits() % 4 == 0;
            sheet.photon_surfaces.push_back({own_side >= 0 && other_face ? own_side ^ 1 : own_side, pack(towards(up))});
            sheet.on_other_face.push_back(other_face);
            const float absent = std::numeric_limits<float>::quiet_NaN();
            for (std::size_t w = 0; w < padded_wavelengths; ++w)
                sheet.photon_spectra.push_back(photon.slot != SLOT_ALL ? absent
                                               : w < test_wavelengths  ? random()
                                                                       : 0.0F);
        }
    }
    const std::vector<std::uint32_t> bits = packed(directions);
    for (VisiblePoint& point : sheet.points)
        point.normal = bits[point.normal];
    for (VisibleSurface& at : sheet.surfaces) {
        at.outgoing = bits[at.outgoing];
        at.tangent = bits[at.tangent];
    }
    for (Photon& photon : sheet.photons)
        photon.normal = bits[photon.normal];
    for (PhotonSurface& at : sheet.photon_surfaces)
        at.incident = bits[at.incident];
    return sheet;
}

struct Expected {
    Vec3 flux{}, tolerance{};
    std::uint32_t count = 0;
};

/// BSDF for the camera's radiance at one wavelength, and what the rounding of directions changes.
struct Value {
    double f = 0.0, tolerance = 0.0;
};
Value bsdf(const CoatedSurface& surface, const VisibleSurface& at, std::uint32_t incident, std::size_t w) {
    const bool outside = at.outside != 0;
    const Vec3 n{0.0, 0.0, outside ? 1.0 : -1.0};
    const Vec3 s = unpacked(at.tangent), t = cross(n, s);
    const Vec3 eye = unpacked(at.outgoing), light = unpacked(incident);
    const Vec3 wo{dot(eye, s), dot(eye, t), dot(eye, n)}, wi{dot(light, s), dot(light, t), dot(light, n)};
    const Ggx ggx(surface.alpha);
    const auto evaluate = [&](const Vec3& v) {
        if (v[2] > 0.0)
            return ggx.reflection(wo, v) *
                   surface.shares(w, std::min(dot(wo, Ggx::reflecting(wo, v)), 1.0), outside).reflected;
        const double eta = outside ? surface.n[w] : 1.0 / surface.n[w];
        const Vec3 m = Ggx::refracting(wo, v, eta);
        if (surface.kind == MATERIAL_CONDUCTOR || !Ggx::refracts(wo, v, m))
            return 0.0;
        return ggx.refraction(wo, v, eta) / (eta * eta) *
               surface.shares(w, std::min(dot(wo, m), 1.0), outside).transmitted;
    };
    const double f = evaluate(wi);
    double tolerance = 2e-5 * f + 1e-9;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Vec3 moved = wi;
        moved[axis] += 16.0 * unit_roundoff; // as in kernel_interface_rough_test.cpp
        tolerance += 2.0 * std::abs(evaluate(moved) - f);
    }
    return {f, tolerance};
}

Expected brute_force(const CoatedSurface& surface, const Sheet& sheet, const std::vector<float>& table,
                     std::size_t pixel) {
    const VisiblePoint& point = sheet.points[pixel];
    const VisibleSurface& at = sheet.surfaces[pixel];
    const auto weight = [&](std::size_t w) {
        return Vec3{table[padded_wavelengths + w], table[2 * padded_wavelengths + w],
                    table[3 * padded_wavelengths + w]};
    };
    Expected sum;
    const auto add = [&sum](const Value& value, const Vec3& flux) {
        for (std::size_t c = 0; c < 3; ++c) {
            sum.flux[c] += value.f * flux[c];
            sum.tolerance[c] += (value.tolerance + 2e-6 * value.f) * flux[c];
        }
    };
    for (std::size_t index = 0; index < sheet.photons.size(); ++index) {
        const Photon& photon = sheet.photons[index];
        const int side = sheet.photon_surfaces[index].side;
        if (index % capacity >= sheet.item_counts[index / capacity] || side < 0 || side > 1 ||
            sheet.on_other_face[index])
            continue;
        const double dx = double{photon.x} - point.x, dy = double{photon.y} - point.y;
        if (dx * dx + dy * dy > double{point.radius} * point.radius)
            continue;
        if (point.slot >= 0 && photon.slot >= 0 && photon.slot != point.slot)
            continue;
        const float* spectrum = sheet.photon_spectra.data() + index * padded_wavelengths;
        const float* eye = sheet.eye_spectra.data() + pixel * padded_wavelengths;
        const std::uint32_t incident = sheet.photon_surfaces[index].incident;
        const Vec3 flux{photon.flux_x, photon.flux_y, photon.flux_z};
        double any = 0.0;
        if (photon.slot >= 0) {
            const auto s = static_cast<std::size_t>(photon.slot);
            const Value value = bsdf(surface, at, incident, s);
            add(value, (point.slot >= 0 ? 1.0 : double{eye[s]}) * flux);
            any = value.f;
        } else {
            for (std::size_t w = 0; w < test_wavelengths; ++w) {
                if (point.slot >= 0 && point.slot != static_cast<int>(w))
                    continue;
                const Value value = bsdf(surface, at, incident, w);
                add(value, double{spectrum[w]} * (point.slot >= 0 ? 1.0 : double{eye[w]}) * weight(w));
                any += value.f;
            }
        }
        sum.count += any > 0.0 ? 1 : 0;
    }
    const double scale = double{point.throughput} / paths;
    sum.flux = scale * sum.flux;
    sum.tolerance = scale * sum.tolerance;
    return sum;
}

void check(const CoatedSurface& surface) {
    SCOPED_TRACE(surface.name);
    const Device& device = test_device();
    const Sheet sheet = make_sheet(surface);
    std::vector<float> table = pass_table_of(surface);
    for (std::size_t w = 0; w < test_wavelengths; ++w) {
        for (std::size_t c = 0; c < 3; ++c)
            table[(1 + c) * padded_wavelengths + w] = 0.1F + 0.13F * static_cast<float>((w + 2 * c) % 5);
    }
    PhotonSorter sorter(device, gather_macros(), {}, 6);
    sorter.allocate(device, items, capacity);
    sorter.count(device, upload(sheet.item_counts), enqueue_in_groups);
    const Buffer<SceneConstants> constants = upload(std::vector{SceneConstants{}});
    const Buffer<Photon> photons = upload(sheet.photons);
    const Buffer<std::uint32_t> largest = upload(std::vector{std::bit_cast<std::uint32_t>(radius)});
    sorter.sort(constants, photons, largest, enqueue_in_groups);
    std::vector<SceneFilmLayer> layers = layers_of(surface);
    layers.emplace_back();
    const Buffer<cl_float4> gathered = make_buffer<cl_float4>(visible_points);
    run(build_program(device, "gather.cl", gather_macros(), {}), "gather", visible_points, constants, upload(table),
        upload(sheet.points), upload(sheet.eye_spectra), photons, upload(sheet.photon_spectra), sorter.pairs(),
        sorter.bucket_begin(), largest, paths, upload(sheet.surfaces), upload(sheet.photon_surfaces),
        upload(std::vector{material_of(surface), material_of(surface)}), upload(layers), gathered,
        make_buffer<cl_uint>(2 * NON_FINITE_COUNTS));
    const std::vector<cl_float4> results = gathered.read(device);
    std::uint64_t found = 0;
    for (std::size_t pixel = 0; pixel < visible_points; ++pixel) {
        const Expected expected = brute_force(surface, sheet, table, pixel);
        found += expected.count;
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(results[pixel].s[c], expected.flux[c], expected.tolerance[c])
                << "pixel " << pixel << ", slot " << sheet.points[pixel].slot << ", channel " << c;
        // At the edge of what facets refract rounding decides.
        ASSERT_NEAR(results[pixel].s[3], expected.count, 1.0) << "pixel " << pixel;
    }
    EXPECT_GT(found, 1000U) << "too few photons near the points to tell anything";
}

TEST(KernelGatherRough, WeighsPhotonsByTheBsdfFromBothSides) {
    const PerWavelength glass{1.5F, 1.5F, 1.5F, 1.5F, 1.5F, 1.5F};
    const PerWavelength flint{1.68F, 1.66F, 1.64F, 1.63F, 1.62F, 1.61F};
    const PerWavelength metal_n{1.4F, 1.3F, 1.0F, 0.6F, 0.3F, 0.2F}, metal_k{1.9F, 1.9F, 2.0F, 2.2F, 2.8F, 3.3F};
    const FilmOfTest film{250.0, {2.9F, 2.75F, 2.65F, 2.6F, 2.55F, 2.5F}, {0.1F, 0.1F, 0.05F, 0.0F, 0.0F, 0.0F}};
    check({"glass", MATERIAL_DIELECTRIC, false, glass, {}, {}, {{0.3F, 0.3F}}});
    check({"coated glass", MATERIAL_DIELECTRIC, false, glass, {}, {film}, {{0.25F, 0.6F}}});
    check({"coated flint", MATERIAL_DIELECTRIC, true, flint, {}, {film, film}, {{0.4F, 0.4F}}});
    check({"coated metal", MATERIAL_CONDUCTOR, false, metal_n, metal_k, {film}, {{0.2F, 0.5F}}});
}

} // namespace
} // namespace tristim::rough_gather_test
