#include "trainer/simulate/quasi_static.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "geometry/mend_surface.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "tests/simulate/limb.h"

namespace bodyopt::trainer {
namespace {

class QuasiStatic : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    limb_ = new Character(make_limb());
    body_ = new QuasiStaticBody(own_body(*limb_, {make_flexor()}, 0.05, kLimbAnatomy));
  }
  static void TearDownTestSuite() {
    delete body_;
    delete limb_;
  }
  static Positions skin(const SolvedPose& solved) { return solved.nodes.topRows(limb_->vertices.rows()); }

  static Character* limb_;
  static QuasiStaticBody* body_;
};
Character* QuasiStatic::limb_ = nullptr;
QuasiStaticBody* QuasiStatic::body_ = nullptr;

// Mean girth of the limb around the lower half of the flexor's belly, metres.
double girth(const Positions& skin) {
  double sum = 0;
  constexpr int kFirst = 5, kLast = 9;  // rings, x = 0.12 .. 0.21
  for (int ring = kFirst; ring <= kLast; ++ring) {
    for (int side = 0; side < kTubeSides; ++side) {
      sum += (skin.row(ring * kTubeSides + side) - skin.row(ring * kTubeSides + (side + 1) % kTubeSides)).norm();
    }
  }
  return sum / (kLast - kFirst + 1);
}

TEST_F(QuasiStatic, BindPoseIsTheRestSkin) {
  const SolvedPose solved = body_->solve(bind_pose(limb_->skeleton));
  EXPECT_TRUE(solved.status.converged);
  EXPECT_LT((skin(solved) - limb_->vertices).cwiseAbs().maxCoeff(), 1e-9);
}

// A path that calls at rest, or stays where it has arrived, ends as the straight one does.
TEST_F(QuasiStatic, PathsThatEndAlikeHaveTheSameShape) {
  const Pose rest = bind_pose(limb_->skeleton), pose = bent(*limb_, degrees(45));
  const SolvedPose straight = body_->solve(pose);
  for (const std::vector<Pose>& path : {std::vector{rest, pose}, {pose, pose}, {bent(*limb_, degrees(-30)), pose}}) {
    const SolvedPose along = body_->solve_along(path, {});
    EXPECT_TRUE(along.status.converged);
    EXPECT_LT((along.nodes - straight.nodes).rowwise().norm().maxCoeff(), 5e-5);
  }
  EXPECT_GT((body_->solve_along(std::vector{pose, rest}, {}).nodes - straight.nodes).cwiseAbs().maxCoeff(), 0.01);
}

TEST_F(QuasiStatic, ARootMotionMovesTheSolutionRigidly) {
  Pose pose = bent(*limb_, degrees(50));
  const SolvedPose at_bind = body_->solve(pose);
  pose.joints[0].rotation = axis_angle({0, 0.6, 0.8}, 2.5);
  pose.joints[0].translation = {100, -20, 7};
  const SolvedPose moved = body_->solve(pose);
  const Affine motion = affine_from(pose.joints[0]) * limb_->skeleton.joints[0].inverse_bind;
  double worst = 0;
  for (Eigen::Index n = 0; n < moved.nodes.rows(); ++n) {
    const Vec3 p = motion * Vec3{at_bind.nodes(n, 0), at_bind.nodes(n, 1), at_bind.nodes(n, 2)};
    worst = std::max(worst, (moved.nodes.row(n) - Eigen::RowVector3d(p[0], p[1], p[2])).norm());
  }
  EXPECT_LT(worst, 1e-12);
  EXPECT_EQ(moved.status.iterations, at_bind.status.iterations);
}

