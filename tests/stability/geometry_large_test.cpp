// A million tiny triangles beside a huge one.
#include "image_statistics.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <optional>

namespace tristim::test {
namespace {

constexpr double huge = 1e4;

/// A ball of radius 1 in 1.3 million triangles over a tilted triangle ten thousand times as large: ratios of 10⁷.
struct BallOverPlain {
    Scene scene;
    V3d plain_normal = V3d(-0.1, 0.05, 1.0).normalized();
    V3d centre{0.0, 0.0, 1.5};

    BallOverPlain() {
        scene.path = "ball over a plain";
        scene.camera = look_at({3.0, -5.0, 3.5}, {0.3, 0.2, 0.8}, {0, 0, 1}, 40.0);
        const int grey = add_diffuse(scene, Spectrum::constant(0.5));
        add_sphere(scene, 1.0, 8, false, grey, centre);
        const V3d along = plain_normal.cross(V3d(0.3, 1.0, 0.0)).normalized();
        const V3d across = plain_normal.cross(along);
        Shape plain;
        plain.mesh.positions = {-huge * along - huge * across, huge * along - huge * across, huge * across};
        plain.mesh.triangles = {{0U, 1U, 2U}};
        plain.material = grey;
        scene.shapes.push_back(plain);
        Light sun;
        sun.kind = Light::Kind::Distant;
        sun.emission = Spectrum::constant(1.0);
        sun.direction = {0.0, 0.0, -1.0};
        scene.lights = {sun};
    }

    /// Cosine of the sun's angle where a ray meets the ball or the plain; none in a shadow or at the ball's limb.
    std::optional<double> lit_cosine(const CameraRay& ray) const {
        const V3d o = ray.origin - centre;
        const double b = o.dot(ray.direction);
        const double squared = b * b - o.length2() + 1.0;
        if (squared > 0.0) {
            const double z = (o - (b + std::sqrt(squared)) * ray.direction).z;
            if (squared < 0.01 || z < 0.05)
                return std::nullopt;
            return z;
        }
        if (squared > -0.1)
            return std::nullopt;
        const V3d p = ray.origin - ray.origin.dot(plain_normal) / ray.direction.dot(plain_normal) * ray.direction;
        if (ray.direction.dot(plain_normal) > -0.05 || std::hypot(p.x, p.y) < 1.1)
            return std::nullopt;
        return plain_normal.z;
    }
};

TEST(GeometryStability, AMillionTinyTrianglesBesideAHugeOne) {
    constexpr int width = 48, height = 48;
    const BallOverPlain ball;
    const TestImage image = render_image(ball.scene, small_render("tristimulus:1", width, height, 64, 0.001, 2), 16);
    const double white = integrate_xyz(Spectrum::constant(1.0), [](double) { return 1.0; })[1];
    int compared = 0;
    for (int pixel = 0; pixel < width * height; ++pixel) {
        bool lit = true;
        const double cosine =
            pixel_mean(ball.scene.camera, width, height, pixel % width, pixel / width, [&](const CameraRay& ray) {
                const std::optional<double> one = ball.lit_cosine(ray);
                lit &= one.has_value();
                return one.value_or(0.0);
            });
        if (!lit)
            continue;
        ++compared;
        // So few photons fall on so large a plain that what the two reflect onto each other is not seen. 16 points of a
        // pixel whose cosine changes by some hundredths, and facets 1/300 wide, are off by less than a hundredth.
        const double y = image.xyz[static_cast<std::size_t>(pixel)][1] / white * std::numbers::pi / 0.5;
        ASSERT_NEAR(y, cosine, 0.01) << "pixel (" << pixel % width << ", " << pixel / width << ")";
    }
    EXPECT_GT(compared, width * height / 2);
}

} // namespace
} // namespace tristim::test
