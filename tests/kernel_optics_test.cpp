// Fresnel's equations and Snell's law of kernels/optics.h against complex arithmetic in double.

#include "kernel_harness.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

namespace tristim {
namespace {

using namespace kernel_test;
using std::numbers::pi;

const char* const optics_source = R"(
#include "optics.h"
// (cosine, 1/eta) to (reflectance, cosine beyond).
kernel void dielectric(const global float2* inputs, global float2* out) {
    const size_t i = get_global_id(0);
    float cos_t;
    const float reflectance = fresnel_dielectric(inputs[i].x, inputs[i].y, &cos_t);
    out[i] = (float2)(reflectance, cos_t);
}
// (cosine, eta, k) to (by the scalar function, by the first and the last lane of the vector one).
kernel void conductor(const global float4* inputs, global float4* out) {
    const size_t i = get_global_id(0);
    const float4 input = inputs[i];
    const float scalar = fresnel_conductor(input.x, input.y, input.z);
    const float4 first = fresnel_conductor_lanes(input.x, (float4)(input.y, 1.5f, 2.0f, 3.0f), (float4)(input.z, 0.0f, 1.0f, 2.0f));
    const float4 last = fresnel_conductor_lanes(input.x, (float4)(0.2f, 0.0f, 2.0f, input.y), (float4)(3.0f, 0.0f, 1.0f, input.z));
    out[i] = (float4)(scalar, first.x, last.w, 0.0f);
}
// Each ray twice: direction and 1/eta, normal.
kernel void bend(const global float4* rays, global float4* reflected, global float4* refracted) {
    const size_t i = get_global_id(0);
    const float3 direction = rays[2 * i].xyz, n = rays[2 * i + 1].xyz;
    const float inverse_eta = rays[2 * i].w;
    const float cos_i = min(-dot(direction, n), 1.0f);
    float cos_t;
    const float reflectance = fresnel_dielectric(cos_i, inverse_eta, &cos_t);
    reflected[i] = (float4)(reflect(direction, n, cos_i), reflectance);
    refracted[i] = (float4)(refract(direction, n, inverse_eta, cos_i, cos_t), cos_t);
}
)";

/// Reflectance for unpolarised light of an interface to the complex index n = eta + ik; Fresnel's equations with
/// q = n cos θ_t = √(n² - sin² θ_i), the root that decays.
double reflectance(double cos_i, double eta, double k) {
    const std::complex<double> n2 = std::complex<double>(eta, k) * std::complex<double>(eta, k);
    std::complex<double> q = std::sqrt(n2 - (1.0 - cos_i) * (1.0 + cos_i));
    if (q.imag() < 0.0)
        q = -q;
    const double s = std::norm((cos_i - q) / (cos_i + q));
    const double p = std::norm((n2 * cos_i - q) / (n2 * cos_i + q));
    return 0.5 * (s + p);
}

/// How far the reflectance may move if eta, k and cos θ change by some units of roundoff. Float arithmetic gives the
/// exact answer to a question that differs so little, and then rounds: the only meaningful bound near a critical angle,
/// where the slope is infinite.
double sensitivity(double cos_i, double eta, double k, double units) {
    const double exact = reflectance(cos_i, eta, k);
    double largest = 0.0;
    for (const double de : {-1.0, 1.0})
        for (const double dk : {-1.0, 1.0})
            for (const double dc : {-1.0, 0.0, 1.0}) {
                const auto moved = [&](double value, double direction) {
                    return value * (1.0 + direction * units * unit_roundoff);
                };
                const double other = reflectance(std::min(moved(cos_i, dc), 1.0), moved(eta, de), moved(k, dk));
                largest = std::max(largest, std::abs(other - exact));
            }
    return largest;
}

/// 0 to 89.999°, closer towards grazing, and around an angle of interest.
std::vector<float> cosines(double around) {
    std::vector<float> list;
    for (int i = 0; i <= 89; ++i)
        list.push_back(static_cast<float>(std::cos(i * pi / 180.0)));
    for (const double degrees : {89.5, 89.9, 89.99, 89.999})
        list.push_back(static_cast<float>(std::cos(degrees * pi / 180.0)));
    if (around >= 0.0 && around <= 1.0) {
        for (const double step : {0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2})
            for (const double sign : {-1.0, 1.0})
                list.push_back(static_cast<float>(std::clamp(around + sign * step, 1e-6, 1.0)));
    }
    return list;
}

const std::vector<float> etas{0.1F,   0.2F, 0.4F,  0.5F, 0.6F,  2.0F / 3.0F, 0.75F, 0.9F, 0.99F, 0.999F, 1.0F,
                              1.001F, 1.1F, 1.33F, 1.5F, 1.62F, 1.8F,        2.4F,  3.5F, 5.0F,  7.0F,   10.0F};

TEST(KernelOptics, DielectricReflectance) {
    std::vector<cl_float2> inputs;
    for (const float eta : etas) {
        const double critical = eta < 1.0F ? std::sqrt(1.0 - double{eta} * eta) : -1.0;
        for (const float cosine : cosines(critical))
            inputs.push_back({{cosine, 1.0F / eta}});
    }
    const Buffer<cl_float2> output = make_buffer<cl_float2>(inputs.size());
    run(build_test_program(optics_source), "dielectric", inputs.size(), upload(inputs), output);
    const std::vector<cl_float2> results = output.read(test_device());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const double cosine = inputs[i].s[0], eta = 1.0 / inputs[i].s[1];
        const std::string at = fmt::format("cos θ = {}, eta = {}", cosine, eta);
        // cos² θ_t: c² is off by a rounding, (1 - x²) sin² by 7, as if eta differed by 3.5 units; where that does not
        // cancel c², and for the sum and the root, cos θ_t is off by 10 more. So b by 11, the sum of cosines and sines
        // by 12 and their difference by as much of the sum; the ratio by 44; its square and the squares of sum and
        // difference by 89 and 51, and 5 for the products.
        const double exact = reflectance(cosine, eta, 0.0);
        const double tolerance = 145.0 * unit_roundoff * exact + sensitivity(cosine, eta, 0.0, 4.0);
        ASSERT_NEAR(results[i].s[0], exact, tolerance) << at;
        ASSERT_GE(results[i].s[0], 0.0F) << at;
        ASSERT_LE(results[i].s[0], 1.0F + 4.0 * unit_roundoff) << at;
        const double sin2 = (1.0 - cosine) * (1.0 + cosine);
        const double cos2_t = 1.0 - sin2 / (eta * eta);
        const double error = unit_roundoff * (cosine * cosine + 7.0 * std::abs(1.0 - 1.0 / (eta * eta)) * sin2);
        const double cos_t = std::sqrt(std::max(cos2_t, 0.0));
        ASSERT_LE(results[i].s[1], std::sqrt(std::max(cos2_t + error, 0.0)) + 8.0 * unit_roundoff) << at;
        ASSERT_GE(results[i].s[1], std::sqrt(std::max(cos2_t - error, 0.0)) - 8.0 * unit_roundoff) << at;
        if (cos2_t < -error) {
            ASSERT_EQ(results[i].s[0], 1.0F) << "total reflection at " << at;
            ASSERT_EQ(results[i].s[1], 0.0F) << "total reflection at " << at;
        } else if (eta > 1.0) {
            ASSERT_NEAR(results[i].s[1], cos_t, 16.0 * unit_roundoff / cos_t) << at;
        }
    }
}