// A flexed muscle cannot shorten where no joint moves: it thickens at its lower half, pulled towards its middle.
TEST_F(QuasiStatic, AFlexedMuscleChangesTheShapeOfTheSamePose) {
  for (const double angle : {0.0, 60.0}) {
    const Pose pose = bent(*limb_, degrees(angle));
    const SolvedPose relaxed = body_->solve(pose), none = body_->solve(pose, std::vector<double>{0.0});
    EXPECT_EQ((relaxed.nodes - none.nodes).cwiseAbs().maxCoeff(), 0);
    const SolvedPose half = body_->solve(pose, std::vector<double>{0.5});
    const SolvedPose full = body_->solve(pose, std::vector<double>{1.0});
    EXPECT_TRUE(half.status.converged && full.status.converged);
    EXPECT_LT(std::abs(full.status.volume_change), 0.02);
    EXPECT_GT((skin(half) - skin(relaxed)).rowwise().norm().maxCoeff(), 1e-4) << angle;
    if (angle > 0) continue;  // shortened, it has bulged already: held by its tendons it does not shorten further
    EXPECT_GT(girth(skin(half)), girth(skin(relaxed)) + 1e-4);
    EXPECT_GT(girth(skin(full)), girth(skin(half)) + 1e-4);
  }
  EXPECT_THROW(body_->solve(bent(*limb_, 0), std::vector<double>{0.1, 0.2}), Error);
  EXPECT_THROW(body_->solve(bent(*limb_, 0), std::vector<double>{1.5}), Error);
  EXPECT_THROW(body_->solve(bent(*limb_, 0), std::vector<double>{std::nan("")}), Error);
}

TEST_F(QuasiStatic, AnElbowBendIsInEquilibrium) {
  const double rest_volume = enclosed_volume(limb_->vertices, limb_->triangles);
  for (const double angle : {60.0, 120.0, -100.0}) {
    const SolvedPose solved = body_->solve(bent(*limb_, degrees(angle)));
    EXPECT_TRUE(solved.status.converged) << angle;
    EXPECT_LT(solved.status.residual, 1e-4);
    EXPECT_EQ(solved.status.inverted_tets, 0);
    EXPECT_GT(solved.status.iterations, 0);
    EXPECT_NEAR(enclosed_volume(skin(solved), limb_->triangles) / rest_volume, 1, 0.03);
  }
}

// The residual it reports, put together again from the pieces.
TEST_F(QuasiStatic, TheReportedResidualIsTheForceLeftOver) {
  const Pose pose = bent(*limb_, degrees(70));
  const SolvedPose solved = body_->solve(pose);
  const std::vector<Affine> skinning = skinning_matrices(limb_->skeleton, pose.joints);
  const TetTissue& inside = body_->tissue();
  const Tissue tissue(body_->mesh(), tet_materials(inside.shares, {}), inside.fibres);
  const SkinBending bending(limb_->vertices, limb_->triangles, body_->mesh().nodes.rows());
  std::vector<Quat> rotation;
  for (Eigen::Index n = 0; n < body_->mesh().nodes.rows(); ++n) {
    rotation.push_back(axis_angle({0, 0, 1}, 0));
    Quat& q = rotation.back();
    const Quat lower = axis_angle({0, 0, 1}, degrees(70));
    Quat sum{0, 0, 0, 0};
    for (std::size_t i = 0; i < 4; ++i) {
      double w[2] = {body_->weights()(n, 0), body_->weights()(n, 1)};
      for (double& value : w) value = value < 1e-3 ? 0 : value;
      sum[i] = (w[0] * q[i] + w[1] * lower[i]) / (w[0] + w[1]);
    }
    q = normalized(sum);
  }
  Positions gradient = Positions::Zero(solved.nodes.rows(), 3);
  const TissueSum sum = tissue.add_gradient(
      solved.nodes,
      fibre_drives({make_flexor()}, AnatomyField(*limb_, {make_flexor()}, kLimbAnatomy).belly_lengths(), skinning, 0.7),
      gradient);
  body_->springs().add_gradient(body_->springs().pose(skinning), solved.nodes, gradient);
  bending.add_gradient(bending.curvature(rotation), solved.nodes, gradient);
  MuscleVolume(body_->mesh(), inside.fibres, 1).add_gradient(solved.nodes, gradient);
  EXPECT_NEAR(gradient.norm() / std::sqrt(sum.force_square), solved.status.residual, 0.01 * solved.status.residual);
}

