// Tetrahedra between points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/nearest_skin.h"
#include "geometry/spatial_search.h"

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

// Gradients of the corners' barycentric weights (4 x 3), per metre, by such edges.
Eigen::Matrix<double, 4, 3> corner_slopes(const Eigen::Matrix3d& edges);

// The faces that belong to one tet only, outwards.
Triangles surface_of(const Tets& tets);

double volume(const TetMesh& mesh);  // of all tets, cubic metres

// Mean-ratio quality, 0 (flat) .. 1 (regular): 12 (3 volume)^(2/3) over the sum of squared edges (Liu and Joe 1994).
double mean_ratio(const TetMesh& mesh, Eigen::Index tet);

// Barycentric weights of points spread evenly in a tet, rows + 1 along an edge: each stands for as much of the volume.
// inset: of the outer points from the faces, in distances between points.
std::vector<Eigen::Vector4d> tet_lattice(int rows, double inset = 0.25);

// Points embedded in tetrahedra: a fine skin in a coarse cage.

struct EmbeddedPoint {
  int tet;
  Eigen::Vector4d weights;  // barycentric, of the tet's corners: sum 1; negative where the point lies outside
};

// The points where moved nodes (N x 3) take them, P x 3: exact for affine motion, the same bits every time.
Positions embed(const std::vector<EmbeddedPoint>& points, const Tets& tets, const Positions& nodes);

// Barycentric, of a point at rest in a tet or outside of it.
Eigen::Vector4d weights_in(const TetMesh& mesh, Eigen::Index tet, const Eigen::RowVector3d& point);

Eigen::Vector3d rest_position(const TetMesh& mesh, const EmbeddedPoint& point);

// Finds the tet of a filled surface that a point is embedded in.

class TetFinder {
 public:
  // vertices and triangles: the surface that the mesh fills; they must outlive it. Throws Error(mismatch) where a
  // triangle is no face of a tet.
  TetFinder(const TetMesh& mesh, const Positions& vertices, const Triangles& triangles);

  // Returns the tet that a point of the skin lies in; of several the one that it lies deepest in. Outside it is the tet
  // behind the nearest triangle that faces as the skin does there. normal: of the skin, outwards.
  EmbeddedPoint operator()(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  // A point inside the body needs no normal. Where no tet holds it, it is the tet behind the nearest triangle.
  EmbeddedPoint operator()(const Eigen::Vector3d& point) const;

 private:
  struct Tet {
    Eigen::Vector3d origin;
    Eigen::Matrix3d inverse;  // of the edges from corner 0
  };
  EmbeddedPoint deepest(const Eigen::Vector3d& point, int behind) const;
  Eigen::Vector4d weights(int tet, const Eigen::Vector3d& point) const;

  NearestSkin nearest_;
  std::vector<Tet> tets_;
  BoxTree tree_;             // of tets_
  std::vector<int> behind_;  // tet behind every triangle of the surface
};

}  // namespace bodyopt
