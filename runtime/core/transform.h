// Rigid and affine transforms of the rig, in double precision on the host; column vectors, metres, radians.
#pragma once

#include <array>

namespace bodyopt {

using Vec3 = std::array<double, 3>;
using Quat = std::array<double, 4>;  // x, y, z, w; unit length

// Translation, rotation, scale, applied scale first: the local transform of a joint relative to its parent.
struct JointTransform {
  Vec3 translation{0, 0, 0};
  Quat rotation{0, 0, 0, 1};
  Vec3 scale{1, 1, 1};
};

// The upper three rows of a 4 x 4 affine matrix, row-major.
struct Affine {
  double m[3][4]{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
};

[[nodiscard]] bool is_finite(const JointTransform& t);  // false, too, where what is finite would not stay so in a sum
Affine affine_from(const JointTransform& t);
Affine operator*(const Affine& a, const Affine& b);
Vec3 operator*(const Affine& a, const Vec3& point);
// Throws Error(mismatch) when the linear part is singular.
[[nodiscard]] Affine inverse(const Affine& a);

// Splits an affine into translation, rotation and scale. Shear is dropped: the rotation is the polar factor (the
// rotation nearest to the linear part), the scale its diagonal stretch. A reflection goes to the scale's sign.
[[nodiscard]] JointTransform decompose(const Affine& a);

Quat operator*(const Quat& a, const Quat& b);
[[nodiscard]] Quat conjugate(const Quat& q);
[[nodiscard]] bool has_length(const Quat& q);  // false for a zero or non-finite quaternion
[[nodiscard]] Quat normalized(const Quat& q);  // identity where it has none
Quat axis_angle(const Vec3& axis, double angle);
[[nodiscard]] Quat slerp(Quat a, Quat b, double t);
// The shorter turn from one to the other: 0 to pi.
[[nodiscard]] double angle_between(const Quat& a, const Quat& b);
[[nodiscard]] Vec3 rotate(const Quat& q, const Vec3& v);
std::array<std::array<double, 3>, 3> rotation_matrix(const Quat& q);

Vec3 operator+(const Vec3& a, const Vec3& b);
Vec3 operator-(const Vec3& a, const Vec3& b);
Vec3 operator*(double s, const Vec3& a);
double dot(const Vec3& a, const Vec3& b);
[[nodiscard]] Vec3 cross(const Vec3& a, const Vec3& b);
double length(const Vec3& a);

}  // namespace bodyopt
