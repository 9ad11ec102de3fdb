// Springs of bones, interior weights, activation and the skin's bending on a small limb.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "runtime/host/rig.h"
#include "tests/simulate/tube_field.h"
#include "trainer/simulate/bone_springs.h"
#include "trainer/simulate/muscle_fibres.h"
#include "trainer/simulate/node_weights.h"
#include "trainer/simulate/skin_bending.h"
#include "trainer/tets/tets.h"

namespace bodyopt::trainer {
namespace {

constexpr double kBone = Materials{}.bone_springs;  // N/m per cubic metre

class Anatomy : public ::testing::Test {
 protected:
  Anatomy()
      : limb_(make_limb()),
        cage_(own_cage(limb_.vertices, limb_.triangles, limb_.weights, 0.05)),
        mesh_(cage_.mesh),
        laplacian_(tet_laplacian(mesh_, std::vector<double>(static_cast<std::size_t>(mesh_.tets.rows()), 1e4))),
        weights_(carry_through(limb_, cage_, laplacian_, SparseMatrix(mesh_.nodes.rows(), mesh_.nodes.rows()),
                               NodeWeights::Zero(mesh_.nodes.rows(), 2))),
        bones_(find_tissue(mesh_, tube_tissue).bones) {}

  Character limb_;
  Cage cage_;
  TetMesh mesh_;
  SparseMatrix laplacian_;
  NodeWeights weights_;
  std::vector<BonePart> bones_;
};

Positions turned(const Positions& nodes, const Affine& motion) {
  Positions result(nodes.rows(), 3);
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    const Vec3 p = motion * Vec3{nodes(n, 0), nodes(n, 1), nodes(n, 2)};
    result.row(n) << p[0], p[1], p[2];
  }
  return result;
}

TEST_F(Anatomy, WeightsInsideFollowTheSkin) {
  for (Eigen::Index n = 0; n < mesh_.nodes.rows(); ++n) {
    EXPECT_NEAR(weights_.row(n).sum(), 1, 1e-12);
    EXPECT_GE(weights_.row(n).minCoeff(), 0);
    if (mesh_.nodes(n, 0) < 0.15) {
      EXPECT_GT(weights_(n, 0), 0.95);
    }
    if (mesh_.nodes(n, 0) > 0.35) {
      EXPECT_GT(weights_(n, 1), 0.95);
    }
  }
}

// Springs at points: the sum of what each of them has.
TEST_F(Anatomy, SpringsPullLikeTheDocumentedEnergy) {
  struct PointSpring {
    Eigen::Vector4d weights;
    double volume;
  };
  std::srand(4);
  std::vector<PointSpring> points;
  std::vector<BonePart> parts;
  for (const BonePart& bone : bones_) {
    Eigen::Vector4d weights = Eigen::Vector4d::Random().cwiseAbs();
    weights /= weights.sum();
    points.push_back({weights, bone.volume()});
    parts.push_back({bone.tet, bone.joint, bone.volume() * weights * weights.transpose()});
  }
  const BoneSprings springs(mesh_, parts, kBone, 2);
  const std::vector<Affine> skinning = skinning_matrices(limb_.skeleton, bent(limb_, 0.8).joints);
  const SpringPose pose = springs.pose(skinning);
  const auto energy = [&](const Positions& nodes) {
    double sum = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const BonePart& bone = parts[k];
      Eigen::Vector3d now = Eigen::Vector3d::Zero();
      for (int a = 0; a < 4; ++a) now += points[k].weights[a] * nodes.row(mesh_.tets(bone.tet, a)).transpose();
      const Eigen::Vector3d rest = rest_position(mesh_, {bone.tet, points[k].weights});
      const Vec3 target = skinning[static_cast<std::size_t>(bone.joint)] * Vec3{rest[0], rest[1], rest[2]};
      sum += 0.5 * kBone * points[k].volume * (now - Eigen::Vector3d(target[0], target[1], target[2])).squaredNorm();
    }
    return sum;
  };
  const Positions at = mesh_.nodes, direction = Positions::Random(at.rows(), 3);
  Positions gradient = Positions::Zero(at.rows(), 3), unused = gradient;
  const double here = springs.add_gradient(pose, at, gradient);
  const double step = 1e-4;
  const double slope = (energy(at + step * direction) - energy(at - step * direction)) / (2 * step);
  EXPECT_NEAR(gradient.cwiseProduct(direction).sum(), slope, 1e-8 * gradient.norm() * direction.norm());
  const double difference = springs.add_gradient(pose, at + step * direction, unused) - here;
  EXPECT_NEAR(difference, energy(at + step * direction) - energy(at), 1e-8 * std::abs(here));
}

