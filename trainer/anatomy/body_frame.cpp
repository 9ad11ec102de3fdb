#include "trainer/anatomy/body_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "assets/axis_turns.h"
#include "assets/joint_roles.h"
#include "geometry/nearest_skin.h"

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// From the joints that are named right to those that are named left, on average; zero where none are.
Vector3d left_by_names(const Skeleton& skeleton) {
  Vector3d sum[2] = {Vector3d::Zero(), Vector3d::Zero()};
  double count[2] = {0, 0};
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const BodySide side = side_of_name(skeleton.joints[j].name);
    if (side == BodySide::middle) continue;
    const int k = side == BodySide::left ? 0 : 1;
    sum[k] += Vector3d(bind_place(skeleton, j).data());
    ++count[k];
  }
  if (count[0] == 0 || count[1] == 0) return Vector3d::Zero();
  return sum[0] / count[0] - sum[1] / count[1];
}

// The turn about y that brings an axis of the ground, +x, -x, +z or -z, to +x.
Matrix3d turn_to_left(const Vector3d& axis) {
  const Vector3d up = Vector3d::UnitY();
  Matrix3d turn;
  turn << axis.transpose(), up.transpose(), axis.cross(up).transpose();
  return turn;
}

}  // namespace

double mirror_error(const Positions& vertices, const NearestSkin& skin, int axis, double middle) {
  constexpr Index kMost = 400;  // vertices that are looked at, evenly spread
  const Index step = std::max<Index>(1, vertices.rows() / kMost);
  double sum = 0, count = 0;
  for (Index v = 0; v < vertices.rows(); v += step, ++count) {
    Vector3d image = vertices.row(v);
    image[axis] = 2 * middle - image[axis];
    sum += (skin(image).position - image).norm();
  }
  return sum / count;
}

Character turned(const Character& character, const Matrix3d& rotation) {
  Character result = character;
  result.vertices = character.vertices * rotation.transpose();
  Affine back;  // turned space to rest space
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&back.m[0][0]).leftCols<3>() = rotation.transpose();
  for (Joint& joint : result.skeleton.joints) joint.inverse_bind = joint.inverse_bind * back;
  return result;
}

Matrix3d body_frame(const Character& character) {
  const auto upright = rotation_matrix(turn_upright(character.skeleton));
  Matrix3d frame;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) frame(static_cast<Index>(r), static_cast<Index>(c)) = std::round(upright[r][c]);
  }
  const Vector3d left = frame * left_by_names(character.skeleton);
  Vector3d axis = Vector3d::UnitX();
  if (std::max(std::abs(left.x()), std::abs(left.z())) > 0.5 * left.norm()) {
    const int along = std::abs(left.x()) >= std::abs(left.z()) ? 0 : 2;
    axis = std::copysign(1.0, left[along]) * Vector3d::Unit(along);
  } else if (character.triangles.rows() > 0 && character.vertices.allFinite()) {
    const Character standing = turned(character, frame);
    const NearestSkin skin(standing.vertices, standing.triangles);
    // A body that looks along x has its left at -z.
    const auto error = [&](int across) {
      const auto along = standing.vertices.col(across);
      return mirror_error(standing.vertices, skin, across, 0.5 * (along.minCoeff() + along.maxCoeff()));
    };
    if (error(2) < 0.5 * error(0)) axis = -Vector3d::UnitZ();
  }
  return turn_to_left(axis) * frame;
}

}  // namespace bodyopt
