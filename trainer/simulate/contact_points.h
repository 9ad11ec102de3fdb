// The points of a body that may touch: vertices of the skin that its tets carry, and nodes of the tets' surface.
#pragma once

#include <vector>

#include "trainer/tets/cage.h"

namespace bodyopt::trainer {

// P points: the V vertices of the skin, then the N nodes of the tets, except in a lattice, whose surface is not the
// body's. A skin finer than the tets touches at its vertices, a coarser one at the tets' nodes between them.
struct ContactPoints {
  Eigen::Index skin_count = 0;
  Positions rest;                       // P x 3, metres
  Triangles triangles;                  // of the skin, then of the tets' surface
  std::vector<EmbeddedPoint> embedded;  // P: where each lies in the tets
  // P: the same within the tets. Forces act there: on a point far outside they would be a lever, which turns a small
  // tet over.
  std::vector<EmbeddedPoint> held;
  std::vector<int> touching;  // those of any triangle, ascending; of two in one place the vertex of the skin
  Eigen::VectorXd edge;       // P, mean of those around it, metres
  // P, metres: as near at rest is the same part, which cannot touch itself. An edge, and no less than that of the tet
  // which carries the point: finer folds than its tets no body has.
  Eigen::VectorXd same_part;
  Eigen::VectorXd area;  // P, a third of the triangles around it, square metres
};

// skin: V x 3, at rest, metres; triangles: of it, without loose pieces.
ContactPoints contact_points(const Positions& skin, const Triangles& triangles, const Cage& cage);

}  // namespace bodyopt::trainer
