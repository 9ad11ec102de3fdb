// What rides on a skin goes where the skin goes.
#include "runtime/deformer/following_meshes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "geometry/nearest_skin.h"
#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/rig.h"
#include "tests/support/attached_limb.h"
#include "tests/support/textbook_ddm.h"

namespace bodyopt::trainer {
namespace {

using Carried = std::vector<std::vector<float>>;
enum Part : std::size_t { kEye, kButton, kSleeve, kBlade };

const Attachments& outfit() {
  static const Attachments attachments = limb_outfit();
  return attachments;
}

std::vector<float> skin_at(const Pose& pose) {
  static Deformer deformer(limb_basis(), {.name = "cpu"});
  return deformer.evaluate({&pose, 1}).positions;
}

Carried carried_at(const Pose& pose) {
  return FollowingMeshes(limb_basis(), outfit()).carry(skin_at(pose), pose.joints);
}

Pose bent() { return limb_pose(limb_basis().skeleton, 1.2, 0.5, 0.6); }

Eigen::Vector3d point(std::span<const float> values, std::size_t v) {
  return Eigen::Vector3f(values[3 * v], values[3 * v + 1], values[3 * v + 2]).cast<double>();
}

Eigen::Affine3d eigen(const Affine& a) {
  Eigen::Affine3d result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) result(i, j) = a.m[i][j];
  }
  return result;
}

TEST(FollowingMeshes, RestIsExact) {
  const Basis& basis = limb_basis();
  std::vector<float> rest;
  for (const std::uint32_t v : basis.mesh.output_vertex) {
    rest.insert(rest.end(), {basis.mesh.rest[3 * v], basis.mesh.rest[3 * v + 1], basis.mesh.rest[3 * v + 2]});
  }
  const Carried carried = FollowingMeshes(basis, outfit()).carry(rest, bind_pose(basis.skeleton).joints);
  ASSERT_EQ(carried.size(), 4u);
  for (std::size_t m = 0; m < carried.size(); ++m) {
    const AttachedMesh& mesh = outfit().meshes[m];
    ASSERT_EQ(carried[m].size(), mesh.rest.size());
    for (std::size_t k = 0; k < mesh.rest.size(); ++k) EXPECT_NEAR(carried[m][k], mesh.rest[k], 2e-7) << mesh.name;
  }
}

TEST(FollowingMeshes, TurnsAndMovesWithTheWhole) {
  Pose pose = bind_pose(limb_basis().skeleton);
  pose.joints[0].rotation = normalized(Quat{0.9, -0.3, 0.5, -0.1});  // more than half a turn from where it was
  pose.joints[0].translation = {1.5, -0.5, 2};
  const Eigen::Affine3d motion = eigen(affine_from(pose.joints[0]));
  const Carried carried = carried_at(pose);
  for (std::size_t m = 0; m < carried.size(); ++m) {
    const AttachedMesh& mesh = outfit().meshes[m];
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      EXPECT_LT((point(carried[m], v) - motion * point(mesh.rest, v)).norm(), 2e-6) << mesh.name << " " << v;
    }
  }
}

// The same in double precision by another way: the triangles around each corner found by looking at all of them, the
// rotation by a singular value decomposition.
TEST(FollowingMeshes, AgreesWithADoublePrecisionReference) {
  const Basis& basis = limb_basis();
  const Pose pose = bent();
  const std::vector<float> skin = skin_at(pose);  // the limb's output order is its welded order
  std::vector<Eigen::Vector3d> rest(basis.mesh.vertex_count()), posed(rest.size());
  for (std::size_t o = 0; o < basis.mesh.output_count(); ++o) {
    rest[basis.mesh.output_vertex[o]] = point(basis.mesh.rest, basis.mesh.output_vertex[o]);
    posed[basis.mesh.output_vertex[o]] = point(skin, o);
  }
  const auto motion_at = [&](std::uint32_t vertex) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(), rest_normal = normal;
    int edges = 0;
    for (std::size_t t = 0; t < basis.mesh.triangles.size(); t += 3) {
      const std::uint32_t* c = basis.mesh.triangles.data() + t;
      if (c[0] != vertex && c[1] != vertex && c[2] != vertex) continue;
      normal += (posed[c[1]] - posed[c[0]]).cross(posed[c[2]] - posed[c[0]]);
      rest_normal += (rest[c[1]] - rest[c[0]]).cross(rest[c[2]] - rest[c[0]]);
      for (int k = 0; k < 3; ++k) {
        if (c[k] == vertex) continue;
        const Eigen::Vector3d edge = rest[c[k]] - rest[vertex];
        sum += (posed[c[k]] - posed[vertex]) * edge.transpose() / edge.squaredNorm();
        ++edges;
      }
    }
    return Eigen::Matrix3d((sum + 0.5 * edges * normal.normalized() * rest_normal.normalized().transpose()) / edges);
  };
  const Carried carried = FollowingMeshes(basis, outfit()).carry(skin, pose.joints);
  double furthest = 0;
  for (const Part part : {kButton, kSleeve}) {
    const AttachedMesh& mesh = outfit().meshes[part];
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      const std::uint32_t anchor = mesh.vertex_anchor[v];
      Eigen::Matrix3d motion = Eigen::Matrix3d::Zero();
      Eigen::Vector3d centre = Eigen::Vector3d::Zero(), rest_centre = centre;
      const double count = mesh.point_begin[anchor + 1] - mesh.point_begin[anchor];
      for (std::uint32_t p = mesh.point_begin[anchor]; p < mesh.point_begin[anchor + 1]; ++p) {
        const SurfacePoint& s = mesh.points[p];
        for (const auto& [corner, weight] : {std::pair{s.a, s.wa}, {s.b, s.wb}, {s.c, s.wc}}) {
          const double share = static_cast<double>(weight) / count;
          motion += share * motion_at(corner);
          centre += share * posed[corner];
          rest_centre += share * rest[corner];
        }
      }
      ASSERT_GT(motion.determinant(), 0);
      const Eigen::Matrix3d turn = testing::nearest_rotation(motion);
      const Eigen::Vector3d expected = centre + turn * (point(mesh.rest, v) - rest_centre);
      EXPECT_LT((point(carried[part], v) - expected).norm(), 1e-6) << mesh.name << " " << v;
      furthest = std::max(furthest, (expected - point(mesh.rest, v)).norm());
    }
  }
  EXPECT_GT(furthest, 0.05);  // the pose does move them
}

