#include "geometry/extent.h"
#include "runtime/core/error.h"
#include "trainer/tets/cage.h"
#include "trainer/tets/tets.h"

namespace bodyopt {
namespace {

constexpr double kDefaultSize = 3;  // mean edges of the skin

Cage fill(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
          const FillableSkin& fillable, double size) {
  Cage cage;
  const double edge = size > 0 ? size : kDefaultSize * mean_edge(fillable.vertices, fillable.triangles);
  cage.mesh = tetrahedralise(fillable.vertices, fillable.triangles, edge);
  cage.skin = carry_skin(fillable, vertices, cage.mesh, own_nodes(cage.mesh, fillable.vertices.rows()));
  cage.riders = Riders(fillable, vertices, triangles, weights);
  cage.is_own_skin = true;
  cage.mending = fillable.mending();
  return cage;
}

}  // namespace

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

}  // namespace bodyopt
