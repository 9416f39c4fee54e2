#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <array>

namespace tristim {

using Imath::M44d;
using Imath::V3d;

/// pbrt's transform directives as Imath matrices. pbrt multiplies column vectors (M·v), Imath row vectors (v·M): every
/// matrix here is the transpose of pbrt's, and "CTM = CTM · T" of pbrt reads `ctm = t * ctm` here.

M44d translation(const V3d& offset);
M44d scaling(const V3d& factors);

/// Right-handed rotation by an angle in degrees about an axis, which must not be zero.
M44d rotation(double degrees, const V3d& axis);

/// World to camera space for a camera at `eye` that looks at `target`: x right, y up, z forward (pbrt's left-handed
/// camera space). Throws Error if eye and target coincide or `up` is parallel to the view.
M44d look_at(const V3d& eye, const V3d& target, const V3d& up);

/// The 16 numbers of "Transform" and "ConcatTransform". pbrt lists them by column, which is Imath's order by row.
M44d matrix_from_list(const std::array<double, 16>& values);

/// Throws Error if the matrix is singular or not finite.
M44d inverse_transform(const M44d& matrix);

/// Whether all entries are finite in single precision.
bool is_finite_float(const M44d& matrix);

/// Whether all coordinates are finite in single precision.
bool is_finite_float(const V3d& v);

V3d transform_point(const M44d& matrix, const V3d& point);
V3d transform_vector(const M44d& matrix, const V3d& vector);

/// The matrix by whose linear part normals transform: the inverse transpose.
M44d normal_matrix(const M44d& matrix);

/// True if the transform mirrors, so that a right-handed frame becomes left-handed.
bool swaps_handedness(const M44d& matrix);

/// True if the linear part keeps angles: a rotation, perhaps mirrored, times one scale factor.
bool keeps_angles(const M44d& matrix);

} // namespace tristim