/// F(eta, θ_i) = F(1/eta, θ_t): both directions through the interface.
TEST(KernelOptics, DielectricReflectanceIsReciprocal) {
    std::vector<cl_float2> there, back;
    for (const float eta : etas) {
        for (int degrees = 0; degrees < 90; ++degrees) {
            const double cosine = static_cast<float>(std::cos(degrees * pi / 180.0));
            const double cos2_t = 1.0 - (1.0 - cosine) * (1.0 + cosine) / (double{eta} * eta);
            if (cos2_t <= 0.0)
                continue;
            there.push_back({{static_cast<float>(cosine), 1.0F / eta}});
            back.push_back({{static_cast<float>(std::sqrt(cos2_t)), eta}});
        }
    }
    const ::cl::Program program = build_test_program(optics_source);
    const Buffer<cl_float2> first = make_buffer<cl_float2>(there.size()), second = make_buffer<cl_float2>(there.size());
    run(program, "dielectric", there.size(), upload(there), first);
    run(program, "dielectric", there.size(), upload(back), second);
    const std::vector<cl_float2> f = first.read(test_device()), g = second.read(test_device());
    for (std::size_t i = 0; i < there.size(); ++i) {
        // Each within its bound of the exact value; the way back also has the rounding of its two inputs, one unit
        // each.
        const double cosine = there[i].s[0], eta = 1.0 / there[i].s[1];
        const double tolerance = 290.0 * unit_roundoff * reflectance(cosine, eta, 0.0) +
                                 sensitivity(cosine, eta, 0.0, 5.0) +
                                 sensitivity(back[i].s[0], 1.0 / back[i].s[1], 0.0, 5.0);
        ASSERT_NEAR(f[i].s[0], g[i].s[0], tolerance) << "cos θ = " << cosine << ", eta = " << eta;
    }
}

