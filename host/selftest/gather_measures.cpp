#include "selftest/photon_measures.h"

#include "render/photon_sorter.h"
#include "selftest/photon_oracle.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace tristim::selftest::photon {
namespace {

/// One size of work-groups for all: PoCL compiles a kernel for each.
constexpr std::size_t group = 16;

constexpr int radix_bits = 6;

using Vector = std::array<double, 3>;

/// gather.cl as a render builds it for a grey scene.
struct Gatherer {
    std::vector<cl_float4> run(const SceneConstants& constants, const std::vector<VisiblePoint>& points,
                               const Buffer<Photon>& photons, const Buffer<cl_uint2>& pairs,
                               const Buffer<std::uint32_t>& begin, float largest_radius, std::uint32_t paths) const {
        const Device& d = setting.device;
        const Buffer<SceneConstants> c(d, "selftest constants", std::vector{constants});
        const Buffer<float> table(d, "selftest table", std::vector<float>(16, 0.0F));
        const Buffer<VisiblePoint> p(d, "selftest points", points);
        const Buffer<float> spectra(d, "selftest spectra", 4);
        const Buffer<std::uint32_t> largest(d, "selftest radius",
                                            std::vector{std::bit_cast<std::uint32_t>(largest_radius)});
        const Buffer<VisibleSurface> surfaces(d, "selftest surfaces", 0);
        const Buffer<PhotonSurface> photon_surfaces(d, "selftest photon surfaces", 0);
        const Buffer<SurfaceMaterial> materials(d, "selftest materials", 0);
        const Buffer<SceneFilmLayer> layers(d, "selftest layers", 0);
        const Buffer<cl_float4> gathered(d, "selftest flux", points.size());
        const Buffer<std::uint32_t> non_finite(d, "selftest counts",
                                               std::vector<std::uint32_t>(2 * NON_FINITE_COUNTS, 0U));
        ::cl::Kernel kernel(program, "gather");
        cl_uint index = 0;
        for (const ::cl::Buffer* buffer : {&c.cl(), &table.cl(), &p.cl(), &spectra.cl(), &photons.cl(), &spectra.cl(),
                                           &pairs.cl(), &begin.cl(), &largest.cl()})
            kernel.setArg(index++, *buffer);
        kernel.setArg(index++, paths);
        for (const ::cl::Buffer* buffer :
             {&surfaces.cl(), &photon_surfaces.cl(), &materials.cl(), &layers.cl(), &gathered.cl(), &non_finite.cl()})
            kernel.setArg(index++, *buffer);
        d.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(points.size()), ::cl::NDRange(group));
        return gathered.read(d);
    }

    const Setting& setting;
    const ::cl::Program& program;
};

/// Axes as the kernels pack them (octahedral, 16 bits each).
constexpr std::array<std::uint32_t, 6> packed_axes{0x00007fffU, 0x00008001U, 0x7fff0000U, 0x80010000U, 0U, 0x7fff7fffU};
Vector axis(std::size_t i) {
    Vector v{};
    v[i / 2] = i % 2 == 0 ? 1.0 : -1.0;
    return v;
}

/// A scene of extent `size` whose centre is `away` sizes from the origin, searched with `share` of its size.
struct Place {
    double size, away, share;
};

std::string describe(const Place& p) {
    return fmt::format("a scene of size {:.0e}, {:g} sizes from the origin, radius {:.1e} of its extent", p.size,
                       p.away, p.share);
}

