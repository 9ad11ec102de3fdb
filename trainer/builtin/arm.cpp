#include "trainer/builtin/arm.h"

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

Surface make_skin() {
  const Vector3d low(-0.80, 0.90, -0.20), high(0.08, 1.66, 0.30);
  const Solid body(body_parts(), low, high);
  return remesh(
      march(body, low, high, kGridStep, kGridDepth), [&](const Eigen::Vector3d& p) { return body.project(p); },
      edge_length, kRemeshRounds);
}

}  // namespace

BuiltinArm build_arm() {
  const Surface skin = make_skin();

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

}  // namespace bodyopt
