// The built-in character: skin, skeleton and weights.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <set>

#include "geometry/mend_surface.h"
#include "runtime/host/rig.h"
#include "tests/builtin/shared_arm.h"
#include "tests/support/paths.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Vector3d;

Vector3d corner(Eigen::Index triangle, int k) {
  const Character& c = arm().character;
  return c.vertices.row(c.triangles(triangle, k));
}

std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed_edges() {
  const Triangles& triangles = arm().character.triangles;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) ++edges[{triangles(t, k), triangles(t, (k + 1) % 3)}];
  }
  return edges;
}

TEST(ArmSkin, HasTheSizeThatWasAskedFor) {
  const Character& c = arm().character;
  EXPECT_GE(c.vertices.rows(), 6000);
  EXPECT_LE(c.vertices.rows(), 9000);
  EXPECT_GE(c.skeleton.size(), 8u);
  EXPECT_GE(arm().muscles.size(), 12u);
  EXPECT_EQ(c.output_vertex.size(), static_cast<std::size_t>(c.vertices.rows()));
  EXPECT_EQ(c.output_triangles, c.triangles);
  // A man of 1.8 m: the hanging hand reaches below the ribs, the neck's stub above the shoulder.
  const Vector3d low = c.vertices.colwise().minCoeff(), high = c.vertices.colwise().maxCoeff();
  EXPECT_NEAR(high.y(), 1.59, 0.03);
  EXPECT_NEAR(high.x() - low.x(), 0.75, 0.05);
}

TEST(ArmSkin, IsClosedManifoldAndOfGenusZero) {
  const auto edges = directed_edges();
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.count({edge.second, edge.first}));
  }
  const long vertices = arm().character.vertices.rows(), faces = arm().character.triangles.rows();
  EXPECT_EQ(vertices - static_cast<long>(edges.size() / 2) + faces, 2);
}

TEST(ArmSkin, HasOneFanOfTrianglesPerVertex) {
  // Closed edges alone allow two cones that touch in a point.
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> next;  // around each vertex
  const Triangles& triangles = arm().character.triangles;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) next[triangles(t, k)][triangles(t, (k + 1) % 3)] = triangles(t, (k + 2) % 3);
  }
  ASSERT_EQ(next.size(), static_cast<std::size_t>(arm().character.vertices.rows()));
  for (const auto& [vertex, ring] : next) {
    std::size_t steps = 0;
    std::uint32_t at = ring.begin()->first;
    do {
      at = ring.at(at);
      ++steps;
    } while (at != ring.begin()->first && steps <= ring.size());
    ASSERT_EQ(steps, ring.size()) << vertex;
  }
}

TEST(ArmSkin, FacesOutwards) {
  double volume = 0;
  for (Eigen::Index t = 0; t < arm().character.triangles.rows(); ++t) {
    volume += corner(t, 0).dot(corner(t, 1).cross(corner(t, 2))) / 6;
  }
  EXPECT_GT(volume, 0.015);  // cubic metres
  EXPECT_LT(volume, 0.025);
}

TEST(ArmSkin, HasWellShapedTriangles) {
  for (Eigen::Index t = 0; t < arm().character.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d u = corner(t, (k + 1) % 3) - corner(t, k), v = corner(t, (k + 2) % 3) - corner(t, k);
      const double angle = std::atan2(u.cross(v).norm(), u.dot(v)) * 180 / M_PI;
      ASSERT_GT(angle, 25) << "triangle " << t;
      ASSERT_LT(angle, 125) << "triangle " << t;
    }
  }
}

TEST(ArmSkin, IsThatOfTheFile) {
  const Character file = read_character(kSourceFolder + "/rigs/arm/arm.glb");
  EXPECT_EQ(file.vertices, arm().character.vertices);
  EXPECT_EQ(file.triangles, arm().character.triangles);
  EXPECT_EQ(skeleton_hash(file.skeleton), skeleton_hash(arm().character.skeleton));
  EXPECT_TRUE(file.notes.empty());
}

TEST(StockyArm, HasTheSkeletonOfTheArmInMoreFleshAndFewerTriangles) {
  const Character stocky = build_stocky_arm();
  EXPECT_EQ(skeleton_hash(stocky.skeleton), skeleton_hash(arm().character.skeleton));
  EXPECT_LT(stocky.triangles.rows(), arm().character.triangles.rows());
  const auto volume = [](const Character& c) { return enclosed_volume(c.vertices, c.triangles); };
  EXPECT_GT(volume(stocky), 1.02 * volume(arm().character));
}

TEST(ArmSkeleton, BindMatricesUndoTheBindPose) {
  const Skeleton& skeleton = arm().character.skeleton;
  std::set<std::string> names;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    EXPECT_LT(skeleton.joints[j].parent, static_cast<int>(j));
    names.insert(skeleton.joints[j].name);
  }
  EXPECT_EQ(names.size(), skeleton.size());
  const std::vector<Affine> skinning = skinning_matrices(skeleton, bind_pose(skeleton).joints);
  for (const Affine& m : skinning) {
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 4; ++k) EXPECT_NEAR(m.m[i][k], i == k ? 1 : 0, 1e-15);
    }
  }
}

TEST(ArmWeights, AreSortedAndSumToOne) {
  const Character& c = arm().character;
  ASSERT_EQ(c.weights.size(), static_cast<std::size_t>(c.vertices.rows()));
  std::set<std::uint32_t> used;
  for (const auto& weights : c.weights) {
    ASSERT_FALSE(weights.empty());
    ASSERT_LE(weights.size(), 6u);
    double sum = 0, last = 1;
    for (const JointWeight& w : weights) {
      ASSERT_LT(w.joint, c.skeleton.size());
      ASSERT_GT(w.weight, 0);
      ASSERT_LE(w.weight, last);
      last = w.weight;
      sum += w.weight;
      used.insert(w.joint);
    }
    ASSERT_NEAR(sum, 1, 1e-12);
  }
  EXPECT_EQ(used.size(), c.skeleton.size());
}

double weight_of(std::size_t vertex, const std::string& joint) {
  for (const JointWeight& w : arm().character.weights[vertex]) {
    if (arm().character.skeleton.joints[w.joint].name == joint) return w.weight;
  }
  return 0;
}

TEST(ArmWeights, ChangeLittleAlongAnEdge) {
  // A crack would be a jump between neighbours; the shortest border is at the fingers, about two edges wide.
  for (const auto& [edge, count] : directed_edges()) {
    for (const Joint& joint : arm().character.skeleton.joints) {
      ASSERT_LT(std::abs(weight_of(edge.first, joint.name) - weight_of(edge.second, joint.name)), 0.5);
    }
  }
}

TEST(ArmWeights, DoNotLeakThroughTheAir) {
  const Character& c = arm().character;
  const Affine elbow = posed_joints(c.skeleton, bind_pose(c.skeleton).joints)[c.skeleton.find("elbow")];
  for (std::size_t v = 0; v < c.weights.size(); ++v) {
    const Vector3d p = c.vertices.row(static_cast<Eigen::Index>(v));
    const bool far_down_the_arm = p.x() < elbow.m[0][3] + 0.08;
    const bool lower_ribs = p.x() > -0.2 && p.y() < 1.22;
    if (far_down_the_arm) {
      ASSERT_EQ(weight_of(v, "torso"), 0) << p.transpose();
    }
    if (lower_ribs) {
      ASSERT_LT(weight_of(v, "shoulder"), 0.02) << p.transpose();
      ASSERT_EQ(weight_of(v, "elbow"), 0) << p.transpose();
    }
  }
}

}  // namespace
}  // namespace bodyopt::trainer
