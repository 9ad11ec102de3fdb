#include "trainer/tets/cage.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "trainer/tets/lattice_cage.h"

namespace bodyopt::trainer {
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
  throw Error(ErrorKind::mismatch, far, " vertices lie far outside a coarser skin");
}

SkinWeights of_hosts(const SkinWeights& weights, const FillableSkin& fillable) {
  SkinWeights hosts;
  for (const std::uint32_t v : fillable.vertex) hosts.push_back(weights[v]);
  return hosts;
}

constexpr int kSampleRows = 3;  // samples along a tet's edge, less one
constexpr int kFitRounds = 2, kFitRoundsApart = 3;

// Steps towards the mean of the fine skin around each vertex of the coarser one.
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

// Fits a skin that would come to pass through itself by fit(), as lips do.
void fit_apart(const FineSkin& fine, CoarseSkin& coarse) {
  for (int round = 0; round < kFitRoundsApart; ++round)
    step_apart(coarse.triangles, steps_to_fit(fine, coarse), coarse.vertices);
}

constexpr double kDefaultSize = 3;  // mean edges of the skin

Cage fill(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
          const FillableSkin& fillable, double size) {
  Cage cage;
  const double edge = size > 0 ? size : kDefaultSize * mean_edge(fillable.vertices, fillable.triangles);
  cage.mesh = tetrahedralise(fillable.vertices, fillable.triangles, edge);
  cage.skin = carry_skin(fillable, vertices, cage.mesh, own_nodes(cage.mesh, fillable.vertices.rows()));
  cage.loose_pieces = LoosePieces(fillable, vertices, triangles, weights);
  cage.is_own_skin = true;
  cage.mending = fillable.mending();
  return cage;
}

}  // namespace

Cage filled_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                 Eigen::Index max_nodes) {
  const FillableSkin fillable = fillable_skin(vertices, triangles, weights);
  // Only a lattice holds pieces together that no bone holds.
  if (fillable.pieces > 1) {
    throw Error(ErrorKind::mismatch, concat("the skin is in ", fillable.pieces, " pieces"), ErrorCause::several_pieces);
  }
  Cage cage = skin_cage(fillable.vertices, fillable.triangles, max_nodes);
  require_near(cage);
  carry_by_own_joints(fillable.vertices, fillable.triangles, of_hosts(weights, fillable), cage.mesh, cage.skin);
  cage.skin = carry_skin(fillable, vertices, cage.mesh, cage.skin);
  cage.loose_pieces = LoosePieces(fillable, vertices, triangles, weights);
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

Cage own_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights, double size) {
  constexpr int kMostRoom = 9;
  for (int room = 1;; room *= 3) {  // with too little left between what has come apart Netgen gives up
    const FillableSkin fillable = fillable_skin(vertices, triangles, weights, room);
    try {
      return fill(vertices, triangles, weights, fillable, size);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::mismatch || fillable.intersections == 0 || room >= kMostRoom) throw;
    }
  }
}

ApartSkin::ApartSkin(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights)
    : vertices_(vertices),
      weights_(weights),
      outwards_(enclosed_volume(vertices, triangles) < 0 ? -1 : 1),
      distance_(vertices.rows(), triangles) {}

// How far behind the skin at the other, metres.
double ApartSkin::depth(const SkinPoint& point, const SkinPoint& other) const {
  const auto corner = [&](std::size_t k) -> Eigen::Vector3d { return vertices_.row(other.vertices[k]); };
  const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
  return (other.position - point.position).dot(normal) * outwards_;
}

bool ApartSkin::operator()(const SkinPoint& a, const SkinPoint& b, double overlap) const {
  if (shared_weight(weights_at(weights_, a), weights_at(weights_, b)) >= kSharedByOne) return false;
  if (std::max(depth(a, b), depth(b, a)) > overlap) return false;
  const auto is_of_b = [&](std::uint32_t v) { return std::ranges::find(b.vertices, v) != b.vertices.end(); };
  // No way over a corner is as short as that straight through one triangle or two.
  if (std::ranges::any_of(a.vertices, is_of_b)) return false;
  const double farthest = kDetour * (a.position - b.position).norm();
  const std::vector<SurfacePlace> near = distance_.around(vertices_, a, farthest);
  return std::ranges::none_of(near, [&](const SurfacePlace& place) {
    return is_of_b(place.vertex) &&
           place.distance + (vertices_.row(place.vertex).transpose() - b.position).norm() <= farthest;
  });
}

}  // namespace bodyopt::trainer
