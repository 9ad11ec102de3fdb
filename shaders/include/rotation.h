// rot(A): the rotation nearest to a 3 x 3 matrix, argmax over SO(3) of tr(R^T A). One source for GLSL, C++ and lanes;
// the CPU's kernels include it once for each set of instructions, in a namespace of its own.
//
// Davenport's quaternion is the eigenvector of the largest eigenvalue of K = [tr A, z^T; z, A + A^T - tr(A) I]. Newton
// finds that on the characteristic quartic from its upper bound sqrt(3)|A|; one Newton step on SO(3) follows. Always a
// rotation, also for det A < 0, rank 1 and zero (identity); no NaN for finite input.
#if !defined(BODYOPT_ROTATION_H) || defined(BODYOPT_OF_LANES)
#define BODYOPT_ROTATION_H

#include "one_source.h"

#if defined(__cplusplus) && !defined(BODYOPT_OF_LANES)
namespace bodyopt {
#endif

// Row-major rotation matrix of a quaternion that need not have unit length (but must not be zero).
BODYOPT_REAL_FUNCTION void rotation_from_quaternion(Real w, Real x, Real y, Real z, BODYOPT_OUT_REALS(r, 9)) {
  Real s = 2.0f / (w * w + x * x + y * y + z * z);
  r[0] = 1.0f - s * (y * y + z * z);
  r[1] = s * (x * y - w * z);
  r[2] = s * (x * z + w * y);
  r[3] = s * (x * y + w * z);
  r[4] = 1.0f - s * (x * x + z * z);
  r[5] = s * (y * z - w * x);
  r[6] = s * (x * z - w * y);
  r[7] = s * (y * z + w * x);
  r[8] = 1.0f - s * (x * x + y * y);
}

// One Newton step of tr(R^T A) on SO(3), of no length unless the function is concave (at a maximum).
BODYOPT_REAL_FUNCTION void refine_rotation(BODYOPT_IN_REALS(a, 9), BODYOPT_INOUT_REALS(r, 9)) {
  // B = R^T A; the gradient is its axial vector, the Hessian tr(B) I - sym(B).
  Real b[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) b[3 * i + j] = r[i] * a[j] + r[3 + i] * a[3 + j] + r[6 + i] * a[6 + j];
  Real t = b[0] + b[4] + b[8];
  Real gx = b[7] - b[5], gy = b[2] - b[6], gz = b[3] - b[1];
  Real h00 = t - b[0], h11 = t - b[4], h22 = t - b[8];
  Real h01 = -0.5f * (b[1] + b[3]), h02 = -0.5f * (b[2] + b[6]), h12 = -0.5f * (b[5] + b[7]);
  Real c00 = h11 * h22 - h12 * h12, c01 = h02 * h12 - h01 * h22, c02 = h01 * h12 - h02 * h11;
  Real c11 = h00 * h22 - h02 * h02, c12 = h01 * h02 - h00 * h12, c22 = h00 * h11 - h01 * h01;
  Real determinant = h00 * c00 + h01 * c01 + h02 * c02;
  Real concave = min(min(h00, c22), determinant - 1e-12f);
  Real s = select(concave > 0.0f, 0.5f / determinant, 0.0f);  // half the rotation vector: the quaternion's vector part
  Real x = s * (c00 * gx + c01 * gy + c02 * gz);
  Real y = s * (c01 * gx + c11 * gy + c12 * gz);
  Real z = s * (c02 * gx + c12 * gy + c22 * gz);
  Real length2 = x * x + y * y + z * z;  // far from a maximum a Newton step means nothing
  x = select(length2 < 0.01f, x, 0.0f);
  y = select(length2 < 0.01f, y, 0.0f);
  z = select(length2 < 0.01f, z, 0.0f);
  Real step[9], old[9];
  rotation_from_quaternion(Real(1.0f), x, y, z, step);
  for (int i = 0; i < 9; ++i) old[i] = r[i];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r[3 * i + j] = old[3 * i] * step[j] + old[3 * i + 1] * step[3 + j] + old[3 * i + 2] * step[6 + j];
}

// The column (w, x, y, z) in the place of the best, if its size is larger.
BODYOPT_REAL_FUNCTION void take_column(Real size, Real column_w, Real column_x, Real column_y, Real column_z,
                                       BODYOPT_INOUT_REAL(best), BODYOPT_INOUT_REAL(w), BODYOPT_INOUT_REAL(x),
                                       BODYOPT_INOUT_REAL(y), BODYOPT_INOUT_REAL(z)) {
  w = select(size > best, column_w, w);
  x = select(size > best, column_x, x);
  y = select(size > best, column_y, y);
  z = select(size > best, column_z, z);
  best = select(size > best, size, best);
}

BODYOPT_REAL_FUNCTION void rot(BODYOPT_IN_REALS(matrix, 9), BODYOPT_OUT_REALS(r, 9)) {
  Real largest = 0.0f;
  for (int i = 0; i < 9; ++i) largest = max(largest, abs(matrix[i]));
  // A quarter: the inverse of the largest float would be subnormal.
  Real inverse_largest = 1.0f / max(0.25f * largest, Real(2.5e-31f));
  Real a[9];
  Real norm2 = 0.0f;
  for (int i = 0; i < 9; ++i) {
    a[i] = (0.25f * matrix[i]) * inverse_largest;
    norm2 += a[i] * a[i];
  }
  Real inverse_norm = 1.0f / sqrt(max(norm2, Real(0.5f)));
  for (int i = 0; i < 9; ++i) a[i] *= inverse_norm;
  // Next to nothing has the rotation of the identity.
  for (int i = 0; i < 9; ++i) a[i] = select(largest > 1e-30f, a[i], i % 4 == 0 ? 0.57735027f : 0.0f);

  // K, symmetric.
  Real k00 = a[0] + a[4] + a[8];
  Real k01 = a[7] - a[5], k02 = a[2] - a[6], k03 = a[3] - a[1];
  Real k11 = a[0] - a[4] - a[8], k22 = a[4] - a[0] - a[8], k33 = a[8] - a[0] - a[4];
  Real k12 = a[1] + a[3], k13 = a[2] + a[6], k23 = a[5] + a[7];

  // Characteristic quartic: l^4 - 2 l^2 - 8 det(A) l + det(K), for |A| = 1. From above the steps only ever go down.
  Real det_a =
      a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) + a[2] * (a[3] * a[7] - a[4] * a[6]);
  Real det_k = (k00 * k11 - k01 * k01) * (k22 * k33 - k23 * k23) - (k00 * k12 - k02 * k01) * (k12 * k33 - k23 * k13) +
               (k00 * k13 - k03 * k01) * (k12 * k23 - k22 * k13) + (k01 * k12 - k02 * k11) * (k02 * k33 - k23 * k03) -
               (k01 * k13 - k03 * k11) * (k02 * k23 - k22 * k03) + (k02 * k13 - k03 * k12) * (k02 * k13 - k12 * k03);
  Real l = 1.7320508f;
  for (int i = 0; i < 12; ++i) {
    Real value = ((l * l - 2.0f) * l - 8.0f * det_a) * l + det_k;
    Real slope = (4.0f * l * l - 4.0f) * l - 8.0f * det_a;
    Real step = value / max(slope, Real(1e-6f));
    if (!any_of(step > 1e-6f)) break;
    l -= select(step > 1e-6f, step, 0.0f);
  }

