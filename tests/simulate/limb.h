// A small limb for tests: a closed tube along x with an elbow in the middle.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "assets/clips/clip.h"
#include "trainer/anatomy/field.h"
#include "trainer/simulate/quasi_static.h"

namespace bodyopt {

constexpr double kTubeLength = 0.5, kTubeRadius = 0.04;     // metres
const trainer::AnatomyOptions kLimbAnatomy{.cell = 0.004};  // coarse: its fine points are tested elsewhere
constexpr int kTubeSides = 10, kTubeRings = 23;

// Rings of vertices and a tip at each end; triangles wind outwards.
inline Character make_limb() {
  Character limb;
  limb.name = "limb";
  const int ring_vertices = kTubeSides * kTubeRings;
  limb.vertices.resize(ring_vertices + 2, 3);
  for (int r = 0; r < kTubeRings; ++r) {
    const double x = kTubeLength * (r + 0.5) / kTubeRings;
    const double inset = std::max(1 - std::min(x, kTubeLength - x) / kTubeRadius, 0.0);
    const double radius = kTubeRadius * std::sqrt(1 - inset * inset);
    for (int s = 0; s < kTubeSides; ++s) {
      const double angle = 2 * std::numbers::pi * (s + 0.5 * (r % 2)) / kTubeSides;
      limb.vertices.row(r * kTubeSides + s) << x, radius * std::cos(angle), radius * std::sin(angle);
    }
  }
  limb.vertices.row(ring_vertices) << 0, 0, 0;
  limb.vertices.row(ring_vertices + 1) << kTubeLength, 0, 0;

  std::vector<std::array<int, 3>> triangles;
  for (int s = 0; s < kTubeSides; ++s) {
    const int next = (s + 1) % kTubeSides, last = (kTubeRings - 1) * kTubeSides;
    triangles.push_back({ring_vertices, next, s});
    triangles.push_back({ring_vertices + 1, last + s, last + next});
    for (int r = 0; r + 1 < kTubeRings; ++r) {
      const int a = r * kTubeSides + s, b = r * kTubeSides + next, c = a + kTubeSides, d = b + kTubeSides;
      if (r % 2 == 0) {
        triangles.push_back({a, b, c});
        triangles.push_back({b, d, c});
      } else {
        triangles.push_back({a, b, d});
        triangles.push_back({a, d, c});
      }
    }
  }
  limb.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      limb.triangles(static_cast<Eigen::Index>(t), k) =
          static_cast<std::uint32_t>(triangles[t][static_cast<std::size_t>(k)]);
    }
  }

  const double heads[2] = {0.02, kTubeLength / 2};
  for (int j = 0; j < 2; ++j) {
    Joint joint;
    joint.name = j == 0 ? "upper" : "lower";
    joint.parent = j - 1;
    joint.bind.translation = {j == 0 ? heads[0] : heads[1] - heads[0], 0, 0};
    joint.inverse_bind.m[0][3] = -heads[j];
    joint.default_local = joint.bind;
    limb.skeleton.joints.push_back(joint);
  }
  for (Eigen::Index v = 0; v < limb.vertices.rows(); ++v) {
    const double u = std::clamp((limb.vertices(v, 0) - heads[1]) / 0.08 + 0.5, 0.0, 1.0);
    const double lower = u * u * (3 - 2 * u);
    std::vector<JointWeight> weights{{0, 1 - lower}, {1, lower}};
    if (lower > 0.5) std::swap(weights[0], weights[1]);
    limb.weights.push_back(weights);
    limb.output_vertex.push_back(static_cast<std::uint32_t>(v));
  }
  limb.output_triangles = limb.triangles;
  return limb;
}

// The flexor on the side the elbow bends to (+y).
inline Muscle make_flexor() {
  Muscle muscle;
  muscle.name = "flexor";
  muscle.radius = 0.018;
  muscle.path = {{0, {0.03, 0.018, 0}}, {0, {0.2, 0.018, 0}}, {1, {0.29, 0.018, 0}}};
  return muscle;
}

// The elbow bent by an angle (radians) towards +y, and the root left at bind.
inline Pose bent(const Character& limb, double angle) {
  Pose pose = bind_pose(limb.skeleton);
  pose.joints[1].rotation = axis_angle({0, 0, 1}, angle);
  return pose;
}

inline double degrees(double angle) { return angle * std::numbers::pi / 180; }

// The limb, and the same moved along y by `apart`, metres. Both hang on the same joints.
inline Character make_two_limbs(double apart) {
  Character both = make_limb();
  const Eigen::Index count = both.vertices.rows(), triangles = both.triangles.rows();
  both.vertices.conservativeResize(2 * count, 3);
  both.vertices.bottomRows(count) = both.vertices.topRows(count).rowwise() + Eigen::RowVector3d(0, apart, 0);
  both.triangles.conservativeResize(2 * triangles, 3);
  both.triangles.bottomRows(triangles) =
      (both.triangles.topRows(triangles).array() + static_cast<std::uint32_t>(count)).matrix();
  const std::vector<std::vector<JointWeight>> weights = both.weights;
  both.weights.insert(both.weights.end(), weights.begin(), weights.end());
  return both;
}

// A body of linear tets that fill its own skin. size: largest edge inside, metres; 0: from the skin.
inline trainer::QuasiStaticBody own_body(const Character& character, const std::vector<Muscle>& muscles, double size,
                                         const trainer::AnatomyOptions& anatomy = {}) {
  return {character, muscles, trainer::AnatomyField(character, muscles, anatomy),
          trainer::own_cage(character.vertices, character.triangles, character.weights, size)};
}

}  // namespace bodyopt
