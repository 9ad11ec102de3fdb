#include "tests/support/textbook_ddm.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <bit>

#include "runtime/core/half.h"

namespace bodyopt::testing {

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& a) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  const Eigen::Matrix3d v = svd.matrixV();
  if ((u * v.transpose()).determinant() < 0) u.col(2) *= -1;
  return u * v.transpose();
}

double rotation_gap(const Eigen::Matrix3d& a) {
  const Eigen::Vector3d s = Eigen::JacobiSVD<Eigen::Matrix3d>(a).singularValues();
  return s[0] > 0 ? (s[1] + (a.determinant() < 0 ? -s[2] : s[2])) / s[0] : 0;
}

TextbookPosition textbook_ddm(const DdmTable& ddm, std::uint32_t vertex, const float* skinning,
                              const Eigen::Vector3d& delta) {
  const DdmVertex& v = ddm.vertices[vertex];
  const Eigen::Vector3d centre(v.centre_x, v.centre_y, v.centre_z), offset(v.offset_x, v.offset_y, v.offset_z);
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  const std::uint32_t block = vertex / kBlockSize, lane = vertex % kBlockSize;
  for (std::uint32_t e = ddm.block_begin[block]; e < ddm.block_begin[block + 1]; ++e) {
    const auto word = [&](std::uint32_t w) { return ddm.moments[(e * kMomentWords + w) * kBlockSize + lane]; };
    const double half[6] = {half_low(word(0)),  half_high(word(0)), half_low(word(1)),
                            half_high(word(1)), half_low(word(2)),  half_high(word(2))};
    const double r2 = v.radius2, omega = std::bit_cast<float>(word(6));
    Eigen::Matrix3d s2;
    s2 << half[0], half[1], half[2], half[1], half[3], half[4], half[2], half[4], half[5];
    s2 *= r2;
    const Eigen::Vector3d s1 = r2 * Eigen::Vector3d(std::bit_cast<float>(word(3)), std::bit_cast<float>(word(4)),
                                                    std::bit_cast<float>(word(5)));
    Eigen::Matrix4d psi;
    psi.topLeftCorner<3, 3>() =
        s2 + centre * s1.transpose() + s1 * centre.transpose() + omega * centre * centre.transpose();
    psi.topRightCorner<3, 1>() = s1 + omega * centre;
    psi.bottomLeftCorner<1, 3>() = (s1 + omega * centre).transpose();
    psi(3, 3) = omega;
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topRows<3>() = Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(skinning + 12 * ddm.block_joints[e])
                         .cast<double>();
    sum += m * psi;
  }
  const Eigen::Vector3d q = sum.topRightCorner<3, 1>(), p = sum.bottomLeftCorner<1, 3>().transpose();
  const Eigen::Matrix3d a = sum.topLeftCorner<3, 3>() - q * p.transpose();
  const Eigen::Matrix3d r = nearest_rotation(a);
  return {r * (centre + offset + delta) + q - r * p, rotation_gap(a)};
}

}  // namespace bodyopt::testing