/// Photons found at one place, against all of them.
void gather_at(const Gatherer& gatherer, const Place& place, Measurement& found) {
    const Setting& setting = gatherer.setting;
    std::mt19937_64 random(3);
    const auto uniform = [&random](double low, double high) {
        return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
    };
    const Vector centre{place.size * place.away, -0.5 * place.size * place.away, 0.25 * place.size * place.away};
    const double extent = place.size * (std::abs(place.away) + 1.0);
    const auto radius = static_cast<float>(std::max(place.share, double{SMALLEST_RELATIVE_RADIUS}) * extent);
    constexpr std::uint32_t capacity = 64;
    const auto items = static_cast<std::uint32_t>(std::max<std::size_t>(16, setting.device.tuning.item_group));
    constexpr std::uint32_t paths = 1000;
    SceneConstants constants{};
    constants.centre_x = static_cast<float>(centre[0]);
    constants.centre_y = static_cast<float>(centre[1]);
    constants.centre_z = static_cast<float>(centre[2]);
    const auto near_point = [&](const VisiblePoint& p, std::size_t c) {
        const float at = c == 0 ? p.x : c == 1 ? p.y : p.z;
        return static_cast<float>(at + 1.1 * radius * uniform(-1.0, 1.0));
    };
    std::vector<VisiblePoint> points((inputs(setting, 64, 16) + group - 1) / group * group);
    std::vector<std::size_t> axes;
    for (VisiblePoint& p : points) {
        p = {};
        p.x = static_cast<float>(centre[0] + place.size * uniform(-0.5, 0.5));
        p.y = static_cast<float>(centre[1] + place.size * uniform(-0.5, 0.5));
        p.z = static_cast<float>(centre[2] + place.size * uniform(-0.5, 0.5));
        axes.push_back(random() % 6);
        p.normal = packed_axes[axes.back()];
        p.slot = SLOT_ALL;
        p.throughput = 0.5F;
        p.radius = radius * (random() % 2 == 0 ? 1.0F : 0.7F);
    }
    std::vector<Photon> photons(std::size_t{items} * capacity);
    std::vector<Vector> normals;
    for (Photon& photon : photons) {
        const VisiblePoint& p = points[random() % points.size()];
        photon = {};
        photon.x = near_point(p, 0);
        photon.y = near_point(p, 1);
        photon.z = near_point(p, 2);
        const std::size_t facing = random() % 6;
        photon.normal = packed_axes[facing];
        normals.push_back(axis(facing));
        photon.flux_x = static_cast<float>(uniform(0.0, 1.0));
        photon.flux_y = static_cast<float>(uniform(0.0, 1.0));
        photon.flux_z = static_cast<float>(uniform(0.0, 1.0));
        photon.slot = SLOT_ALL;
    }
    const Device& d = setting.device;
    PhotonSorter sorter(d, gather_macros(), {setting.fast_math, {}}, radix_bits);
    sorter.allocate(d, items, capacity);
    const auto enqueue = [&d](const ::cl::Kernel& kernel, std::size_t work_items, std::size_t size) {
        d.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(work_items), ::cl::NDRange(size));
    };
    sorter.count(d, Buffer<std::uint32_t>(d, "selftest counts", std::vector<std::uint32_t>(items, capacity)), enqueue);
    const Buffer<Photon> photon_buffer(d, "selftest photons", photons);
    sorter.sort(Buffer<SceneConstants>(d, "selftest constants", std::vector{constants}), photon_buffer,
                Buffer<std::uint32_t>(d, "selftest radius", std::vector{std::bit_cast<std::uint32_t>(radius)}),
                enqueue);
    const std::vector<cl_float4> results =
        gatherer.run(constants, points, photon_buffer, sorter.pairs(), sorter.bucket_begin(), radius, paths);
    for (std::size_t i = 0; i < points.size(); ++i) {
        // Distances are differences of coordinates, exact but for their squares' roundings; which cells a sphere
        // covers depends on point ± radius, which round as the coordinates do.
        const double margin = 4.0 * 0x1p-24 * points[i].radius + 0x1p-24 * extent;
        const Found all = gather_from_all(points[i], axis(axes[i]), photons, normals, paths, margin);
        double error = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double low = all.flux[c];
            const double high = all.flux[c] + all.doubtful[c];
            const double value = results[i].s[c];
            error = std::max(error, (std::max(0.0, value - high) + std::max(0.0, low - value)) / std::max(high, 1e-30));
        }
        const double count = results[i].s[3];
        if (count < all.count || count > all.count + all.doubtful_count)
            error = std::numeric_limits<double>::infinity();
        found.add(place.share, error, [&] { return describe(place); });
    }
}

