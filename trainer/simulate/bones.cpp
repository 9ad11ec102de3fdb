#include "trainer/simulate/bones.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "geometry/extent.h"
#include "geometry/nearest_skin.h"
#include "geometry/thickness.h"

namespace bodyopt {
namespace {

constexpr double kThickness = 0.35;  // capsule radius over the distance from its axis to the skin
constexpr double kClearance = 0.6;   // length of the thinning at a hinge over the hinge's distance to the skin
constexpr double kCapsuleWeight = 0.5;
constexpr double kCoreWeight = 0.9;
constexpr double kCoreDepth = 0.65;
constexpr double kTrunkDepth = 0.3;  // the same for a root, which is a trunk with ribs or a pelvis close to the skin
constexpr double kEndShare = 0.85;   // how far a last segment runs into the skin it carries
constexpr double kDigit = 0.01;      // a part with a smaller radius, over the body's extent, is a finger or toe
constexpr int kAxisSamples = 16;
constexpr int kLattice = 3;  // sample points per tet: 20

struct Capsule {
  Eigen::Vector3d head, tail;
  std::array<double, kAxisSamples + 1> radius;
};

double skin_distance(const Positions& skin, const Eigen::Vector3d& point) {
  return std::sqrt((skin.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff());
}

double smoothstep(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

Capsule make_capsule(const Positions& skin, const Eigen::Vector3d& head, const Eigen::Vector3d& tail, bool head_hinge,
                     bool tail_hinge) {
  Capsule capsule{head, tail, {}};
  const double length = (tail - head).norm();
  const double head_clear = std::min(kClearance * skin_distance(skin, head), 0.4 * length);
  const double tail_clear = std::min(kClearance * skin_distance(skin, tail), 0.4 * length);
  for (int k = 0; k <= kAxisSamples; ++k) {
    const double u = static_cast<double>(k) / kAxisSamples;
    double radius = kThickness * skin_distance(skin, head + u * (tail - head));
    if (head_hinge) radius *= smoothstep(u * length / head_clear);
    if (tail_hinge) radius *= smoothstep((1 - u) * length / tail_clear);
    capsule.radius[static_cast<std::size_t>(k)] = radius;
  }
  return capsule;
}

bool inside(const Capsule& capsule, const Eigen::Vector3d& point) {
  const Eigen::Vector3d axis = capsule.tail - capsule.head;
  const double u = std::clamp((point - capsule.head).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  const double at = u * kAxisSamples;
  const std::size_t k = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(kAxisSamples - 1));
  const double radius = std::lerp(capsule.radius[k], capsule.radius[k + 1], at - static_cast<double>(k));
  return (capsule.head + u * axis - point).squaredNorm() < radius * radius;
}

// The end of a joint without children: along the mean of the skin it carries.
Eigen::Vector3d end_position(const Character& character, std::uint32_t joint, const Eigen::Vector3d& head) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0;
  for (std::size_t v = 0; v < character.weights.size(); ++v) {
    for (const JointWeight& w : character.weights[v]) {
      if (w.joint != joint) continue;
      sum += w.weight * character.vertices.row(static_cast<Eigen::Index>(v)).transpose();
      total += w.weight;
    }
  }
  if (!(total > 0)) return head;
  const Eigen::Vector3d axis = (sum / total - head).normalized();
  double reach = 0;
  for (std::size_t v = 0; v < character.weights.size(); ++v) {
    if (character.weights[v].empty() || character.weights[v].front().joint != joint) continue;
    reach = std::max(reach, (character.vertices.row(static_cast<Eigen::Index>(v)).transpose() - head).dot(axis));
  }
  return head + kEndShare * reach * axis;
}

std::vector<std::vector<Capsule>> make_capsules(const Character& character) {
  const std::vector<Joint>& joints = character.skeleton.joints;
  const double shortest = 1e-4;  // metres: joints in one place have no bone between them
  std::vector<std::vector<Capsule>> capsules(joints.size());
  std::vector<bool> has_child(joints.size(), false);
  const auto place = [&](std::size_t joint) { return Eigen::Vector3d(bind_place(character.skeleton, joint).data()); };
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].parent < 0) continue;
    const auto parent = static_cast<std::size_t>(joints[j].parent);
    has_child[parent] = true;
    const Eigen::Vector3d head = place(parent), tail = place(j);
    if ((tail - head).norm() < shortest) continue;
    capsules[parent].push_back(make_capsule(character.vertices, head, tail, joints[parent].parent >= 0, true));
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (has_child[j]) continue;
    const Eigen::Vector3d head = place(j);
    const Eigen::Vector3d tail = end_position(character, static_cast<std::uint32_t>(j), head);
    if ((tail - head).norm() < shortest) continue;
    capsules[j].push_back(make_capsule(character.vertices, head, tail, joints[j].parent >= 0, false));
  }
  return capsules;
}

// Is a point, whose largest weight is that of `joint`, bone? deeper_than(share): is it deeper than that share of the
// deepest point of the joint?
template <typename DeeperThan>
bool is_bone(const Character& character, const std::vector<std::vector<Capsule>>& capsules, Eigen::Index joint,
             double weight, const Eigen::Vector3d& point, const DeeperThan& deeper_than) {
  if (weight < kCapsuleWeight) return false;
  for (const Capsule& capsule : capsules[static_cast<std::size_t>(joint)]) {
    if (inside(capsule, point)) return true;
  }
  const bool root = character.skeleton.joints[static_cast<std::size_t>(joint)].parent < 0;
  return weight >= kCoreWeight && deeper_than(root ? kTrunkDepth : kCoreDepth);
}

