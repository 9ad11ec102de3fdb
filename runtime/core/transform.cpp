#include "runtime/core/transform.h"

#include <cmath>

#include "runtime/core/error.h"

namespace bodyopt {

bool is_finite(const JointTransform& t) {
  double sum = 0;
  for (const double x : t.translation) sum += std::abs(x);
  for (const double x : t.scale) sum += std::abs(x);
  for (const double x : t.rotation) sum += std::abs(x);
  return std::isfinite(sum);
}

Affine affine_from(const JointTransform& t) {
  const auto r = rotation_matrix(t.rotation);
  Affine a;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) a.m[i][j] = r[i][j] * t.scale[j];
    a.m[i][3] = t.translation[i];
  }
  return a;
}

Affine operator*(const Affine& a, const Affine& b) {
  Affine c;
  for (std::size_t i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      c.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
    }
    c.m[i][3] += a.m[i][3];
  }
  return c;
}

Vec3 operator*(const Affine& a, const Vec3& p) {
  Vec3 q;
  for (std::size_t i = 0; i < 3; ++i) q[i] = a.m[i][0] * p[0] + a.m[i][1] * p[1] + a.m[i][2] * p[2] + a.m[i][3];
  return q;
}

namespace {

using Mat3 = std::array<std::array<double, 3>, 3>;

Mat3 linear_part(const Affine& a) {
  Mat3 m;
  for (std::size_t i = 0; i < 3; ++i) m[i] = {a.m[i][0], a.m[i][1], a.m[i][2]};
  return m;
}

double determinant(const Mat3& m) { return dot(m[0], cross(m[1], m[2])); }

// Inverse transpose times the determinant.
Mat3 cofactors(const Mat3& m) { return {cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])}; }

// Higham's scaled Newton iteration for the orthogonal polar factor of a matrix with positive determinant.
Mat3 polar_rotation(Mat3 m) {
  for (int iteration = 0; iteration < 60; ++iteration) {
    const Mat3 c = cofactors(m);
    const double d = determinant(m);
    double change = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        const double next = 0.5 * (m[i][j] + c[i][j] / d);
        change = std::max(change, std::abs(next - m[i][j]));
        m[i][j] = next;
      }
    }
    if (change < 1e-15) break;
  }
  return m;
}

Quat quaternion_from(const Mat3& r) {
  const double trace = r[0][0] + r[1][1] + r[2][2];
  if (trace > 0) {
    return normalized({r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1], 1 + trace});
  }
  const std::size_t i = r[0][0] > r[1][1] ? (r[0][0] > r[2][2] ? 0 : 2) : (r[1][1] > r[2][2] ? 1 : 2);
  const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
  Quat q;
  q[i] = 1 + r[i][i] - r[j][j] - r[k][k];
  q[j] = r[i][j] + r[j][i];
  q[k] = r[i][k] + r[k][i];
  q[3] = r[k][j] - r[j][k];
  return normalized(q);
}

double norm(const Quat& q) { return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]); }

}  // namespace

Affine inverse(const Affine& a) {
  const Mat3 m = linear_part(a);
  const double d = determinant(m);
  if (!std::isfinite(d) || std::abs(d) < 1e-30) {
    throw Error(ErrorKind::mismatch, "expected a transform that can be undone, found one of determinant ", d,
                ": is a joint scaled to nothing?");
  }
  const Mat3 c = cofactors(m);
  Affine b;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) b.m[i][j] = c[j][i] / d;
  }
  for (std::size_t i = 0; i < 3; ++i)
    b.m[i][3] = -(b.m[i][0] * a.m[0][3] + b.m[i][1] * a.m[1][3] + b.m[i][2] * a.m[2][3]);
  return b;
}

JointTransform decompose(const Affine& a) {
  JointTransform t;
  t.translation = {a.m[0][3], a.m[1][3], a.m[2][3]};
  Mat3 m = linear_part(a);
  const double d = determinant(m);
  const double sign = d < 0 ? -1 : 1;
  if (!std::isfinite(d) || std::abs(d) < 1e-30) {  // collapsed: no rotation to speak of
    t.scale = {0, 0, 0};
    return t;
  }
  for (auto& row : m) {
    for (double& x : row) x *= sign;
  }
  const Mat3 r = polar_rotation(m);
  for (std::size_t j = 0; j < 3; ++j) t.scale[j] = sign * (r[0][j] * m[0][j] + r[1][j] * m[1][j] + r[2][j] * m[2][j]);
  t.rotation = quaternion_from(r);
  return t;
}

Quat operator*(const Quat& a, const Quat& b) {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
          a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

Quat conjugate(const Quat& q) { return {-q[0], -q[1], -q[2], q[3]}; }

bool has_length(const Quat& q) {
  const double n = norm(q);
  return n > 1e-12 && std::isfinite(n);
}

Quat normalized(const Quat& q) {
  if (!has_length(q)) return {0, 0, 0, 1};
  const double n = norm(q);
  return {q[0] / n, q[1] / n, q[2] / n, q[3] / n};
}

Quat axis_angle(const Vec3& axis, double angle) {
  const double n = length(axis);
  if (!(n > 0)) return {0, 0, 0, 1};
  const double s = std::sin(angle / 2) / n;
  return {s * axis[0], s * axis[1], s * axis[2], std::cos(angle / 2)};
}

// Halves the arc where the two are far apart: sums, products and square roots have the same bits on every processor.
// Sines of the C library do not.
Quat slerp(Quat a, Quat b, double t) {
  constexpr double kNear = 5e-4, kStraight = 1e-12;  // of 1 - c
  double c = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  if (c < 0) {
    c = -c;
    for (double& x : b) x = -x;
  }
  const auto between = [&](double wa, double wb) {
    return normalized({wa * a[0] + wb * b[0], wa * a[1] + wb * b[1], wa * a[2] + wb * b[2], wa * a[3] + wb * b[3]});
  };
  if (1 - c <= kNear) return between(1 - t, t);
  for (; 1 - c > kStraight; c = std::sqrt((1 + c) / 2)) {
    const bool first_half = t < 0.5;
    (first_half ? b : a) = between(1, 1);
    t = first_half ? 2 * t : 2 * t - 1;
  }
  return between(1 - t, t);
}

double angle_between(const Quat& a, const Quat& b) {
  const auto [x, y, z, w] = conjugate(a) * b;
  return 2 * std::atan2(std::sqrt(x * x + y * y + z * z), std::abs(w));
}

Vec3 rotate(const Quat& q, const Vec3& v) {
  const Vec3 u{q[0], q[1], q[2]};
  const Vec3 t = 2.0 * cross(u, v);
  return v + q[3] * t + cross(u, t);
}

std::array<std::array<double, 3>, 3> rotation_matrix(const Quat& q) {
  const auto [x, y, z, w] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

Vec3 operator+(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vec3 operator-(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vec3 operator*(double s, const Vec3& a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vec3& a) { return std::sqrt(dot(a, a)); }

}  // namespace bodyopt
