// Direct Delta Mush (Le & Lewis 2019, v0) in the centred form: the moments, and their packing for the runtime.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "geometry/mesh.h"
#include "runtime/basis/basis.h"
#include "trainer/train/options.h"

namespace bodyopt::trainer {

// The skin in runtime order.

// Welded vertex of each runtime vertex: the Morton order of the rest positions, ties in welded order.
std::vector<std::uint32_t> morton_order(const Positions& vertices);

// Runtime vertex of each welded vertex.
std::vector<std::uint32_t> inverse_of(const std::vector<std::uint32_t>& order);

// The numbers of that many vertices.
std::vector<std::uint32_t> all_vertices(Eigen::Index count);

// Rows of `welded` (V x 3) in runtime order.
Positions in_order(const Positions& welded, const std::vector<std::uint32_t>& order);

// The character with its welded vertices renumbered to runtime order; output order stays.
Character in_order(const Character& character, const std::vector<std::uint32_t>& order);

// `character` in runtime order.
MeshTable make_mesh_table(const Character& character);

// Throws Error(mismatch) where the basis has other vertices or triangles, another skeleton, or another rest skin than
// `mesh` (as make_mesh_table) and `skeleton`.
void require_same_character(const MeshTable& mesh, const Skeleton& skeleton, const Basis& basis);

struct DdmOptions {
  double radius = 0.045;  // smoothing radius, metres
  int steps = 20;         // implicit smoothing steps
  double prune = 2e-5;    // joints with less omega at a vertex are dropped (1e-4 moves vertices by 2.4e-5 of the
                          // bounding box, this by 7e-6, for 6 % more bytes); 0 keeps all
};

// Moments of one joint at one vertex, around the vertex's centre, divided by its radius2 (omega is not).
struct JointMoments {
  std::uint32_t joint = 0;
  double omega = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

struct VertexMoments {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // p_i, rest space, metres
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // d_i
  double radius2 = 0;                                // square metres; 0 for a vertex without neighbours
  double kept = 0;                                   // sum of the omegas kept, before they were normalised: without
                                                     // pruning the row sum of B, which is 1
  std::vector<JointMoments> joints;                  // ascending; the omegas sum to 1
};

// Rest positions V x 3 (metres), triangles, weights of every vertex -> V.
std::vector<VertexMoments> ddm_moments(const Positions& rest, const Triangles& triangles,
                                       const std::vector<std::vector<JointWeight>>& weights, const DdmOptions& options);

DdmTable pack_ddm(const std::vector<VertexMoments>& moments);

// The default radius: 1/40 of the longest extent, so that a body of any size has the same shape.
double default_smoothing_radius(const Positions& rest);

// A basis of Direct Delta Mush and nothing else, which takes no shapes.

// Direct Delta Mush and nothing else, and the moments it is made of.
struct DdmBase {
  Basis basis;
  std::vector<VertexMoments> moments;
  double radius = 0;  // sigma, metres
};

// How a basis was made, for its metadata: JSON. `updated`: it was brought on from an earlier training; one from the
// start, of the same data and options, is another.
std::string provenance_text(const Character& character, double radius, const TrainOptions& options, bool updated);

// `ordered`: a character in runtime order.
DdmBase make_ddm_base(const Character& ordered, double radius, const TrainOptions& options);

// DDM, no shapes: mesh and ddm tables, an empty residual.
Basis build_ddm_basis(const Character& character, const TrainOptions& options);

}  // namespace bodyopt::trainer