// A sample of a cage and the joint it belongs to.
struct JointSample {
  Eigen::Index joint = 0;
  double weight = 0;
  double depth = 0;   // metres; where the weight makes it core
  double radius = 0;  // metres: half the body's thickness there
};

std::vector<JointSample> joint_samples(const Cage& cage, const Positions& skin, const Triangles& triangles,
                                       const NodeWeights& weights) {
  std::vector<JointSample> result(cage.samples.size());
  const Eigen::VectorXd thick = thickness(skin, triangles);
  const NearestSkin nearest(skin, triangles);
  parallel_for(result.size(), [&](std::size_t k) {
    const EmbeddedPoint& point = cage.samples[k].point;
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(weights.cols());
    for (int a = 0; a < 4; ++a) sum += point.weights[a] * weights.row(cage.mesh.tets(point.tet, a));
    result[k].weight = sum.maxCoeff(&result[k].joint);
    if (result[k].weight < kCoreWeight) return;
    const Eigen::Vector3d position = rest_position(cage.mesh, point);
    const SkinPoint near = nearest(position);
    result[k].depth = (near.position - position).norm();
    for (int a = 0; a < 3; ++a) {
      result[k].radius += near.weights[a] * thick[near.vertices[static_cast<std::size_t>(a)]] / 2;
    }
  });
  return result;
}

}  // namespace

std::vector<BonePoint> find_bones(const TetMesh& mesh, const Character& character, const NodeWeights& weights) {
  const std::vector<std::vector<Capsule>> capsules = make_capsules(character);
  const Eigen::Index skin_count = character.vertices.rows();
  Eigen::VectorXd depth = Eigen::VectorXd::Zero(mesh.nodes.rows());
  Eigen::VectorXd core_depth = Eigen::VectorXd::Zero(weights.cols());
  for (Eigen::Index n = skin_count; n < mesh.nodes.rows(); ++n) {
    depth[n] = skin_distance(character.vertices, mesh.nodes.row(n));
    for (Eigen::Index j = 0; j < weights.cols(); ++j) {
      if (weights(n, j) >= kCoreWeight) core_depth[j] = std::max(core_depth[j], depth[n]);
    }
  }
  const std::vector<Eigen::Vector4d> samples = tet_lattice(kLattice);
  std::vector<BonePoint> points;
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    Eigen::Matrix<double, 4, 3> corner;
    Eigen::Vector4d corner_depth;
    NodeWeights corner_weights(4, weights.cols());
    for (int a = 0; a < 4; ++a) {
      corner.row(a) = mesh.nodes.row(mesh.tets(t, a));
      corner_depth[a] = depth[mesh.tets(t, a)];
      corner_weights.row(a) = weights.row(mesh.tets(t, a));
    }
    const double volume = tet_edges(mesh, t).determinant() / 6 / static_cast<double>(samples.size());
    for (const Eigen::Vector4d& sample : samples) {
      Eigen::Index joint = 0;
      const double weight = (sample.transpose() * corner_weights).maxCoeff(&joint);
      const auto deeper_than = [&](double share) { return sample.dot(corner_depth) > share * core_depth[joint]; };
      if (is_bone(character, capsules, joint, weight, corner.transpose() * sample, deeper_than)) {
        points.push_back({t, static_cast<int>(joint), sample, volume});
      }
    }
  }
  return points;
}

std::vector<BonePoint> find_bones(const Cage& cage, const Character& character, const NodeWeights& weights) {
  const std::vector<std::vector<Capsule>> capsules = make_capsules(character);
  const std::vector<JointSample> samples = joint_samples(cage, character.vertices, character.triangles, weights);
  Eigen::VectorXd core_depth = Eigen::VectorXd::Zero(weights.cols());
  for (const JointSample& sample : samples) core_depth[sample.joint] = std::max(core_depth[sample.joint], sample.depth);
  const Positions& skin = character.vertices;
  const double digit = kDigit * longest_extent(skin);
  std::vector<BonePoint> points;
  std::vector<bool> has_bone(static_cast<std::size_t>(weights.cols()), false);
  const auto add = [&](std::size_t k) {
    const CageSample& sample = cage.samples[k];
    points.push_back({sample.point.tet, static_cast<int>(samples[k].joint), sample.point.weights, sample.volume});
  };
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const bool is_digit =
        samples[k].radius < digit;  // thinner than the rest of its joint's skin, with a core of its own
    const double core =
        is_digit ? std::min(samples[k].radius, core_depth[samples[k].joint]) : core_depth[samples[k].joint];
    const auto deeper_than = [&](double share) { return samples[k].depth > share * core; };
    const Eigen::Vector3d point = rest_position(cage.mesh, cage.samples[k].point);
    if (!is_bone(character, capsules, samples[k].joint, samples[k].weight, point, deeper_than)) continue;
    has_bone[static_cast<std::size_t>(samples[k].joint)] = true;
    add(k);
  }
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (samples[k].weight >= kCoreWeight && !has_bone[static_cast<std::size_t>(samples[k].joint)]) add(k);
  }
  return points;
}

}  // namespace bodyopt
