// Tetrahedra between points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

using Tets = Eigen::Matrix<int, Eigen::Dynamic, 4, Eigen::RowMajor>;  // nodes of every tet

struct TetMesh {
  Positions nodes;           // N x 3, rest space, metres
  Tets tets;                 // positive volume
  double worst_quality = 0;  // smallest mean-ratio quality, 0 (flat) .. 1 (regular)
  // Every eight tets in a row are one of second order, cut at the middles of its edges (trainer/tets/second_order.h).
  bool is_second_order = false;
};

// Turns every tet to positive volume and sets the worst quality.
void orient(TetMesh& mesh);

// Edges from corner 0 to corners 1..3 as columns, metres; their determinant is six times the tet's volume.
Eigen::Matrix3d tet_edges(const TetMesh& mesh, Eigen::Index tet);

// The faces that belong to one tet only, outwards.
Triangles surface_of(const Tets& tets);

double volume(const TetMesh& mesh);  // of all tets, cubic metres

// Mean-ratio quality, 0 (flat) .. 1 (regular): 12 (3 volume)^(2/3) over the sum of squared edges (Liu and Joe 1994).
double mean_ratio(const TetMesh& mesh, Eigen::Index tet);

// Barycentric weights of points spread evenly in a tet, rows + 1 along an edge: each stands for as much of the volume.
std::vector<Eigen::Vector4d> tet_lattice(int rows);

}  // namespace bodyopt
