#include "trainer/builtin/arm.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/remesh.h"
#include "trainer/builtin/anatomy.h"
#include "trainer/builtin/arm_muscles.h"
#include "trainer/builtin/arm_skeleton.h"
#include "trainer/builtin/march.h"
#include "trainer/builtin/weights.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

constexpr double kGridStep = 0.006;    // metres
constexpr double kGridDepth = 0.0025;  // metres: opens the gaps between the fingers for the grid
constexpr int kRemeshRounds = 6;

constexpr double kStockyEdges = 1.3;   // of the edges: another topology
constexpr double kStockyGirth = 1.25;  // of the distance from the bone
constexpr double kArmRadius = 0.09;    // metres: what is further from the bone is not of the arm

Surface make_skin(double edges) {
  const Vector3d low(-0.80, 0.90, -0.20), high(0.08, 1.66, 0.30);
  const Solid body(body_parts(), low, high);
  return remesh(
      march(body, low, high, kGridStep, kGridDepth), [&](const Eigen::Vector3d& p) { return body.project(p); },
      [&](const Eigen::Vector3d& p) { return edges * edge_length(p); }, kRemeshRounds);
}

BuiltinArm arm_with(const Surface& skin) {
  BuiltinArm arm;
  Character& character = arm.character;
  character.name = "arm";
  character.skeleton = arm_skeleton();
  character.vertices.resize(static_cast<Eigen::Index>(skin.points.size()), 3);
  for (std::size_t v = 0; v < skin.points.size(); ++v) {
    character.vertices.row(static_cast<Eigen::Index>(v)) = skin.points[v];
    character.output_vertex.push_back(static_cast<std::uint32_t>(v));
  }
  character.triangles.resize(static_cast<Eigen::Index>(skin.triangles.size()), 3);
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      character.triangles(static_cast<Eigen::Index>(t), k) = static_cast<std::uint32_t>(skin.triangles[t][k]);
    }
  }
  character.output_triangles = character.triangles;

  character.weights = diffuse_weights(character.vertices, character.triangles, arm_joint_regions());
  arm.muscles = arm_muscles(character.skeleton);
  return arm;
}

// Where a point is thickened from, and how much of it: nothing at the ends of the segment.
struct Thickening {
  Vector3d axis;
  double share;
};
Thickening thickening(const SegmentFrame& segment, double length, const Vector3d& point) {
  const double u = std::clamp((point - segment.origin).dot(segment.along) / length, 0.0, 1.0);
  return {segment.at(u * length, 0, 0), std::sin(std::numbers::pi * u)};
}

}  // namespace

BuiltinArm build_arm() { return arm_with(make_skin(1)); }

BuiltinArm build_stocky_arm() {
  BuiltinArm arm = arm_with(make_skin(kStockyEdges));
  for (Eigen::Index v = 0; v < arm.character.vertices.rows(); ++v) {
    const Vector3d point = arm.character.vertices.row(v);
    Vector3d moved = point;
    for (const Thickening& t :
         {thickening(upper_arm_frame(), kUpperArmLength, point), thickening(forearm_frame(), kForearmLength, point)}) {
      // Of the chest, which is far from the bone, nothing.
      const double near = std::exp(-std::pow((point - t.axis).norm() / kArmRadius, 4));
      moved += (kStockyGirth - 1) * t.share * near * (point - t.axis);
    }
    arm.character.vertices.row(v) = moved;
  }
  return arm;
}

}  // namespace bodyopt