  // The eigenvector is the largest column of adj(K - l I).
  Real n00 = k00 - l, n11 = k11 - l, n22 = k22 - l, n33 = k33 - l;
  Real m2233 = n22 * n33 - k23 * k23, m1233 = k12 * n33 - k23 * k13, m1223 = k12 * k23 - n22 * k13;
  Real m0233 = k02 * n33 - k23 * k03, m0223 = k02 * k23 - n22 * k03, m0213 = k02 * k13 - k12 * k03;
  Real m1133 = n11 * n33 - k13 * k13, m1123 = n11 * k23 - k12 * k13, m1122 = n11 * n22 - k12 * k12;
  Real a00 = n11 * m2233 - k12 * m1233 + k13 * m1223;
  Real a01 = -(k01 * m2233 - k12 * m0233 + k13 * m0223);
  Real a02 = k01 * m1233 - n11 * m0233 + k13 * m0213;
  Real a03 = -(k01 * m1223 - n11 * m0223 + k12 * m0213);
  Real a11 = n00 * m2233 - k02 * m0233 + k03 * m0223;
  Real a12 = -(n00 * m1233 - k01 * m0233 + k03 * m0213);
  Real a13 = n00 * m1223 - k01 * m0223 + k02 * m0213;
  Real a22 = n00 * m1133 - k01 * (k01 * n33 - k13 * k03) + k03 * (k01 * k13 - n11 * k03);
  Real a23 = -(n00 * m1123 - k01 * (k01 * k23 - k13 * k02) + k03 * (k01 * k12 - n11 * k02));
  Real a33 = n00 * m1122 - k01 * (k01 * n22 - k12 * k02) + k02 * (k01 * k12 - n11 * k02);
  Real w = a00, x = a01, y = a02, z = a03;
  Real best = abs(a00);
  take_column(abs(a11), a01, a11, a12, a13, best, w, x, y, z);
  take_column(abs(a22), a02, a12, a22, a23, best, w, x, y, z);
  take_column(abs(a33), a03, a13, a23, a33, best, w, x, y, z);
  if (any_of(best < 1e-5f)) {
    // A double largest eigenvalue (rank 1, or a reflection whose smaller stretches are equal): any vector of its space
    // will do. K + l I damps the other two directions; its diagonal sums to 4 l, so its largest column is not zero.
    Real other_w = k00 + l, other_x = k01, other_y = k02, other_z = k03;
    Real other = k00;
    take_column(k11, k01, k11 + l, k12, k13, other, other_w, other_x, other_y, other_z);
    take_column(k22, k02, k12, k22 + l, k23, other, other_w, other_x, other_y, other_z);
    take_column(k33, k03, k13, k23, k33 + l, other, other_w, other_x, other_y, other_z);
    w = select(best < 1e-5f, other_w, w);
    x = select(best < 1e-5f, other_x, x);
    y = select(best < 1e-5f, other_y, y);
    z = select(best < 1e-5f, other_z, z);
  }
  Real inverse_scale = 1.0f / (abs(w) + abs(x) + abs(y) + abs(z));
  rotation_from_quaternion(w * inverse_scale, x * inverse_scale, y * inverse_scale, z * inverse_scale, r);
  refine_rotation(a, r);
}

#if defined(__cplusplus) && !defined(BODYOPT_OF_LANES)
}  // namespace bodyopt
#endif
#endif
