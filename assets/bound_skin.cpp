#include "assets/bound_skin.h"

#include <Eigen/Dense>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "assets/gltf_write.h"
#include "assets/skin_surface.h"
#include "base/parallel.h"
#include "geometry/mesh.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

// Returns area-weighted normals, O x 3; they point up where a vertex has no area around it.
std::vector<float> normals(const Character& character) {
  Positions sums = vertex_normals(character.vertices, character.triangles);
  for (Eigen::Index v = 0; v < sums.rows(); ++v) {
    const double n = sums.row(v).norm();
    if (n > 1e-30) {
      sums.row(v) /= n;
    } else {
      sums.row(v) << 0, 1, 0;
    }
  }
  return output_from_welded(character, sums);
}

struct WeightSet {
  std::vector<std::uint16_t> joints;  // P x 4
  std::vector<float> weights;         // P x 4
};

std::vector<WeightSet> weight_sets(const Character& character, std::span<const std::uint32_t> places) {
  std::size_t most = 1;
  for (const auto& weights : character.weights) most = std::max(most, weights.size());
  std::vector<WeightSet> sets((most + 3) / 4,
                              {std::vector<std::uint16_t>(4 * places.size()), std::vector<float>(4 * places.size())});
  for (std::size_t o = 0; o < places.size(); ++o) {
    const auto& weights = character.weights[character.output_vertex[places[o]]];
    double rest = 1;  // the first weight takes the rounding of the others, so that they add up to one
    for (std::size_t k = weights.size(); k-- > 0;) {
      const auto weight = static_cast<float>(k == 0 ? rest : weights[k].weight);
      rest -= static_cast<double>(weight);
      sets[k / 4].weights[4 * o + k % 4] = weight;
      sets[k / 4].joints[4 * o + k % 4] = weight == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(weights[k].joint);
    }
  }
  return sets;
}

using Blended = Eigen::Matrix<double, 3, 4>;

Blended blend(const std::vector<Affine>& joints, const std::vector<JointWeight>& weights) {
  Blended sum = Blended::Zero();
  for (const JointWeight& weight : weights) {
    const Affine& joint = joints[static_cast<std::size_t>(weight.joint)];
    sum += weight.weight * Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&joint.m[0][0]);
  }
  return sum;
}

// Solves linear x = residual by Tikhonov's least squares, and once more for what that leaves.
Eigen::Vector3d solve_damped(const Eigen::Matrix3d& linear, const Eigen::Vector3d& residual) {
  constexpr double kDamping = 1e-4;  // of the mean squared stretch
  const double damping = std::max(1e-30, kDamping * linear.squaredNorm() / 3);
  const Eigen::Matrix3d normal = linear.transpose() * linear + damping * Eigen::Matrix3d::Identity(),
                        solve = normal.inverse() * linear.transpose();
  const Eigen::Vector3d first = solve * residual;
  return first + solve * (residual - linear * first);
}

}  // namespace

std::vector<float> blend_shape(const BoundSkin& skin, int frame, std::span<const float> shape) {
  const Character& character = skin.character;
  const Pose& pose = skin.clip.poses[static_cast<std::size_t>(frame - skin.clip.first_frame)];
  const std::vector<Affine> joints = skinning_matrices(character.skeleton, pose.joints);
  std::vector<float> offsets(shape.size());
  parallel_for(character.output_vertex.size(), [&](std::size_t o) {
    const std::uint32_t vertex = character.output_vertex[o];
    const Blended blended = blend(joints, character.weights[vertex]);
    const Eigen::Vector3d rest = character.vertices.row(vertex).transpose(),
                          wanted = Eigen::Map<const Eigen::Vector3f>(&shape[3 * o]).cast<double>();
    const Eigen::Matrix3d linear = blended.leftCols<3>();
    const Eigen::Vector3d offset = solve_damped(linear, wanted - linear * rest - blended.col(3));
    for (std::size_t i = 0; i < 3; ++i) offsets[3 * o + i] = static_cast<float>(offset(static_cast<Eigen::Index>(i)));
  });
  return offsets;
}

Json bound_vertices(const Character& character, std::span<const std::uint32_t> places, GlbWriter& glb) {
  Json attributes;
  attributes["POSITION"] =
      glb.add(spread(output_from_welded(character, character.vertices), places), "VEC3", GlbTarget::vertices);
  attributes["NORMAL"] = glb.add(spread(normals(character), places), "VEC3", GlbTarget::vertices);
  const std::vector<WeightSet> sets = weight_sets(character, places);
  for (std::size_t s = 0; s < sets.size(); ++s) {
    attributes["JOINTS_" + std::to_string(s)] = glb.add(sets[s].joints, "VEC4", GlbTarget::vertices);
    attributes["WEIGHTS_" + std::to_string(s)] = glb.add(sets[s].weights, "VEC4", GlbTarget::vertices);
  }
  return attributes;
}

}  // namespace bodyopt