/// n photons of the same flux in one search. All pairs name one photon, which lies with the points in the cell at the
/// origin, whose bucket is 0.
std::vector<cl_float4> gather_alike(const Gatherer& gatherer, std::uint32_t n, float flux) {
    const Device& d = gatherer.setting.device;
    constexpr float radius = 0.1F;
    VisiblePoint point{};
    point.x = point.y = point.z = radius * 1.0001F;
    point.normal = packed_axes[4];
    point.slot = SLOT_ALL;
    point.throughput = 1.0F;
    point.radius = 0.99F * radius;
    Photon photon{};
    photon.x = photon.y = photon.z = radius;
    photon.normal = packed_axes[4];
    photon.flux_x = flux;
    photon.flux_y = 3.0F * flux;
    photon.flux_z = 0.7F * flux;
    photon.slot = SLOT_ALL;
    std::vector<std::uint32_t> begin((std::size_t{1} << static_cast<unsigned>(2 * radix_bits)) + 1, n);
    begin[0] = 0;
    const Buffer<cl_uint2> pairs(d, "selftest pairs", n);
    pairs.fill(d, {{0U, 0U}});
    return gatherer.run({}, std::vector<VisiblePoint>(group, point),
                        Buffer<Photon>(d, "selftest photon", std::vector{photon}), pairs,
                        Buffer<std::uint32_t>(d, "selftest buckets", begin), radius, 1);
}

} // namespace

Macros gather_macros() {
    return {{"RADIX_BITS", std::to_string(radix_bits)}};
}

::cl::Program build_gather(const Setting& setting) {
    return build_program(setting.device, "gather.cl", gather_macros(), {setting.fast_math, {}});
}

Measurement gather_everywhere(const Setting& setting, const ::cl::Program& program) {
    const Gatherer gatherer{setting, program};
    Measurement found;
    std::vector<Place> places;
    for (const double share : {0x1p-30, 0x1p-19, 1e-5, 1e-3, 0.1, 1.0})
        places.push_back({1.0, 0.0, share});
    for (const double size : {1e-12, 1e-6, 1e6, 1e12})
        places.push_back({size, 0.0, 1e-3});
    for (const double away : {1.0, -1e3, 1e5})
        places.push_back({1.0, away, 1e-5});
    places.resize(inputs(setting, places.size(), 3));
    for (const Place& place : places)
        gather_at(gatherer, place, found);
    return found;
}

Measurement many_photons(const Setting& setting, const ::cl::Program& program) {
    const Gatherer gatherer{setting, program};
    Measurement found;
    const auto most = static_cast<std::uint32_t>(inputs(setting, 1U << 15U, 4096));
    for (std::uint32_t n = 1; n <= most; n = n * 3 / 2 + 1) {
        const cl_float4 sum = gather_alike(gatherer, n, 0.1F)[0];
        const double error = std::abs(sum.s[0] / (n * double{0.1F}) - 1.0);
        const double of_count = std::abs(sum.s[3] - static_cast<double>(n));
        found.add(n, of_count > 0.0 ? of_count : error, [&] { return fmt::format("{} photons", n); });
    }
    return found;
}

/// Photons of hardly any flux, and of as much as a float holds.
Measurement faint_photons(const Setting& setting, const ::cl::Program& program) {
    const Gatherer gatherer{setting, program};
    Measurement found;
    for (int exponent = -149; exponent <= 118; exponent += 3) {
        const float flux = std::ldexp(1.1F, exponent);
        const cl_float4 sum = gather_alike(gatherer, 100, flux)[0];
        // Devices may flush what is no normal float to zero: each photon's flux, and the sum.
        const double smallest = 100.0 * std::numeric_limits<float>::min();
        const double error = std::abs(sum.s[0] - 100.0 * flux) / std::max(100.0 * double{flux}, smallest);
        const double all = sum.s[3] == 100.0F ? 0.0 : std::numeric_limits<double>::infinity();
        found.add(flux, all + (exponent < -126 ? std::max(0.0, error - 1.0) : error),
                  [&] { return fmt::format("photons of flux 2^{}", exponent); });
    }
    return found;
}

} // namespace tristim::selftest::photon
