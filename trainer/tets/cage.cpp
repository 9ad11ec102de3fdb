#include "trainer/tets/cage.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "trainer/tets/lattice_cage.h"
#include "trainer/tets/skin_cage.h"

namespace bodyopt {
namespace {

// Barycentric weights of vertices far outside their tet: by its height, and by so much that one would be a spike.
constexpr double kFar = -1, kTooFar = -4;
constexpr double kMostFar = 0.01;  // of all vertices

void require_near(const Cage& cage) {
  std::size_t far = 0, too_far = 0;
  for (const EmbeddedPoint& point : cage.skin) {
    far += point.weights.minCoeff() < kFar ? 1 : 0;
    too_far += point.weights.minCoeff() < kTooFar ? 1 : 0;
  }
  if (too_far == 0 && static_cast<double>(far) <= kMostFar * static_cast<double>(cage.skin.size())) return;
  throw Error(ErrorKind::mismatch, std::to_string(far) + " vertices lie far outside a coarser skin");
}

SkinWeights of_hosts(const SkinWeights& weights, const FillableSkin& fillable) {
  SkinWeights hosts;
  for (const std::uint32_t v : fillable.vertex) hosts.push_back(weights[v]);
  return hosts;
}

}  // namespace

Cage filled_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                 Eigen::Index max_nodes) {
  const FillableSkin fillable = fillable_skin(vertices, triangles, weights);
  // Only a lattice holds pieces together that no bone holds.
  if (fillable.pieces > 1) {
    throw Error(ErrorKind::mismatch, "the skin is in " + std::to_string(fillable.pieces) + " pieces",
                ErrorCause::several_pieces);
  }
  Cage cage = skin_cage(fillable.vertices, fillable.triangles, max_nodes);
  require_near(cage);
  carry_by_own_joints(fillable.vertices, fillable.triangles, of_hosts(weights, fillable), cage.mesh, cage.skin);
  cage.skin = carry_skin(fillable, vertices, cage.mesh, cage.skin);
  cage.riders = Riders(fillable, vertices, triangles, weights);
  cage.mending = fillable.mending();
  return cage;
}

Cage make_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
               const CageLimits& limits) {
  std::optional<Error> why;
  const auto attempt = [&](const auto& fill) -> std::optional<Cage> {
    try {
      return fill();
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::mismatch) throw;  // it is not for the skin
      why = error;
      return {};
    }
  };
  std::optional<Cage> cage;
  const auto try_own = [&](Eigen::Index nodes) {
    if (cage || vertices.rows() > nodes) return;
    cage = attempt([&] { return own_cage(vertices, triangles, weights, 0); });
    if (cage && cage->mesh.nodes.rows() > nodes) cage.reset();
  };
  const auto try_coarser = [&](Eigen::Index nodes) {
    if (!cage) cage = attempt([&] { return filled_cage(vertices, triangles, weights, nodes); });
  };
  try_own(std::min(limits.nodes, limits.own_nodes));  // it is coarse already
  try_coarser(limits.nodes);
  if (limits.finer_nodes > limits.nodes) try_coarser(limits.finer_nodes);
  try_own(limits.own_nodes);
  if (!cage) {
    cage = lattice_cage(vertices, triangles, weights, limits.lattice_nodes);
    cage->why_lattice = why;
  }
  cage->glued = glued_vertices(vertices, triangles, weights, cage->mesh, cage->skin);
  return std::move(*cage);
}

}  // namespace bodyopt