TEST_F(QuasiStatic, EndsMoveWithTheirBones) {
  const QuasiStaticBody passive = own_body(*limb_, {}, 0.05, kLimbAnatomy);
  const Pose pose = bent(*limb_, degrees(90));
  const SolvedPose solved = passive.solve(pose);
  EXPECT_TRUE(solved.status.converged);
  const std::vector<Affine> skinning = skinning_matrices(limb_->skeleton, pose.joints);
  for (Eigen::Index v = 0; v < limb_->vertices.rows(); ++v) {
    const Eigen::RowVector3d rest = limb_->vertices.row(v);
    if (rest[0] > 0.15 && rest[0] < 0.41) continue;
    const double most = rest[0] > 0.07 && rest[0] < 0.25 ? 0.007 : 0.002;  // towards the elbow flesh is pulled along
    const Vec3 p = skinning[rest[0] < 0.25 ? 0 : 1] * Vec3{rest[0], rest[1], rest[2]};
    EXPECT_LT((solved.nodes.row(v) - Eigen::RowVector3d(p[0], p[1], p[2])).norm(), most) << rest;
  }
  double off = 0, volume = 0;
  for (const BonePart& part : passive.tissue().bones) {
    const Eigen::Vector4d weights = part.moments.rowwise().sum() / part.volume();
    const Eigen::Vector3d rest = rest_position(passive.mesh(), {part.tet, weights});
    if (std::abs(rest[0] - 0.25) < 0.06) continue;  // the ends of both bones, which meet when it bends
    Eigen::Vector3d now = Eigen::Vector3d::Zero();
    for (int a = 0; a < 4; ++a) now += weights[a] * solved.nodes.row(passive.mesh().tets(part.tet, a)).transpose();
    const Vec3 p = skinning[static_cast<std::size_t>(part.joint)] * Vec3{rest[0], rest[1], rest[2]};
    off += part.volume() * (now - Eigen::Vector3d(p[0], p[1], p[2])).norm();
    volume += part.volume();
  }
  EXPECT_LT(off / volume, 0.001);
}

TEST_F(QuasiStatic, AFlexedMuscleBulges) {
  const QuasiStaticBody passive = own_body(*limb_, {}, 0.05, kLimbAnatomy);
  const Pose pose = bent(*limb_, degrees(60));
  const double rest = girth(limb_->vertices);
  const double relaxed = girth(skin(passive.solve(pose)));
  EXPECT_GT(girth(skin(body_->solve(pose))), 1.003 * relaxed);
  EXPECT_NEAR(relaxed, rest, 0.012 * rest);
}

TEST_F(QuasiStatic, IsAFunctionOfThePoseAlone) {
  const Pose a = bent(*limb_, degrees(140)), b = bent(*limb_, degrees(-40));
  const SolvedPose folded = body_->solve(a);
  EXPECT_GT(folded.status.contact_depth, 0);
  const Positions first = folded.nodes;
  const Positions other = body_->solve(b).nodes;
  EXPECT_EQ(body_->solve(a).nodes, first);
  EXPECT_NE(other, first);
}

