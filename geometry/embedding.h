// Points carried by tetrahedra: a fine skin in a coarse cage.
#pragma once

#include <vector>

#include "geometry/tet_mesh.h"

namespace bodyopt {

struct EmbeddedPoint {
  int tet;
  Eigen::Vector4d weights;  // barycentric, of the tet's corners: sum 1; negative where the point lies outside
};

// The points where moved nodes (N x 3) take them, P x 3: exact for affine motion, the same bits every time.
Positions embed(const std::vector<EmbeddedPoint>& points, const Tets& tets, const Positions& nodes);

// Barycentric, of a point at rest in a tet or outside of it.
Eigen::Vector4d weights_in(const TetMesh& mesh, Eigen::Index tet, const Eigen::RowVector3d& point);

Eigen::Vector3d rest_position(const TetMesh& mesh, const EmbeddedPoint& point);

}  // namespace bodyopt
