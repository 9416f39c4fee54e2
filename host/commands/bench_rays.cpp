#include "commands/bench_rays.h"

#include "base/error.h"
#include "base/median.h"
#include "bvh/bench_meshes.h"
#include "bvh/embree_tracer.h"
#include "bvh/ray_tracer.h"
#include "commands/device_options.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

namespace tristim {
namespace {

struct BenchRaysOptions {
    bool json = false;
    std::string device;
    std::string tuning;
    int repeats = 9;
    int rays = 262144;
};

/// Two hits of one ray count as different if the triangle differs and the distance by more than this, relative to the
/// larger of distance and the room's half-width: rays that graze a surface turn rounding (6e-8) into a few 1e-5.
constexpr float distance_tolerance = 1e-4f;

enum class Query { Closest, Any };

struct RaySet {
    std::string name;
    Query query = Query::Closest;
    std::vector<Ray> rays;
};

struct RayResult {
    std::string mesh;
    std::size_t triangles = 0;
    std::string rays;
    double tristim_mrays = 0.0;
    double embree_mrays = 0.0;
    double embree_robust_mrays = 0.0;
    double ratio = 0.0;
    double ratio_robust = 0.0;
    std::size_t mismatches = 0;
};

Ray make_ray(const V3f& origin, const V3f& direction, float t_max) {
    return {origin.x, origin.y, origin.z, t_max, direction.x, direction.y, direction.z, 0.0f};
}

class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    float operator()() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }

  private:
    std::mt19937 engine_;
};

/// A direction about `normal`, its density proportional to the cosine.
V3f cosine_direction(const V3f& normal, Random& random) {
    const float radius = std::sqrt(random());
    const float phi = 2.0f * std::numbers::pi_v<float> * random();
    const V3f tangent = (std::abs(normal.x) > 0.5f ? normal % V3f(0, 1, 0) : normal % V3f(1, 0, 0)).normalized();
    const float height = std::sqrt(std::max(0.0f, 1.0f - radius * radius));
    return radius * std::cos(phi) * tangent + radius * std::sin(phi) * (normal % tangent) + height * normal;
}

/// Pinhole camera at one wall, off the middle lest pixels fall exactly into the corners of the room; pixels row by row.
RaySet primary_rays(int count) {
    RaySet set{"primary", Query::Closest, {}};
    const int width = static_cast<int>(std::ceil(std::sqrt(count)));
    for (int i = 0; i < count; ++i) {
        const float x = (static_cast<float>(i % width) + 0.5f) / static_cast<float>(width) - 0.5f;
        const float y = (static_cast<float>(i / width) + 0.5f) / static_cast<float>(width) - 0.5f;
        set.rays.push_back(make_ray(V3f(0.03f, 0.02f, -0.99f), V3f(1.2f * x, -1.2f * y, 1.0f).normalized(),
                                    std::numeric_limits<float>::infinity()));
    }
    return set;
}

struct SurfacePoint {
    V3f position;
    V3f normal; ///< towards the side that the ray came from
};

/// Where rays hit, moved off the surface.
std::vector<SurfacePoint> surface_points(const TriangleSoup& triangles, const RaySet& set,
                                         const std::vector<RayHit>& hits) {
    constexpr float lift = 1e-4f;
    std::vector<SurfacePoint> points;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (hits[i].triangle < 0)
            continue;
        const auto triangle = static_cast<std::size_t>(hits[i].triangle);
        const V3f& v0 = triangles.v0[triangle];
        const V3f edge1 = triangles.v1[triangle] - v0;
        const V3f edge2 = triangles.v2[triangle] - v0;
        V3f normal = (edge1 % edge2).normalized();
        const Ray& ray = set.rays[i];
        if ((normal ^ V3f(ray.direction_x, ray.direction_y, ray.direction_z)) > 0.0f)
            normal = -normal;
        points.push_back({v0 + hits[i].u * edge1 + hits[i].v * edge2 + lift * normal, normal});
    }
    return points;
}