TEST(KernelOptics, ConductorReflectance) {
    std::vector<cl_float4> inputs;
    for (const float eta : {0.1F, 0.2F, 0.5F, 1.0F, 1.5F, 3.0F, 6.0F, 10.0F})
        for (const float k : {0.0F, 0.01F, 0.1F, 0.5F, 1.0F, 2.0F, 3.0F, 5.0F, 7.0F, 10.0F})
            for (const float cosine : cosines(eta < 1.0F ? std::sqrt(1.0 - double{eta} * eta) : -1.0))
                inputs.push_back({{cosine, eta, k, 0.0F}});
    const Buffer<cl_float4> output = make_buffer<cl_float4>(inputs.size());
    run(build_test_program(optics_source, {{"LANES", "4"}}), "conductor", inputs.size(), upload(inputs), output);
    const std::vector<cl_float4> results = output.read(test_device());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const double cosine = inputs[i].s[0], eta = inputs[i].s[1], k = inputs[i].s[2];
        // q²: as if each input differed by up to 4 units, or by 10 of its size where nothing cancels. Then |q²| is off
        // by 8, Re(q) by 17, and each quotient, whose numerator is a difference of what its denominator adds, by 47
        // and 53 of its denominator; half their product by 77.
        const double tolerance = 77.0 * unit_roundoff + sensitivity(cosine, eta, k, 8.0);
        for (std::size_t form = 0; form < 3; ++form) {
            ASSERT_NEAR(results[i].s[form], reflectance(cosine, eta, k), tolerance)
                << "cos θ = " << cosine << ", eta = " << eta << ", k = " << k
                << (form == 0   ? ", scalar"
                    : form == 1 ? ", first lane"
                                : ", last lane");
        }
    }
}

TEST(KernelOptics, RaysFollowSnellsLaw) {
    Random random(30);
    std::vector<cl_float4> rays;
    for (int i = 0; i < 50000; ++i) {
        const Vec3 n = random.direction();
        Vec3 direction = random.direction();
        if (dot(direction, n) > 0.0)
            direction = -1.0 * direction;
        const float eta = etas[random.bits() % etas.size()];
        rays.push_back({{static_cast<float>(direction[0]), static_cast<float>(direction[1]),
                         static_cast<float>(direction[2]), 1.0F / eta}});
        rays.push_back({{static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2]), 0.0F}});
    }
    const std::size_t count = rays.size() / 2;
    const Buffer<cl_float4> reflected = make_buffer<cl_float4>(count), refracted = make_buffer<cl_float4>(count);
    run(build_test_program(optics_source), "bend", count, upload(rays), reflected, refracted);
    const std::vector<cl_float4> mirror = reflected.read(test_device()), bent = refracted.read(test_device());
    std::size_t transmitted = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 d = vec3(rays[2 * i]), n = vec3(rays[2 * i + 1]);
        const double eta = 1.0 / rays[2 * i].s[3];
        const double cos_i = -dot(d, n);
        const Vec3 along = d + cos_i * n; // sin θ_i long
        const std::string at = fmt::format("cos θ = {}, eta = {}", cos_i, eta);
        ASSERT_LT(length(vec3(mirror[i]) - (along + cos_i * n)), 12.0 * unit_roundoff) << at;
        // cos θ_i is a float dot product, off by up to 4 units; then as in DielectricReflectance. The sine here is that
        // of a d whose square is off by 2 units of 1.
        const double x2 = 1.0 / (eta * eta);
        const double cos2_t = 1.0 - dot(along, along) * x2;
        const double error = ((8.0 * cos_i + 2.0) * x2 + 7.0 * std::abs(1.0 - x2) * dot(along, along) + cos_i * cos_i +
                              std::max(cos2_t, 0.0)) *
                             unit_roundoff;
        if (cos2_t < error) {
            if (cos2_t < -error) {
                ASSERT_EQ(mirror[i].s[3], 1.0F) << at;
            }
            continue;
        }
        ++transmitted;
        const double cos_t = std::sqrt(cos2_t);
        const Vec3 expected = (1.0 / eta) * along - cos_t * n;
        // The error of cos_t, then sums of vectors of length 1/eta and 1; the rounded d and n are not exactly unit.
        const double tolerance = cos_t - std::sqrt(cos2_t - error) + 16.0 * unit_roundoff * (1.0 + 1.0 / eta);
        ASSERT_LT(length(vec3(bent[i]) - expected), tolerance) << at;
        // What the incoming direction's length is off by grows by 1/eta², as its sine is magnified.
        ASSERT_NEAR(length(vec3(bent[i])), 1.0, 8.0 * unit_roundoff * (1.0 + 1.0 / (eta * eta))) << at;
    }
    EXPECT_GT(transmitted, count / 3);
}

} // namespace
} // namespace tristim
