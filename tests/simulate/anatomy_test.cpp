// Bones, interior weights, muscles and the skin's bending on a small limb.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "runtime/host/rig.h"
#include "tests/simulate/limb.h"
#include "trainer/simulate/bone_springs.h"
#include "trainer/simulate/muscle_fibres.h"
#include "trainer/simulate/node_weights.h"
#include "trainer/simulate/skin_bending.h"
#include "trainer/tets/lattice_cage.h"
#include "trainer/tets/tets.h"

namespace bodyopt {
namespace {

class Anatomy : public ::testing::Test {
 protected:
  Anatomy()
      : limb_(make_limb()),
        mesh_(tetrahedralise(limb_.vertices, limb_.triangles, 0.05)),
        laplacian_(tet_laplacian(mesh_, std::vector<double>(static_cast<std::size_t>(mesh_.tets.rows()), 1e4))),
        weights_(carry_inwards(limb_, laplacian_, SparseMatrix(mesh_.nodes.rows(), mesh_.nodes.rows()),
                               NodeWeights::Zero(mesh_.nodes.rows(), 2))),
        bones_(find_bones(mesh_, limb_, weights_)) {}

  Eigen::Vector3d position(const BonePoint& point) const {
    Eigen::Vector3d result = Eigen::Vector3d::Zero();
    for (int a = 0; a < 4; ++a) result += point.weights[a] * mesh_.nodes.row(mesh_.tets(point.tet, a)).transpose();
    return result;
  }

  Character limb_;
  TetMesh mesh_;
  SparseMatrix laplacian_;
  NodeWeights weights_;
  std::vector<BonePoint> bones_;
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

TEST_F(Anatomy, BonesLieInsideTheirOwnHalfClearOfSkinAndHinge) {
  double volume[2] = {0, 0}, reach = 0;
  for (const BonePoint& point : bones_) {
    const Eigen::Vector3d p = position(point);
    volume[point.joint] += point.volume;
    reach = std::max(reach, p[0]);
    EXPECT_EQ(point.joint, p[0] < kTubeLength / 2 ? 0 : 1);
    EXPECT_LT(p.tail<2>().norm(), 0.8 * kTubeRadius);
    if (std::abs(p[0] - kTubeLength / 2) < 0.005) {
      EXPECT_LT(p.tail<2>().norm(), 0.3 * kTubeRadius);
    }
  }
  const double limb_volume = std::numbers::pi * kTubeRadius * kTubeRadius * kTubeLength;
  for (const double v : volume) {
    EXPECT_GT(v, 0.02 * limb_volume);
    EXPECT_LT(v, 0.3 * limb_volume);
  }
  EXPECT_GT(reach, 0.85 * kTubeLength);  // the last bone holds the end
}

TEST_F(Anatomy, SpringsPullLikeTheDocumentedEnergy) {
  const BoneSprings springs(mesh_, bones_, 2);
  const std::vector<Affine> skinning = skinning_matrices(limb_.skeleton, bent(limb_, 0.8).joints);
  const SpringPose pose = springs.pose(skinning);
  const auto energy = [&](const Positions& nodes) {
    double sum = 0;
    for (const BonePoint& point : bones_) {
      Eigen::Vector3d now = Eigen::Vector3d::Zero();
      for (int a = 0; a < 4; ++a) now += point.weights[a] * nodes.row(mesh_.tets(point.tet, a)).transpose();
      const Eigen::Vector3d rest = position(point);
      const Vec3 target = skinning[static_cast<std::size_t>(point.joint)] * Vec3{rest[0], rest[1], rest[2]};
      sum += 0.5 * Materials{}.bone_springs * point.volume *
             (now - Eigen::Vector3d(target[0], target[1], target[2])).squaredNorm();
    }
    return sum;
  };
  std::srand(4);
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
  const BoneSprings springs(mesh_, bones_, 2);
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

TEST_F(Anatomy, MusclesTakeTheTetsOfTheirBelly) {
  const Muscle flexor = make_flexor();
  const std::vector<FibreTet> fibres = label_muscles(mesh_, {flexor});
  ASSERT_GT(fibres.size(), 5u);
  for (const FibreTet& fibre : fibres) {
    EXPECT_EQ(fibre.muscle, 0);
    EXPECT_NEAR(fibre.direction[0], 1, 1e-12);
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    for (int a = 0; a < 4; ++a) centroid += 0.25 * mesh_.nodes.row(mesh_.tets(fibre.tet, a)).transpose();
    EXPECT_LT((centroid - Eigen::Vector3d(centroid[0], 0.018, 0)).norm(), flexor.radius);
    EXPECT_GT(centroid[0], 0.03);
    EXPECT_LT(centroid[0], 0.29);
  }
}

// Thinner than any tet, alone or where another muscle has all of them: on either side of the body alike.
TEST_F(Anatomy, AThinMusclePullsInTheTetAtItsMiddle) {
  Muscle flexor = make_flexor(), thread = make_flexor();
  thread.radius = 1e-3;
  const Cage cage = lattice_cage(limb_.vertices, limb_.triangles, limb_.weights, 300);
  for (const std::vector<FibreTet>& fibres :
       {label_muscles(mesh_, {flexor, thread}), label_muscles(cage, {flexor, thread})}) {
    const auto pulls = [](const FibreTet& fibre) { return fibre.muscle == 1; };
    ASSERT_EQ(std::count_if(fibres.begin(), fibres.end(), pulls), 1);
    const FibreTet& fibre = *std::find_if(fibres.begin(), fibres.end(), pulls);
    EXPECT_NEAR(fibre.direction[0], 1, 1e-12);
    EXPECT_GT(fibre.share, 0);
    EXPECT_LT(fibre.share, 0.5);
  }
}

TEST_F(Anatomy, ActivationGrowsWithShorteningOnly) {
  Muscle flexor = make_flexor(), extensor = make_flexor();
  for (MusclePoint& point : extensor.path) point.position[1] *= -1;
  flexor.max_activation = 0.8;
  double before = 0;
  for (const double angle : {0.0, 0.3, 0.6, 1.0, 1.5}) {
    const std::vector<Affine> skinning = skinning_matrices(limb_.skeleton, bent(limb_, angle).joints);
    const std::vector<double> active = activations({flexor, extensor}, skinning);
    if (angle == 0) {
      EXPECT_LT(active[0], 1e-12);
    } else {
      EXPECT_GT(active[0], before);
      EXPECT_LT(path_length(flexor, skinning), 0.26);
      EXPECT_GT(path_length(extensor, skinning), 0.26);
    }
    EXPECT_LE(active[0], 0.8);
    EXPECT_LT(active[1], 1e-12);
    before = active[0];
  }
}

}  // namespace
}  // namespace bodyopt
