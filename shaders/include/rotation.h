// rot(A): the rotation nearest to a 3 x 3 matrix, argmax over SO(3) of tr(R^T A). One source for GLSL and C++.
//
// Davenport's quaternion: the eigenvector of the largest eigenvalue of K = [tr A, z^T; z, A + A^T - tr(A) I] by Newton
// on the characteristic quartic from its upper bound sqrt(3)|A|, then one Newton step on SO(3). Always a rotation, also
// for det A < 0, rank 1 and zero (identity); no NaN for finite input.
#ifndef BODYOPT_ROTATION_H
#define BODYOPT_ROTATION_H

#include "one_source.h"

#ifdef __cplusplus
#include <cmath>
namespace bodyopt {
using std::abs;
using std::sqrt;
#endif

// Row-major rotation matrix of a quaternion that need not have unit length (but must not be zero).
BODYOPT_FUNCTION void rotation_from_quaternion(float w, float x, float y, float z, BODYOPT_OUT_ARRAY(r, 9)) {
  float s = 2.0f / (w * w + x * x + y * y + z * z);
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

// One Newton step of tr(R^T A) on SO(3), kept only where the function is concave (at a maximum).
BODYOPT_FUNCTION void refine_rotation(BODYOPT_IN_ARRAY(a, 9), BODYOPT_INOUT_ARRAY(r, 9)) {
  // B = R^T A; the gradient is its axial vector, the Hessian tr(B) I - sym(B).
  float b[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) b[3 * i + j] = r[i] * a[j] + r[3 + i] * a[3 + j] + r[6 + i] * a[6 + j];
  float t = b[0] + b[4] + b[8];
  float gx = b[7] - b[5], gy = b[2] - b[6], gz = b[3] - b[1];
  float h00 = t - b[0], h11 = t - b[4], h22 = t - b[8];
  float h01 = -0.5f * (b[1] + b[3]), h02 = -0.5f * (b[2] + b[6]), h12 = -0.5f * (b[5] + b[7]);
  float c00 = h11 * h22 - h12 * h12, c01 = h02 * h12 - h01 * h22, c02 = h01 * h12 - h02 * h11;
  float c11 = h00 * h22 - h02 * h02, c12 = h01 * h02 - h00 * h12, c22 = h00 * h11 - h01 * h01;
  float determinant = h00 * c00 + h01 * c01 + h02 * c02;
  if (!(h00 > 0.0f && c22 > 0.0f && determinant > 1e-12f)) return;
  float s = 0.5f / determinant;  // half the rotation vector: the quaternion's vector part
  float x = s * (c00 * gx + c01 * gy + c02 * gz);
  float y = s * (c01 * gx + c11 * gy + c12 * gz);
  float z = s * (c02 * gx + c12 * gy + c22 * gz);
  if (!(x * x + y * y + z * z < 0.01f)) return;  // far from a maximum a Newton step means nothing
  float step[9];
  rotation_from_quaternion(1.0f, x, y, z, step);
  float old[9];
  for (int i = 0; i < 9; ++i) old[i] = r[i];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r[3 * i + j] = old[3 * i] * step[j] + old[3 * i + 1] * step[3 + j] + old[3 * i + 2] * step[6 + j];
}

BODYOPT_FUNCTION void rot(BODYOPT_IN_ARRAY(matrix, 9), BODYOPT_OUT_ARRAY(r, 9)) {
  for (int i = 0; i < 9; ++i) r[i] = i % 4 == 0 ? 1.0f : 0.0f;
  float largest = 0.0f;
  for (int i = 0; i < 9; ++i) largest = abs(matrix[i]) > largest ? abs(matrix[i]) : largest;
  if (!(largest > 1e-30f)) return;
  float a[9];
  float norm2 = 0.0f;
  for (int i = 0; i < 9; ++i) {
    a[i] = matrix[i] / largest;
    norm2 += a[i] * a[i];
  }
  float inverse_norm = 1.0f / sqrt(norm2);
  for (int i = 0; i < 9; ++i) a[i] *= inverse_norm;

  // K, symmetric.
  float k00 = a[0] + a[4] + a[8];
  float k01 = a[7] - a[5], k02 = a[2] - a[6], k03 = a[3] - a[1];
  float k11 = a[0] - a[4] - a[8], k22 = a[4] - a[0] - a[8], k33 = a[8] - a[0] - a[4];
  float k12 = a[1] + a[3], k13 = a[2] + a[6], k23 = a[5] + a[7];

  // Characteristic quartic: l^4 - 2 l^2 - 8 det(A) l + det(K), for |A| = 1.
  float det_a =
      a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) + a[2] * (a[3] * a[7] - a[4] * a[6]);
  float det_k = (k00 * k11 - k01 * k01) * (k22 * k33 - k23 * k23) - (k00 * k12 - k02 * k01) * (k12 * k33 - k23 * k13) +
                (k00 * k13 - k03 * k01) * (k12 * k23 - k22 * k13) + (k01 * k12 - k02 * k11) * (k02 * k33 - k23 * k03) -
                (k01 * k13 - k03 * k11) * (k02 * k23 - k22 * k03) + (k02 * k13 - k03 * k12) * (k02 * k13 - k12 * k03);
  float l = 1.7320508f;
  for (int i = 0; i < 12; ++i) {
    float value = ((l * l - 2.0f) * l - 8.0f * det_a) * l + det_k;
    float slope = (4.0f * l * l - 4.0f) * l - 8.0f * det_a;
    if (slope > 1e-6f) l -= value / slope;
  }

  // The eigenvector is the largest column of adj(K - l I).
  float n00 = k00 - l, n11 = k11 - l, n22 = k22 - l, n33 = k33 - l;
  float m2233 = n22 * n33 - k23 * k23, m1233 = k12 * n33 - k23 * k13, m1223 = k12 * k23 - n22 * k13;
  float m0233 = k02 * n33 - k23 * k03, m0223 = k02 * k23 - n22 * k03, m0213 = k02 * k13 - k12 * k03;
  float m1133 = n11 * n33 - k13 * k13, m1123 = n11 * k23 - k12 * k13, m1122 = n11 * n22 - k12 * k12;
  float a00 = n11 * m2233 - k12 * m1233 + k13 * m1223;
  float a01 = -(k01 * m2233 - k12 * m0233 + k13 * m0223);
  float a02 = k01 * m1233 - n11 * m0233 + k13 * m0213;
  float a03 = -(k01 * m1223 - n11 * m0223 + k12 * m0213);
  float a11 = n00 * m2233 - k02 * m0233 + k03 * m0223;
  float a12 = -(n00 * m1233 - k01 * m0233 + k03 * m0213);
  float a13 = n00 * m1223 - k01 * m0223 + k02 * m0213;
  float a22 = n00 * m1133 - k01 * (k01 * n33 - k13 * k03) + k03 * (k01 * k13 - n11 * k03);
  float a23 = -(n00 * m1123 - k01 * (k01 * k23 - k13 * k02) + k03 * (k01 * k12 - n11 * k02));
  float a33 = n00 * m1122 - k01 * (k01 * n22 - k12 * k02) + k02 * (k01 * k12 - n11 * k02);
  float w = a00, x = a01, y = a02, z = a03;
  float best = abs(a00);
  if (abs(a11) > best) {
    best = abs(a11);
    w = a01, x = a11, y = a12, z = a13;
  }
  if (abs(a22) > best) {
    best = abs(a22);
    w = a02, x = a12, y = a22, z = a23;
  }
  if (abs(a33) > best) {
    best = abs(a33);
    w = a03, x = a13, y = a23, z = a33;
  }
  if (best < 1e-5f) {
    // A double largest eigenvalue (rank 1, or a reflection whose smaller stretches are equal): any vector of its space
    // will do. K + l I damps the other two directions; its diagonal sums to 4 l, so its largest column is not zero.
    w = k00 + l, x = k01, y = k02, z = k03;
    best = k00;
    if (k11 > best) {
      best = k11;
      w = k01, x = k11 + l, y = k12, z = k13;
    }
    if (k22 > best) {
      best = k22;
      w = k02, x = k12, y = k22 + l, z = k23;
    }
    if (k33 > best) {
      best = k33;
      w = k03, x = k13, y = k23, z = k33 + l;
    }
  }
  float scale = abs(w) + abs(x) + abs(y) + abs(z);
  rotation_from_quaternion(w / scale, x / scale, y / scale, z / scale, r);
  refine_rotation(a, r);
}

#ifdef __cplusplus
}  // namespace bodyopt
#endif
#endif