TEST(FollowingMeshes, FarAwayIsAsNear) {
  Pose pose = bent();
  const Carried near = carried_at(pose);
  pose.joints[0].translation[0] += 100;
  const Carried far = carried_at(pose);
  for (std::size_t m = 0; m < near.size(); ++m) {
    for (std::size_t k = 0; k < near[m].size(); ++k) {
      EXPECT_NEAR(far[m][k], near[m][k] + (k % 3 == 0 ? 100.0f : 0.0f), 2e-5) << m << ", " << k;
    }
  }
}

TEST(FollowingMeshes, OnAJointIsItsSkinningMatrix) {
  const Pose pose = bent();
  const std::vector<Affine> skinning = skinning_matrices(limb_basis().skeleton, pose.joints);
  const Carried carried = carried_at(pose);
  const std::pair<Part, std::size_t> fixed[] = {{kEye, 0}, {kBlade, 2}};
  for (const auto& [part, joint] : fixed) {
    const AttachedMesh& mesh = outfit().meshes[part];
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      EXPECT_LT((point(carried[part], v) - eigen(skinning[joint]) * point(mesh.rest, v)).norm(), 1e-7) << mesh.name;
    }
  }
}

TEST(FollowingMeshes, PiecesStayRigid) {
  const Carried carried = carried_at(bent());
  for (const Part part : {kEye, kButton, kBlade}) {
    const AttachedMesh& mesh = outfit().meshes[part];
    for (std::size_t v = 1; v < mesh.vertex_count(); ++v) {
      for (std::size_t u = 0; u < v; ++u) {
        const double before = (point(mesh.rest, u) - point(mesh.rest, v)).norm();
        const double after = (point(carried[part], u) - point(carried[part], v)).norm();
        EXPECT_NEAR(after, before, 1e-5 * before + 1e-7) << mesh.name;
      }
    }
  }
}

// No vertex of the sleeve comes further from its point of the skin than it was, and none of the skin's comes through.
TEST(FollowingMeshes, ASheetKeepsItsDistance) {
  const Basis& basis = limb_basis();
  const Pose pose = limb_pose(basis.skeleton, 0.7, 0.3, 0.3);
  const std::vector<float> skin = skin_at(pose);
  Positions posed(basis.mesh.output_count(), 3);
  for (Eigen::Index v = 0; v < posed.rows(); ++v) posed.row(v) = point(skin, static_cast<std::size_t>(v)).transpose();
  const Character limb = limb_character();
  const NearestSkin before(limb.vertices, limb.triangles), after(posed, limb.triangles);
  const std::vector<float> sheet = FollowingMeshes(basis, outfit()).carry(skin, pose.joints)[kSleeve];
  const AttachedMesh& mesh = outfit().meshes[kSleeve];
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const Eigen::Vector3d u = point(mesh.rest, v), x = point(sheet, v);
    const double off = (before(u).position - u).norm(), now = (after(x).position - x).norm();
    EXPECT_LE(now, off + 1e-6) << v;
    EXPECT_GE(now, 0.75 * off) << v;  // less only where skin folds towards it
  }
}

TEST(FollowingMeshes, CollapsedSkinTurnsWithTheJoint) {
  const Basis& basis = limb_basis();
  const Pose pose = bent();
  const std::vector<float> nothing(3 * basis.mesh.output_count(), 0.25f);
  const Carried carried = FollowingMeshes(basis, outfit()).carry(nothing, pose.joints);
  const AttachedMesh& button = outfit().meshes[kButton];
  const AttachmentAnchor& anchor = button.anchors[0];
  const Affine joint = skinning_matrices(basis.skeleton, pose.joints)[anchor.joint];
  const Eigen::Vector3d centre(static_cast<double>(anchor.x), static_cast<double>(anchor.y),
                               static_cast<double>(anchor.z));
  for (std::size_t v = 0; v < button.vertex_count(); ++v) {
    const Eigen::Vector3d expected =
        Eigen::Vector3d::Constant(0.25) + eigen(joint).linear() * (point(button.rest, v) - centre);
    EXPECT_LT((point(carried[kButton], v) - expected).norm(), 1e-6);
  }
  for (const float x : carried[kSleeve]) EXPECT_TRUE(std::isfinite(x));
}

TEST(FollowingMeshes, AnotherSkinIsRefused) {
  const FollowingMeshes carrier(limb_basis(), outfit());
  const Pose pose = bent();
  std::vector<float> skin = skin_at(pose);
  EXPECT_THROW(carrier.carry(skin, std::span(pose.joints).first(2)), Error);
  skin.resize(skin.size() - 3);
  EXPECT_THROW(carrier.carry(skin, pose.joints), Error);
}

}  // namespace
}  // namespace bodyopt::trainer
