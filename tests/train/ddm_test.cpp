// Direct Delta Mush on small meshes: identities, and a dense textbook version.
#include "trainer/train/skinning/ddm.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <random>

#include "runtime/core/error.h"
#include "runtime/cpu/kernels.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/textbook_algebra.h"
#include "tests/support/textbook_ddm.h"

namespace bodyopt::trainer {
namespace {

using SkinWeights = std::vector<std::vector<JointWeight>>;
using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

Positions packed_positions(const DdmTable& table, Eigen::Index count, const std::vector<float>& skinning) {
  const std::vector<float> origin(4, 0.0f), nothing(static_cast<std::size_t>(3 * count), 0.0f);
  Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> positions(count, 3);
  cpu::pose_skin(table, static_cast<std::uint32_t>(skinning.size() / 12), skinning, origin, nothing,
                 {positions.data(), nothing.size()});
  return positions.cast<double>();
}

std::vector<float> flatten(const std::vector<Rows>& matrices) {
  std::vector<float> values;
  for (const Rows& m : matrices) values.insert(values.end(), m.data(), m.data() + 12);
  return values;
}

Rows rigid(const Eigen::Vector3d& axis, double angle, const Eigen::Vector3d& shift) {
  Rows m;
  m.leftCols<3>() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  m.col(3) = shift;
  return m;
}

// Two triangles that share an edge, of any shape, on two joints.
struct Hinge {
  explicit Hinge(std::mt19937_64& random) : positions(4, 3), triangles(2, 3), weights(4) {
    std::uniform_real_distribution<double> unit(0, 1);
    for (double& x : positions.reshaped()) x = 0.2 * unit(random) - 0.1;
    triangles << 0, 1, 2, 2, 1, 3;
    for (auto& list : weights) {
      const double w = unit(random);
      list = {{0, w}, {1, 1 - w}};
    }
  }
  Positions positions;
  Triangles triangles;
  SkinWeights weights;
};

TEST(Ddm, RestOfRandomHingesIsRest) {
  std::mt19937_64 random(7);
  const std::vector<float> identity = flatten({Rows::Identity(), Rows::Identity()});
  for (int k = 0; k < 2000; ++k) {
    const Hinge hinge(random);
    const DdmTable table = pack_ddm(ddm_moments(hinge.positions, hinge.triangles, hinge.weights, {.radius = 0.05}));
    const double error = (packed_positions(table, 4, identity) - hinge.positions).cwiseAbs().maxCoeff();
    ASSERT_LT(error, 1e-6) << "hinge " << k;
  }
}

TEST(Ddm, RigidMotionOfRandomHingesIsRigid) {
  std::mt19937_64 random(8);
  const Rows motion = rigid({1, -2, 0.5}, 2.1, {0.3, -0.2, 0.1});
  for (int k = 0; k < 500; ++k) {
    const Hinge hinge(random);
    const DdmTable table = pack_ddm(ddm_moments(hinge.positions, hinge.triangles, hinge.weights, {.radius = 0.05}));
    Positions expected = hinge.positions * motion.leftCols<3>().transpose();
    expected.rowwise() += motion.col(3).transpose();
    const Positions found = packed_positions(table, 4, flatten({motion, motion}));
    // A half's rounding tilts the rotation of the flattest hinges a little.
    ASSERT_LT((found - expected).cwiseAbs().maxCoeff(), 2e-6) << "hinge " << k;
  }
}

TEST(Ddm, ABodyOfAnySizeHasTheSameShape) {
  const Character limb = limb_character();
  const auto bent = [&](double size) {
    const Positions rest = size * limb.vertices;
    const DdmTable table =
        pack_ddm(ddm_moments(rest, limb.triangles, limb.weights, {.radius = default_smoothing_radius(rest)}));
    std::vector<Rows> skinning(limb.skeleton.size(), Rows::Identity());
    for (std::size_t j = 1; j < skinning.size(); ++j) skinning[j] = rigid({1, 0.3, -0.2}, 1.1, {0, 0.1 * size, 0});
    return Positions(packed_positions(table, rest.rows(), flatten(skinning)) / size);
  };
  const Positions usual = bent(1);
  EXPECT_GT((usual - limb.vertices).norm(), 0.1);
  for (const double size : {0.01, 0.1, 0.37, 3.0, 23.5, 100.0}) {
    EXPECT_LT((bent(size) - usual).cwiseAbs().maxCoeff(), 1e-6) << size;
  }
}

TEST(Ddm, MomentsAreThoseOfAPartitionOfUnity) {
  const Character limb = limb_character();
  for (const double prune : {0.0, 1e-4, 1e-2}) {
    const auto moments = ddm_moments(limb.vertices, limb.triangles, limb.weights, {.prune = prune});
    ASSERT_EQ(moments.size(), limb.weights.size());
    for (std::size_t v = 0; v < moments.size(); ++v) {
      double omega = 0, trace = 0;
      Eigen::Vector3d first = Eigen::Vector3d::Zero();
      for (const JointMoments& m : moments[v].joints) {
        EXPECT_GT(m.omega, prune);
        omega += m.omega;
        trace += m.second.trace();
        first += m.first;
      }
      EXPECT_NEAR(omega, 1, 1e-12);
      EXPECT_NEAR(moments[v].kept, 1, prune == 0 ? 1e-10 : prune * static_cast<double>(limb.skeleton.size()));
      EXPECT_LT(first.norm() * std::sqrt(moments[v].radius2), 1e-9);
      EXPECT_GT(trace, 1 - 1e-9);  // a flat neighbourhood adds to it
      EXPECT_LT((moments[v].centre + moments[v].offset - limb.vertices.row(static_cast<int>(v)).transpose()).norm(),
                1e-14);
    }
  }
}

// The cotangent of each corner by the law of cosines and Heron's area; weights clamped per edge.
Eigen::MatrixXd dense_laplacian(const Positions& p, const Triangles& triangles) {
  Eigen::MatrixXd edges = Eigen::MatrixXd::Zero(p.rows(), p.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto i = triangles(t, k), j = triangles(t, (k + 1) % 3), corner = triangles(t, (k + 2) % 3);
      const double c = (p.row(i) - p.row(j)).norm(), a = (p.row(i) - p.row(corner)).norm(),
                   b = (p.row(j) - p.row(corner)).norm(), s = 0.5 * (a + b + c);
      const double area = std::sqrt(s * (s - a) * (s - b) * (s - c));
      const double half_cotangent = (a * a + b * b - c * c) / (8 * area);
      edges(i, j) += half_cotangent;
      edges(j, i) += half_cotangent;
    }
  }
  edges = edges.cwiseMax(0);
  return Eigen::MatrixXd(edges.rowwise().sum().asDiagonal()) - edges;
}

Eigen::VectorXd dense_areas(const Positions& p, const Triangles& triangles) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(p.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = p.row(triangles(t, 0)), b = p.row(triangles(t, 1)), c = p.row(triangles(t, 2));
    for (int k = 0; k < 3; ++k) areas[triangles(t, k)] += (b - a).cross(c - a).norm() / 6;
  }
  return areas.cwiseMax(1e-3 * areas.mean());
}

