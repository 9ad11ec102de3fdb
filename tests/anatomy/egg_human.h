// An egg with the joints of a human: its skin is its own mirror image to the last bit, and quickly looked into.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "assets/characters/character.h"

namespace bodyopt {

constexpr int kEggRings = 40, kEggSides = 48;

inline Skeleton egg_skeleton() {
  struct Place {
    const char* name;
    int parent;
    Vec3 at;
  };
  const Place places[] = {
      {"Hips", -1, {0, 0.95, 0}},
      {"LowerBack", 0, {0, 1.05, -0.02}},
      {"Spine", 1, {0, 1.15, -0.03}},
      {"Spine1", 2, {0, 1.3, -0.03}},
      {"Neck", 3, {0, 1.48, -0.02}},
      {"Head", 4, {0, 1.58, 0}},
      {"LeftUpLeg", 0, {0.09, 0.92, 0}},
      {"LeftLeg", 6, {0.1, 0.5, 0.01}},
      {"LeftFoot", 7, {0.05, 0.1, -0.01}},
      {"LeftShoulder", 3, {0.03, 1.42, 0.03}},
      {"LeftArm", 9, {0.17, 1.38, 0}},
      {"LeftForeArm", 10, {0.2, 1.15, 0}},
      {"LeftHand", 11, {0.2, 0.95, 0.05}},
      {"RightUpLeg", 0, {-0.09, 0.92, 0}},
      {"RightLeg", 13, {-0.1, 0.5, 0.01}},
      {"RightFoot", 14, {-0.05, 0.1, -0.01}},
      {"RightShoulder", 3, {-0.03, 1.42, 0.03}},
      {"RightArm", 16, {-0.17, 1.38, 0}},
      {"RightForeArm", 17, {-0.2, 1.15, 0}},
      {"RightHand", 18, {-0.2, 0.95, 0.05}},
  };
  Skeleton skeleton;
  for (const Place& place : places) {
    Joint joint;
    joint.name = place.name;
    joint.parent = place.parent;
    for (std::size_t k = 0; k < 3; ++k) {
      joint.bind.translation[k] = place.at[k] - (place.parent < 0 ? 0 : places[place.parent].at[k]);
      joint.inverse_bind.m[k][3] = -place.at[k];
    }
    joint.default_local = joint.bind;
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

// 1.75 m tall, 56 cm wide, 40 cm deep; every vertex hangs on the nearest joint.
inline Character egg_human() {
  Character egg;
  egg.name = "egg";
  egg.skeleton = egg_skeleton();
  const int poles = kEggRings * kEggSides;
  egg.vertices.resize(poles + 2, 3);
  for (int ring = 0; ring < kEggRings; ++ring) {
    const double turn = std::numbers::pi * (ring + 1) / (kEggRings + 1);
    for (int side = 0; side < kEggSides; ++side) {
      const int mirrored = std::min(side, kEggSides - side);  // the same numbers on both sides
      const double around = 2 * std::numbers::pi * mirrored / kEggSides;
      const double x = mirrored % (kEggSides / 2) == 0 ? 0 : 0.28 * std::sin(turn) * std::sin(around);
      egg.vertices.row(ring * kEggSides + side) << (side == mirrored ? x : -x), 0.875 * (1 - std::cos(turn)),
          (std::cos(around) > 0 ? 0.22 : 0.18) * std::sin(turn) * std::cos(around);
    }
  }
  egg.vertices.row(poles) << 0, 0, 0;
  egg.vertices.row(poles + 1) << 0, 1.75, 0;
  std::vector<std::array<int, 3>> triangles;
  for (int side = 0; side < kEggSides; ++side) {
    const int next = (side + 1) % kEggSides, top = (kEggRings - 1) * kEggSides;
    triangles.push_back({poles, next, side});
    triangles.push_back({poles + 1, top + side, top + next});
    for (int low = 0; low < top; low += kEggSides) {
      triangles.push_back({low + side, low + next, low + kEggSides + side});
      triangles.push_back({low + next, low + kEggSides + next, low + kEggSides + side});
    }
  }
  egg.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      egg.triangles(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(k)) =
          static_cast<std::uint32_t>(triangles[t][k]);
  }
  for (Eigen::Index v = 0; v < egg.vertices.rows(); ++v) {
    std::uint32_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < egg.skeleton.size(); ++j) {
      const Vec3 at = bind_place(egg.skeleton, j);
      const double apart = (egg.vertices.row(v).transpose() - Eigen::Vector3d(at[0], at[1], at[2])).norm();
      if (apart < least) nearest = static_cast<std::uint32_t>(j);
      least = std::min(least, apart);
    }
    egg.weights.push_back({{nearest, 1.0}});
    egg.output_vertex.push_back(static_cast<std::uint32_t>(v));
  }
  egg.output_triangles = egg.triangles;
  return egg;
}

}  // namespace bodyopt
