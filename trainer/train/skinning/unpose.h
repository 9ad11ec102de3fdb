// The inverse of skinning: what a posed shape is, in the space of the rest skin.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "assets/characters/character.h"
#include "runtime/basis/basis.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt::trainer {

// Linear blend skinning in double precision.

using BlendMatrix = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;  // rest space to world

// One per joint. Throws Error(mismatch) when the pose has another number of joints than the skeleton.
std::vector<BlendMatrix> blend_matrices(const Skeleton& skeleton, const Pose& pose);

BlendMatrix blended(const std::vector<BlendMatrix>& skinning, const std::vector<JointWeight>& weights);

// Linear blend skinning, double precision, V x 3 welded; the baseline "lbs".
Positions skin_linear(const Character& character, const Pose& pose);

// How a vertex of the rest skin is placed in a pose: without displacement at origin + rotation * rest.
struct VertexPlacement {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d origin, rest;

  Eigen::Vector3d posed(const Eigen::Vector3d& offset) const { return origin + rotation * (rest + offset); }
  Eigen::Vector3d unposed(const Eigen::Vector3d& posed) const { return rotation.transpose() * (posed - origin) - rest; }
};

// Placements by the runtime's own Direct Delta Mush, in runtime order.
std::vector<VertexPlacement> ddm_placements(const Basis& basis, const Pose& pose,
                                            std::span<const std::uint32_t> vertices);
std::vector<VertexPlacement> ddm_placements(const Basis& basis, const Pose& pose);

// Un-poses by the runtime's own Direct Delta Mush, delta d_i = R_i^T (y_i - t_i) - d_i: an isometry, so that nothing is
// amplified. `shape`: V x 3, runtime order, posed, metres. -> V x 3, un-posed space, metres.
Positions unpose_ddm(const Basis& basis, const Pose& pose, const Positions& shape);

// Un-poses some vertices: row k of shape and result belongs to vertices[k].
Positions unpose_ddm(const Basis& basis, const Pose& pose, const Positions& shape,
                     std::span<const std::uint32_t> vertices);

// Un-poses by linear blend skinning: the blended matrix of each vertex inverted, minus the rest position. `character`
// and `shape` in the same vertex order. A vertex whose blended matrix is singular gives zero.
Positions unpose_linear(const Character& character, const Pose& pose, const Positions& shape);
Positions unpose_linear(const Character& character, const Pose& pose, const Positions& shape,
                        std::span<const std::uint32_t> vertices);

}  // namespace bodyopt::trainer
