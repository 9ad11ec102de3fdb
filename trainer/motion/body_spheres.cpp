#include "trainer/motion/body_spheres.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/vertex_normals.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

using Eigen::RowVector3d;

constexpr double kLargestRadius = 0.25;  // metres
constexpr double kTolerance = 0.01;      // metres that flesh gives way
constexpr double kSpacing = 0.6;         // of a sphere's radius, to the next centre
constexpr std::size_t kMostPerJoint = 24;
constexpr Eigen::Index kTouchingVertices = 2500;  // spheres are tried at this many vertices of the skin

// The largest sphere inside the skin that touches it at this vertex.
BodySphere touching_sphere(const Character& character, const RowVector3d& at, const RowVector3d& normal,
                           std::uint32_t joint) {
  double radius = kLargestRadius;
  for (int round = 0; round < 30; ++round) {
    const RowVector3d centre = at - radius * normal;
    Eigen::Index nearest;
    const double distance =
        std::sqrt((character.vertices.rowwise() - centre).rowwise().squaredNorm().minCoeff(&nearest));
    if (distance > radius * (1 - 1e-3)) break;
    const RowVector3d chord = at - character.vertices.row(nearest);
    const double along = chord.dot(normal);
    if (!(along > 1e-9)) break;  // the nearest is the vertex itself, or level with it
    radius = std::min(0.999 * radius, chord.squaredNorm() / (2 * along));
  }
  const RowVector3d centre = at - radius * normal;
  return {joint, {centre(0), centre(1), centre(2)}, radius};
}

std::vector<BodySphere> well_spaced(std::vector<BodySphere> candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const BodySphere& a, const BodySphere& b) { return a.radius > b.radius; });
  std::vector<BodySphere> kept;
  for (const BodySphere& sphere : candidates) {
    if (kept.size() == kMostPerJoint) break;
    const bool near = std::any_of(kept.begin(), kept.end(), [&](const BodySphere& other) {
      return length(sphere.centre - other.centre) < kSpacing * other.radius;
    });
    if (!near) kept.push_back(sphere);
  }
  return kept;
}

// The nearest ancestor that has spheres, or -1.
int fleshy_ancestor(const Skeleton& skeleton, const std::vector<bool>& fleshy, std::uint32_t joint) {
  int up = skeleton.joints[joint].parent;
  while (up >= 0 && !fleshy[static_cast<std::size_t>(up)]) up = skeleton.joints[static_cast<std::size_t>(up)].parent;
  return up;
}

}  // namespace

std::vector<BodySphere> body_spheres(const Character& character) {
  const Positions normals = vertex_normals(character.vertices, character.triangles);
  const Eigen::Index count = character.vertices.rows(), stride = std::max<Eigen::Index>(1, count / kTouchingVertices);
  std::vector<BodySphere> touching(static_cast<std::size_t>((count + stride - 1) / stride));
  parallel_for(touching.size(), [&](std::size_t k) {
    const Eigen::Index v = static_cast<Eigen::Index>(k) * stride;
    const double size = normals.row(v).norm();
    if (!(size > 0)) return;  // in no triangle: a sphere of no radius, dropped below
    const std::uint32_t joint = character.weights[static_cast<std::size_t>(v)].front().joint;
    touching[k] = touching_sphere(character, character.vertices.row(v), normals.row(v) / size, joint);
  });

  std::vector<BodySphere> all;
  for (std::uint32_t joint = 0; joint < character.skeleton.size(); ++joint) {
    std::vector<BodySphere> own;
    for (const BodySphere& sphere : touching) {
      if (sphere.joint == joint && sphere.radius > 0) own.push_back(sphere);
    }
    const std::vector<BodySphere> kept = well_spaced(own);
    all.insert(all.end(), kept.begin(), kept.end());
  }
  return all;
}

SelfOverlap::SelfOverlap(const Character& character) : character_(character), spheres_(body_spheres(character)) {
  const Skeleton& skeleton = character.skeleton;
  std::vector<bool> fleshy(skeleton.size());
  for (const BodySphere& sphere : spheres_) fleshy[sphere.joint] = true;
  for (std::uint32_t a = 0; a < spheres_.size(); ++a) {
    for (std::uint32_t b = a + 1; b < spheres_.size(); ++b) {
      const std::uint32_t first = spheres_[a].joint, second = spheres_[b].joint;
      if (first == second || fleshy_ancestor(skeleton, fleshy, second) == static_cast<int>(first) ||
          fleshy_ancestor(skeleton, fleshy, first) == static_cast<int>(second)) {
        continue;
      }
      pairs_.push_back({a, b});
    }
  }
  trust(bind_pose(skeleton));
}

void SelfOverlap::trust(const Pose& pose) {
  const std::vector<Vec3> centres = posed_centres(pose);
  for (SpherePair& pair : pairs_) pair.trusted = std::max(pair.trusted, depth(pair, centres));
}

std::optional<std::pair<std::uint32_t, std::uint32_t>> SelfOverlap::find(const Pose& pose) const {
  const std::vector<Vec3> centres = posed_centres(pose);
  for (const SpherePair& pair : pairs_) {
    if (depth(pair, centres) > pair.trusted + kTolerance) {
      return std::make_pair(spheres_[pair.first].joint, spheres_[pair.second].joint);
    }
  }
  return std::nullopt;
}

std::vector<Vec3> SelfOverlap::posed_centres(const Pose& pose) const {
  const std::vector<Affine> skinning = skinning_matrices(character_.skeleton, pose.joints);
  return transformed(spheres_, [&](const BodySphere& sphere) { return skinning[sphere.joint] * sphere.centre; });
}

double SelfOverlap::depth(const SpherePair& pair, const std::vector<Vec3>& centres) const {
  return spheres_[pair.first].radius + spheres_[pair.second].radius -
         length(centres[pair.first] - centres[pair.second]);
}

}  // namespace bodyopt
