#include "trainer/tets/skin_cage.h"

#include <Eigen/LU>

#include "geometry/tet_finder.h"
#include "geometry/untangle.h"
#include "runtime/core/error.h"
#include "trainer/tets/coarse_skin.h"

namespace bodyopt {
namespace {

constexpr int kSampleRows = 3;  // samples along a tet's edge, less one
constexpr int kFitRounds = 2, kFitRoundsApart = 3;

// Towards the mean of the fine skin around each vertex of the coarser one.
Positions steps_to_fit(const FineSkin& fine, const CoarseSkin& coarse) {
  const NearestSkin nearest(coarse.vertices, coarse.triangles);
  Positions sum = Positions::Zero(coarse.vertices.rows(), 3);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(coarse.vertices.rows());
  for (Eigen::Index v = 0; v < fine.vertices.rows(); ++v) {
    const SkinPoint near = nearest.facing(fine.vertices.row(v), fine.normals.row(v));
    if (near.triangle < 0) continue;
    for (int k = 0; k < 3; ++k) {
      sum.row(near.vertices[static_cast<std::size_t>(k)]) +=
          near.weights[k] * (fine.vertices.row(v) - near.position.transpose());
      weight[near.vertices[static_cast<std::size_t>(k)]] += near.weights[k];
    }
  }
  for (Eigen::Index n = 0; n < weight.size(); ++n) {
    if (weight[n] > 0) sum.row(n) /= weight[n];
  }
  return sum;
}

// Moves the coarser skin, whose chords lie inside bends, outwards until as much of the fine skin is inside it as
// outside.
void fit(const FineSkin& fine, CoarseSkin& coarse) {
  for (int round = 0; round < kFitRounds; ++round) coarse.vertices += steps_to_fit(fine, coarse);
}

// The same of a skin that would come to pass through itself by that, as lips do.
void fit_apart(const FineSkin& fine, CoarseSkin& coarse) {
  for (int round = 0; round < kFitRoundsApart; ++round)
    step_apart(coarse.triangles, steps_to_fit(fine, coarse), coarse.vertices);
}

}  // namespace

Cage cage_in(const FineSkin& fine, const FilledSkin& filled) {
  Cage cage;
  cage.mesh = filled.mesh;
  const TetFinder find(cage.mesh, filled.skin.vertices, filled.skin.triangles);
  for (Eigen::Index v = 0; v < fine.vertices.rows(); ++v) {
    cage.skin.push_back(find(fine.vertices.row(v), fine.normals.row(v)));
  }
  const std::vector<Eigen::Vector4d> lattice = tet_lattice(kSampleRows);
  for (int t = 0; t < cage.mesh.tets.rows(); ++t) {
    const double volume = tet_edges(cage.mesh, t).determinant() / 6 / static_cast<double>(lattice.size());
    for (const Eigen::Vector4d& weights : lattice) cage.samples.push_back({{t, weights}, volume});
  }
  return cage;
}

Cage skin_cage(const Positions& vertices, const Triangles& triangles, Eigen::Index max_nodes) {
  const FineSkin fine(vertices, triangles);
  try {
    return cage_in(fine, fill_coarser(fine, {.nodes = max_nodes}, [&](CoarseSkin& skin) { fit(fine, skin); }));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;
    return cage_in(fine, fill_coarser(fine, {.nodes = max_nodes}, [&](CoarseSkin& skin) { fit_apart(fine, skin); }));
  }
}

}  // namespace bodyopt