V3f point_on_ceiling_light(Random& random) {
    return {0.5f * random() - 0.25f, 0.98f, 0.5f * random() - 0.25f};
}

RaySet diffuse_rays(const std::vector<SurfacePoint>& points) {
    RaySet set{"diffuse", Query::Closest, {}};
    Random random(1);
    for (const SurfacePoint& point : points)
        set.rays.push_back(
            make_ray(point.position, cosine_direction(point.normal, random), std::numeric_limits<float>::infinity()));
    return set;
}

RaySet photon_rays(int count) {
    RaySet set{"photon", Query::Closest, {}};
    Random random(2);
    for (int i = 0; i < count; ++i)
        set.rays.push_back(make_ray(point_on_ceiling_light(random), cosine_direction(V3f(0.0f, -1.0f, 0.0f), random),
                                    std::numeric_limits<float>::infinity()));
    return set;
}

RaySet shadow_rays(const std::vector<SurfacePoint>& points) {
    RaySet set{"shadow", Query::Any, {}};
    Random random(3);
    for (const SurfacePoint& point : points) {
        const V3f to_light = point_on_ceiling_light(random) - point.position;
        const float distance = to_light.length();
        set.rays.push_back(make_ray(point.position, to_light / distance, distance));
    }
    return set;
}

double seconds(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::size_t count_mismatches(const std::vector<RayHit>& ours, const std::vector<RayHit>& theirs) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        const bool near = std::abs(ours[i].t - theirs[i].t) <= distance_tolerance * std::max(1.0f, theirs[i].t);
        count += ours[i].triangle != theirs[i].triangle && !near ? 1 : 0;
    }
    return count;
}

std::size_t count_mismatches(const std::vector<std::int32_t>& ours, const std::vector<std::int32_t>& theirs) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < ours.size(); ++i)
        count += ours[i] != theirs[i] ? 1 : 0;
    return count;
}

/// The three tracers of one mesh.
struct Contest {
    RayTracer tristim;
    EmbreeTracer embree;
    EmbreeTracer robust;
    unsigned threads;

    Contest(const Device& device, const TriangleSoup& triangles)
        : tristim(device, build_bvh(triangles, device.tuning.bvh_width)), embree(triangles, false),
          robust(triangles, true), threads(device.info.compute_units) {}
};

/// Times the three in turn, `repeats` times after a warm-up, and compares our results with Embree's robust mode.
RayResult measure(Contest& contest, const BenchMesh& mesh, const RaySet& set, int repeats) {
    std::vector<RayHit> hits(set.rays.size());
    std::vector<std::int32_t> occluded(set.rays.size());
    const auto run_tristim = [&] {
        set.query == Query::Closest ? contest.tristim.run_closest() : contest.tristim.run_any();
    };
    const auto run_embree = [&](const EmbreeTracer& tracer) {
        set.query == Query::Closest ? tracer.trace_closest(set.rays, contest.threads, hits)
                                    : tracer.trace_any(set.rays, contest.threads, occluded);
    };
    contest.tristim.set_rays(set.rays);
    run_tristim();
    run_embree(contest.embree);
    run_embree(contest.robust);

    std::vector<double> tristim, embree, robust, ratio, ratio_robust;
    for (int i = 0; i < repeats; ++i) {
        tristim.push_back(seconds(run_tristim));
        embree.push_back(seconds([&] { run_embree(contest.embree); }));
        robust.push_back(seconds([&] { run_embree(contest.robust); }));
        ratio.push_back(embree.back() / tristim.back());
        ratio_robust.push_back(robust.back() / tristim.back());
    }
    const double million_rays = 1e-6 * static_cast<double>(set.rays.size());
    RayResult result;
    result.mesh = mesh.name;
    result.triangles = mesh.triangles.v0.size();
    result.rays = set.name;
    result.tristim_mrays = million_rays / median(tristim);
    result.embree_mrays = million_rays / median(embree);
    result.embree_robust_mrays = million_rays / median(robust);
    result.ratio = median(ratio);
    result.ratio_robust = median(ratio_robust);
    result.mismatches = set.query == Query::Closest ? count_mismatches(contest.tristim.hits(), hits)
                                                    : count_mismatches(contest.tristim.occluded(), occluded);
    return result;
}