// Le & Lewis 2019, equations of v0, with 4 x 4 moments around the origin.
Eigen::RowVector3d textbook_position(const Eigen::MatrixXd& smoothing, const Character& limb,
                                     const std::vector<Rows>& skinning, Eigen::Index vertex) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (Eigen::Index k = 0; k < smoothing.cols(); ++k) {
    const Eigen::Vector4d u = limb.vertices.row(k).transpose().homogeneous();
    for (const JointWeight& w : limb.weights[static_cast<std::size_t>(k)]) {
      Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
      m.topRows<3>() = skinning[w.joint];
      sum += smoothing(vertex, k) * w.weight * m * u * u.transpose();
    }
  }
  const Eigen::Vector3d q = sum.topRightCorner<3, 1>(), p = sum.bottomLeftCorner<1, 3>();
  const Eigen::Matrix3d matrix = sum.topLeftCorner<3, 3>() - q * p.transpose();
  const Eigen::Matrix3d r = testing::nearest_rotation(matrix);
  return (r * limb.vertices.row(vertex).transpose() + q - r * p).transpose();
}

TEST(Ddm, MatchesADenseTextbookVersion) {
  const Character limb = limb_character();
  const DdmOptions options{.radius = 0.03, .steps = 4, .prune = 0};
  const Eigen::MatrixXd areas = dense_areas(limb.vertices, limb.triangles).asDiagonal();
  const double lambda = options.radius * options.radius / (2 * options.steps);
  const Eigen::MatrixXd step =
      testing::textbook_solve(areas + lambda * dense_laplacian(limb.vertices, limb.triangles), areas);
  const Eigen::MatrixXd twice = step * step, smoothing = twice * twice;
  EXPECT_LT((smoothing.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);

  const std::vector<Rows> skinning = {Rows::Identity(), rigid({1, 0.2, 0}, 1.2, {0.02, 0.28, 0.1}),
                                      rigid({0.1, 0.9, 0.3}, -0.8, {0.3, 0.1, 0.05})};
  const DdmTable table = pack_ddm(ddm_moments(limb.vertices, limb.triangles, limb.weights, options));
  const Positions found = packed_positions(table, limb.vertices.rows(), flatten(skinning));
  double worst = 0;
  for (Eigen::Index v = 0; v < limb.vertices.rows(); v += 3) {
    worst = std::max(worst, (found.row(v) - textbook_position(smoothing, limb, skinning, v)).norm());
  }
  RecordProperty("metres", std::to_string(worst * 1e6) + "e-6");
  EXPECT_LT(worst, 2e-5);  // what halves keep
}

TEST(Ddm, LooseAndFlatPartsStayPut) {
  // A vertex of no triangle, a triangle without area, and a flat square.
  Positions positions(9, 3);
  positions << 0, 0, 1, 1, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4, 0, 0, 3, 1, 0, 4, 1, 0, 5, 5, 5;
  positions *= 0.1;
  Triangles triangles(3, 3);
  triangles << 1, 2, 3, 4, 5, 6, 6, 5, 7;
  const SkinWeights weights(9, {{0, 0.75}, {1, 0.25}});
  const DdmTable table = pack_ddm(ddm_moments(positions, triangles, weights, {.radius = 0.05}));
  const Rows motion = rigid({0, 1, 1}, 0.7, {0.1, 0.2, 0.3});
  for (const Rows& m : {Rows(Rows::Identity()), motion}) {
    Positions expected = positions * m.leftCols<3>().transpose();
    expected.rowwise() += m.col(3).transpose();
    EXPECT_LT((packed_positions(table, 9, flatten({m, m})) - expected).cwiseAbs().maxCoeff(), 1e-6);
  }
  const Positions bent = packed_positions(table, 9, flatten({Rows::Identity(), motion}));
  EXPECT_TRUE(bent.allFinite());
}

TEST(Ddm, RefusesAVertexWithoutWeights) {
  Positions positions(4, 3);
  positions << 0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5;
  Triangles triangles(1, 3);
  triangles << 0, 1, 2;
  SkinWeights weights(4, {{0, 1.0}});
  weights[3].clear();
  EXPECT_THROW(ddm_moments(positions, triangles, weights, {}), Error);
}

TEST(Ddm, TheUnusedLanesOfABlockHoldZeros) {
  const Character limb = limb_character();
  const auto moments = ddm_moments(limb.vertices, limb.triangles, limb.weights, {});
  const DdmTable table = pack_ddm(moments);
  const std::size_t blocks = (moments.size() + kBlockSize - 1) / kBlockSize;
  ASSERT_EQ(table.block_begin.size(), blocks + 1);
  ASSERT_EQ(table.vertices.size(), blocks * kBlockSize);
  for (std::size_t block = 0; block < blocks; ++block) {
    for (std::uint32_t e = table.block_begin[block]; e < table.block_begin[block + 1]; ++e) {
      for (std::size_t lane = 0; lane < kBlockSize; ++lane) {
        const std::size_t v = block * kBlockSize + lane;
        bool uses = false;
        if (v < moments.size()) {
          for (const JointMoments& m : moments[v].joints) uses = uses || m.joint == table.block_joints[e];
        }
        const std::uint32_t omega = table.moments[(std::size_t{e} * kMomentWords + 6) * kBlockSize + lane];
        EXPECT_EQ(omega != 0, uses);
      }
    }
  }
}

}  // namespace
}  // namespace bodyopt::trainer
