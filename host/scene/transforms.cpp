#include "scene/transforms.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tristim {

namespace {

V3d row(const M44d& m, int i) {
    return {m[i][0], m[i][1], m[i][2]};
}

double determinant(const M44d& m) {
    return row(m, 0).dot(row(m, 1).cross(row(m, 2)));
}

} // namespace

M44d translation(const V3d& offset) {
    return M44d().setTranslation(offset);
}

M44d scaling(const V3d& factors) {
    return M44d().setScale(factors);
}

M44d rotation(double degrees, const V3d& axis) {
    return M44d().setAxisAngle(axis, degrees * std::numbers::pi / 180.0);
}

M44d look_at(const V3d& eye, const V3d& target, const V3d& up) {
    const V3d forward = (target - eye).normalized();
    const V3d right = up.normalized().cross(forward).normalized();
    if (forward.length2() == 0.0)
        fail("the eye and the target of \"LookAt\" are the same point");
    if (right.length2() == 0.0)
        fail("the up vector of \"LookAt\" is parallel to the viewing direction");
    const V3d above = forward.cross(right);
    const M44d world_from_camera(right.x, right.y, right.z, 0, above.x, above.y, above.z, 0, forward.x, forward.y,
                                 forward.z, 0, eye.x, eye.y, eye.z, 1);
    return world_from_camera.inverse();
}

M44d matrix_from_list(const std::array<double, 16>& values) {
    M44d matrix;
    for (int i = 0; i < 16; ++i)
        matrix[i / 4][i % 4] = values[static_cast<std::size_t>(i)];
    return matrix;
}

M44d inverse_transform(const M44d& matrix) {
    const double det = determinant(matrix);
    if (det == 0.0 || !std::isfinite(det))
        fail("the current transformation cannot be inverted");
    const M44d inverse = matrix.inverse();
    // Imath's answer where the inverse overflows, or where the fourth column makes the matrix singular.
    if (inverse == M44d() && matrix != M44d())
        fail("the current transformation cannot be inverted");
    return inverse;
}

bool is_finite_float(const V3d& v) {
    const Imath::V3f single(v);
    return std::isfinite(single.x) && std::isfinite(single.y) && std::isfinite(single.z);
}

bool is_finite_float(const M44d& matrix) {
    const double* const entries = matrix.getValue();
    return std::all_of(entries, entries + 16, [](double entry) { return std::isfinite(static_cast<float>(entry)); });
}

V3d transform_point(const M44d& matrix, const V3d& point) {
    return point * matrix;
}

V3d transform_vector(const M44d& matrix, const V3d& vector) {
    V3d result;
    matrix.multDirMatrix(vector, result);
    return result;
}

M44d normal_matrix(const M44d& matrix) {
    return inverse_transform(matrix).transposed();
}

bool swaps_handedness(const M44d& matrix) {
    return determinant(matrix) < 0.0;
}

bool keeps_angles(const M44d& matrix) {
    // Rotations in double precision are orthogonal to about 1e-16 per factor; 1e-9 leaves room for long chains and for
    // matrices that were printed with ten digits.
    constexpr double tolerance = 1e-9;
    const double scale2 = row(matrix, 0).length2();
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j <= i; ++j) {
            const double expected = i == j ? scale2 : 0.0;
            if (std::abs(row(matrix, i).dot(row(matrix, j)) - expected) > tolerance * scale2)
                return false;
        }
    }
    return true;
}

} // namespace tristim