TEST_F(Anatomy, RigidMotionPullsNoSpringAndBendsNoSkin) {
  const Quat rotation = axis_angle({0.6, 0, 0.8}, 1.9);
  const Affine motion = affine_from({{3, -2, 1}, rotation, {1, 1, 1}});
  const Positions nodes = turned(mesh_.nodes, motion);
  const BoneSprings springs(mesh_, bones_, kBone, 2);
  Positions gradient = Positions::Zero(nodes.rows(), 3);
  springs.add_gradient(springs.pose(std::vector<Affine>{motion, motion}), nodes, gradient);
  EXPECT_LT(gradient.cwiseAbs().maxCoeff(), 1e-8);  // newtons; a millimetre makes about one

  const SkinBending bending(limb_.vertices, limb_.triangles, nodes.rows());
  gradient.setZero();
  const std::vector<Quat> rotations(static_cast<std::size_t>(nodes.rows()), rotation);
  EXPECT_NEAR(bending.add_gradient(bending.curvature(rotations), nodes, gradient), 0, 1e-15);
  EXPECT_LT(gradient.cwiseAbs().maxCoeff(), 1e-10);
}

TEST_F(Anatomy, BendingGradientIsTheEnergysDerivativeAndItsStiffnessTheHessian) {
  const SkinBending bending(limb_.vertices, limb_.triangles, mesh_.nodes.rows());
  const Positions curvature = bending.curvature(std::vector<Quat>(static_cast<std::size_t>(mesh_.nodes.rows())));
  std::srand(2);
  const Positions direction = Positions::Random(mesh_.nodes.rows(), 3), at = mesh_.nodes + 1e-3 * direction;
  Positions gradient = Positions::Zero(at.rows(), 3), unused = gradient;
  bending.add_gradient(curvature, at, gradient);
  const double step = 1e-5;
  const double slope = (bending.add_gradient(curvature, at + step * direction, unused) -
                        bending.add_gradient(curvature, at - step * direction, unused)) /
                       (2 * step);
  EXPECT_NEAR(gradient.cwiseProduct(direction).sum(), slope, 1e-7 * std::abs(slope));
  const Positions expected = 1e-3 * (bending.stiffness() * direction);  // quadratic, zero at rest
  EXPECT_LT((gradient - expected).norm(), 1e-9 * expected.norm());
}

TEST_F(Anatomy, ShorterPathsDriveFibres) {
  Muscle flexor = make_flexor(), extensor = make_flexor();
  for (MusclePoint& point : extensor.path) point.position[1] *= -1;
  flexor.max_activation = 0.8;
  constexpr double kBelly = 0.2, kSeries = 0.04 * 0.26 / kBelly;  // of a path of 0.26 m
  double before = 0;
  for (const double angle : {0.0, 0.3, 0.6, 1.0, 1.5}) {
    const std::vector<Affine> skinning = skinning_matrices(limb_.skeleton, bent(limb_, angle).joints);
    const std::vector<FibreDrive> drives =
        fibre_drives({flexor, extensor}, std::vector<double>{kBelly, kBelly}, skinning, 0.7);
    const double shorter = 0.26 - path_length(flexor, skinning);
    if (angle == 0) {
      EXPECT_LT(drives[0].activation, 1e-12);
    } else {
      EXPECT_GT(drives[0].activation, before);
      EXPECT_GT(shorter, 0);
      EXPECT_GT(path_length(extensor, skinning), 0.26);
    }
    EXPECT_NEAR(drives[0].slack, std::max(1 - kSeries - shorter / kBelly, 0.7), 1e-9);
    EXPECT_NEAR(drives[1].slack, 1 - kSeries, 1e-9);
    EXPECT_LE(drives[0].activation, 0.8);
    EXPECT_LT(drives[1].activation, 1e-12);
    before = drives[0].activation;
  }
}

}  // namespace
}  // namespace bodyopt::trainer
