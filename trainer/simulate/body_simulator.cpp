#include "trainer/simulate/body_simulator.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/rig.h"

namespace bodyopt {
namespace {

constexpr double kLargestStep = 20 * std::numbers::pi / 180;  // radians of any joint
constexpr double kSmallestShare = 1.0 / 500;                  // of the path, below which it is given up
constexpr double kLooseTolerance = 1e-2;
constexpr int kLooseIterations = 15;
constexpr double kTolerance = 5e-5;  // half of what a frame needs to count as converged
constexpr int kMostIterations = 2000;

double turn(const Quat& a, const Quat& b) {
  const Quat q = normalized(a) * conjugate(normalized(b));
  return 2 * std::acos(std::min(1.0, std::abs(q[3])));
}

double default_tet_size(const Character& character) {
  double sum = 0;
  for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      sum += (character.vertices.row(character.triangles(t, k)) -
              character.vertices.row(character.triangles(t, (k + 1) % 3)))
                 .norm();
    }
  }
  return 2.5 * sum / static_cast<double>(3 * character.triangles.rows());
}

}  // namespace

BodySimulator::BodySimulator(const Character& character, const std::vector<Muscle>& muscles, double tet_size)
    : character_(character),
      muscles_(muscles),
      mesh_(tetrahedralise(character.vertices, character.triangles,
                           tet_size > 0 ? tet_size : default_tet_size(character))),
      weights_(interior_weights(mesh_, character)),
      tissue_(label_tissue(mesh_, muscles)),
      attachments_(attach_bones(mesh_, character, weights_)),
      body_(mesh_, tissue_, attachments_),
      solver_(body_) {}

// Skinning matrices of the pose a share of the way from bind, seen from the root: the root itself stays at bind.
std::vector<Affine> BodySimulator::path_matrices(const Pose& pose, double along) const {
  const auto& joints = character_.skeleton.joints;
  std::vector<JointTransform> local(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const JointTransform &from = joints[j].bind, &to = pose.joints[j];
    local[j] = from;
    if (j == 0) continue;
    local[j].rotation = slerp(from.rotation, to.rotation, along);
    local[j].translation = from.translation + along * (to.translation - from.translation);
    local[j].scale = from.scale + along * (to.scale - from.scale);
  }
  return skinning_matrices(character_.skeleton, local);
}

Drive BodySimulator::drive(const std::vector<Affine>& skinning) const {
  Drive result;
  result.activation = activations(muscles_, skinning);
  for (const Attachment& attachment : attachments_) {
    const Vec3 x =
        skinning[attachment.joint] * Vec3{attachment.position(0), attachment.position(1), attachment.position(2)};
    result.targets.emplace_back(x[0], x[1], x[2]);
  }
  return result;
}

Positions BodySimulator::carry(const Positions& x, const std::vector<Affine>& from,
                               const std::vector<Affine>& to) const {
  using Blend = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  const auto blend = [this](const std::vector<Affine>& matrices, Eigen::Index n) {
    Blend sum = Blend::Zero();
    for (Eigen::Index j = 0; j < weights_.cols(); ++j) {
      if (weights_(n, j) > 1e-9) {
        sum += weights_(n, j) * Eigen::Map<const Blend>(&matrices[static_cast<std::size_t>(j)].m[0][0]);
      }
    }
    return sum;
  };
  Positions result(x.rows(), 3);
  for (Eigen::Index n = 0; n < x.rows(); ++n) {
    const Blend before = blend(from, n), after = blend(to, n);
    const Eigen::Vector3d rest = mesh_.nodes.row(n);
    const Eigen::Vector3d skinned = before * rest.homogeneous();
    const Eigen::Matrix3d linear = before.leftCols<3>();
    // A blend that is nearly flat has no displacement to speak of.
    Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
    if (linear.determinant() > 0.05) displacement = linear.inverse() * (x.row(n).transpose() - skinned);
    const Eigen::Vector3d carried = after * (rest + displacement).homogeneous();
    result.row(n) = carried;
  }
  return result;
}

SimulatedShape BodySimulator::simulate(const Pose& pose) const {
  const auto& joints = character_.skeleton.joints;
  double largest_turn = 0;
  for (std::size_t j = 1; j < joints.size(); ++j) {
    largest_turn = std::max(largest_turn, turn(pose.joints[j].rotation, joints[j].bind.rotation));
  }
  SimulatedShape shape;
  shape.nodes = mesh_.nodes;
  const double step = 1 / std::max(1.0, std::ceil(largest_turn / kLargestStep));
  double along = 0, share = step;
  std::vector<Affine> here = path_matrices(pose, 0);
  int iterations = 0;
  while (along < 1 && !shape.stalled) {
    const double next = along + share > 1 - 1e-9 ? 1 : along + share;
    const std::vector<Affine> there = path_matrices(pose, next);
    const bool last = next == 1;
    Positions x = carry(shape.nodes, here, there);
    shape.solve =
        solver_.solve(x, drive(there), last ? kTolerance : kLooseTolerance, last ? kMostIterations : kLooseIterations);
    iterations += shape.solve.iterations;
    if (shape.solve.inverted > 0) {
      share /= 2;
      shape.stalled = share < kSmallestShare;
      continue;
    }
    shape.nodes = x;
    here = there;
    along = next;
    share = std::min(step, 2 * share);
  }
  shape.solve.iterations = iterations;
  if (shape.stalled) shape.nodes = carry(shape.nodes, here, path_matrices(pose, 1));

  // Back to where the root is.
  const Affine root = affine_from(pose.joints[0]) * joints[0].inverse_bind;
  for (Eigen::Index n = 0; n < shape.nodes.rows(); ++n) {
    const Vec3 x = root * Vec3{shape.nodes(n, 0), shape.nodes(n, 1), shape.nodes(n, 2)};
    shape.nodes.row(n) << x[0], x[1], x[2];
  }
  return shape;
}

}  // namespace bodyopt