std::vector<RayResult> measure_mesh(const Device& device, const BenchMesh& mesh, const BenchRaysOptions& options) {
    Contest contest(device, mesh.triangles);
    const RaySet primary = primary_rays(options.rays);
    const std::vector<SurfacePoint> points =
        surface_points(mesh.triangles, primary, contest.tristim.trace_closest(primary.rays));
    std::vector<RayResult> results;
    for (const RaySet& set : {primary, diffuse_rays(points), photon_rays(options.rays), shadow_rays(points)})
        results.push_back(measure(contest, mesh, set, options.repeats));
    return results;
}

double geometric_mean(const std::vector<RayResult>& results, double RayResult::*member) {
    double sum = 0.0;
    for (const RayResult& result : results)
        sum += std::log(result.*member);
    return std::exp(sum / static_cast<double>(results.size()));
}

void print_table(const std::vector<RayResult>& results, const BenchRaysOptions& options, const Device& device) {
    fmt::print("{} rays each on '{}', Embree on {} threads; Mrays/s, medians of {}\n\n", options.rays, device.info.name,
               device.info.compute_units, options.repeats);
    fmt::print("{:<12} {:>9} {:<8} {:>8} {:>8} {:>8} {:>7} {:>7} {:>10}\n", "mesh", "triangles", "rays", "tristim",
               "embree", "robust", "ratio", "/robust", "mismatches");
    for (const RayResult& r : results)
        fmt::print("{:<12} {:>9} {:<8} {:>8.2f} {:>8.2f} {:>8.2f} {:>7.2f} {:>7.2f} {:>10}\n", r.mesh, r.triangles,
                   r.rays, r.tristim_mrays, r.embree_mrays, r.embree_robust_mrays, r.ratio, r.ratio_robust,
                   r.mismatches);
    fmt::print("\ngeometric mean of ratios: {:.2f}, to Embree's robust mode {:.2f}\n",
               geometric_mean(results, &RayResult::ratio), geometric_mean(results, &RayResult::ratio_robust));
}

void print_json(const std::vector<RayResult>& results) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const RayResult& r : results)
        list.push_back({{"mesh", r.mesh},
                        {"triangles", r.triangles},
                        {"rays", r.rays},
                        {"tristim_mrays", r.tristim_mrays},
                        {"embree_mrays", r.embree_mrays},
                        {"embree_robust_mrays", r.embree_robust_mrays},
                        {"ratio", r.ratio},
                        {"ratio_robust", r.ratio_robust},
                        {"mismatches", r.mismatches}});
    fmt::print("{}\n", list.dump(2));
}

void bench_rays(const BenchRaysOptions& options) {
    const Device device = open_tuned_device(options.device, options.tuning);
    std::vector<RayResult> results;
    for (const BenchMesh& mesh : {boxes_in_room(), bumpy_spheres_in_room("spheres-100k", 100'000),
                                  bumpy_spheres_in_room("spheres-1m", 1'000'000)})
        for (const RayResult& result : measure_mesh(device, mesh, options))
            results.push_back(result);
    options.json ? print_json(results) : print_table(results, options, device);
}

} // namespace

void add_bench_rays_command(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("bench-rays", "Mrays/s of the traversal kernel beside Embree's rtcIntersect1/rtcOccluded1");
    const auto options = std::make_shared<BenchRaysOptions>();
    command->add_flag("--json", options->json, "print a JSON list instead of a table");
    add_device_option(*command, options->device);
    add_tuning_option(*command, options->tuning);
    command->add_option("--repeats", options->repeats, "timed runs of each tracer")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_option("--rays", options->rays, "rays of each kind")
        ->check(CLI::Range(1, 1 << 26))
        ->capture_default_str();
    command->callback([options] { bench_rays(*options); });
}

} // namespace tristim