// Puts a tet of this edge, metres, where an inner node was. The tets around the node keep that corner of it which lies
// their way, and flat tets fill the gaps between those that keep different ones. Returns false, and leaves the mesh as
// it is, where this does not fill the same space again.
bool open_node(TetMesh& mesh, int node, double edge) {
  Eigen::Matrix<double, 4, 3> corners;
  corners << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
  const int count = static_cast<int>(mesh.nodes.rows());
  const Eigen::RowVector3d centre = mesh.nodes.row(node);
  std::vector<std::array<int, 4>> tets;
  std::map<std::set<int>, std::set<int>> kept;  // of every face, edge and node around, and of none: corners beside it
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const std::array<int, 4> tet{mesh.tets(t, 0), mesh.tets(t, 1), mesh.tets(t, 2), mesh.tets(t, 3)};
    if (std::find(tet.begin(), tet.end(), node) == tet.end()) {
      tets.push_back(tet);
      continue;
    }
    const Eigen::RowVector3d way = mesh.nodes(tet, Eigen::all).colwise().mean() - centre;
    Eigen::Index corner = 0;
    (corners * way.transpose()).maxCoeff(&corner);
    for (int subset = 0; subset < 16; ++subset) {
      std::set<int> part;
      for (int a = 0; a < 4; ++a) {
        if ((subset >> a & 1) != 0) part.insert(tet[static_cast<std::size_t>(a)]);
      }
      if (!part.contains(node)) kept[part].insert(corner == 0 ? node : count + static_cast<int>(corner) - 1);
    }
  }
  for (const auto& [part, nodes] : kept) {
    if (part.size() + nodes.size() > 4) return false;
    if (part.size() + nodes.size() < 4) continue;
    std::copy(part.begin(), part.end(), std::copy(nodes.begin(), nodes.end(), tets.emplace_back().begin()));
  }
  TetMesh opened;
  opened.nodes.resize(count + 3, 3);
  opened.nodes << mesh.nodes, (edge / std::sqrt(8.0) * corners.bottomRows(3)).rowwise() + centre;
  opened.nodes.row(node) += edge / std::sqrt(8.0) * corners.row(0);
  opened.tets = Eigen::Map<const Tets>(tets.front().data(), static_cast<Eigen::Index>(tets.size()), 4);
  orient(opened);
  const auto volume = [](const TetMesh& of) {
    double sum = 0;
    for (Eigen::Index t = 0; t < of.tets.rows(); ++t) sum += tet_edges(of, t).determinant() / 6;
    return sum;
  };
  if (std::abs(volume(opened) / volume(mesh) - 1) > 1e-9) return false;
  mesh = opened;
  return true;
}

// Tiny tets among large ones, in a limb squeezed along its length: the large ones would press some of them inside out
// and be in equilibrium all the same.
TEST_F(QuasiStatic, TinyTetsEndUpright) {
  Cage cage = own_cage(limb_->vertices, limb_->triangles, limb_->weights, 0.05);
  TetMesh& mesh = cage.mesh;
  const int skin = static_cast<int>(limb_->vertices.rows()), count = static_cast<int>(mesh.nodes.rows());
  int opened = 0;
  for (int node = skin; node < count; ++node) opened += open_node(mesh, node, 2e-4) ? 1 : 0;
  ASSERT_GT(opened, 0);
  cage.skin = own_nodes(mesh, skin);
  const QuasiStaticBody body(*limb_, {}, AnatomyField(*limb_, {}, kLimbAnatomy), cage);
  for (const double shorter : {0.1, 0.11, 0.12}) {
    Pose pose = bind_pose(limb_->skeleton);
    pose.joints[1].translation[0] -= shorter;
    const SolvedPose solved = body.solve(pose);
    EXPECT_TRUE(solved.status.converged) << shorter;
    EXPECT_EQ(solved.status.inverted_tets, 0) << shorter;
  }
}

TEST_F(QuasiStatic, HashTellsInputsApart) {
  EXPECT_EQ(own_body(*limb_, {make_flexor()}, 0.05, kLimbAnatomy).hash(), body_->hash());
  Muscle stronger = make_flexor();
  stronger.radius += 1e-6;
  EXPECT_NE(own_body(*limb_, {stronger}, 0.05, kLimbAnatomy).hash(), body_->hash());
  EXPECT_NE(own_body(*limb_, {}, 0.05, kLimbAnatomy).hash(), body_->hash());
}

TEST_F(QuasiStatic, RefusesWhatDoesNotBelongTogether) {
  EXPECT_THROW(body_->solve(Pose{}), Error);
  Muscle stray = make_flexor();
  stray.path[1].joint = 9;
  EXPECT_THROW(own_body(*limb_, {stray}, 0.05, kLimbAnatomy), Error);
  Muscle short_path = make_flexor();
  short_path.path.resize(1);
  EXPECT_THROW(own_body(*limb_, {short_path}, 0.05, kLimbAnatomy), Error);
  Character boneless = *limb_;
  boneless.skeleton.joints.clear();
  EXPECT_THROW(own_body(boneless, {}, 0.05, kLimbAnatomy), Error);
}

}  // namespace
}  // namespace bodyopt::trainer
