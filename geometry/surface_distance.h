// How far the vertices of a skin are from one of its points, along the skin: what lies near through the air may be far.
#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include "base/linear_algebra.h"
#include "geometry/mesh.h"
#include "geometry/nearest_skin.h"

namespace bodyopt {

// Discrete operators of a triangle mesh.

// A third of the area of the triangles around each vertex, square metres, not below 1e-3 of the mean. V
Eigen::VectorXd lumped_areas(const Positions& rest, const Triangles& triangles);

// Cotangent Laplacian, V x V, positive semi-definite: half the sum of the opposite cotangents per edge, that sum
// clamped at zero from below. Degenerate triangles add nothing.
Eigen::SparseMatrix<double> cotangent_laplacian(const Positions& rest, const Triangles& triangles);

// Diffusion over a skin by a Gaussian of one deviation (metres), in implicit steps, factorised once.
class SkinSmoother {
 public:
  SkinSmoother(const Positions& rest, const Triangles& triangles, double radius);
  // V x any; every column keeps its integral over the skin. Any thread may call it.
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& values) const;

 private:
  Eigen::VectorXd areas_;
  SparseSolver solver_;
};

// Smooths once, as SkinSmoother does.
[[nodiscard]] Eigen::MatrixXd smoothed(const Positions& rest, const Triangles& triangles, const Eigen::MatrixXd& values,
                                       double radius);

struct SurfacePlace {
  std::uint32_t vertex;
  double distance;  // metres
};

// A front passes from triangle to triangle (Kimmel and Sethian 1998), each unfolded into the plane of the front's
// origin (Novotni and Klein 2002). It is exact on developable surfaces. Only in a rim of an edge's length at
// the end of its reach it is a little too long.
class SurfaceDistance {
 public:
  // `vertices`: number of the skin's vertices.
  SurfaceDistance(Eigen::Index vertices, const Triangles& triangles);

  // The vertices within `reach` metres of a point of the skin, ascending. positions: V x 3, where they are now.
  std::vector<SurfacePlace> around(const Positions& positions, const SkinPoint& from, double reach) const;

  // Visits all vertices that share a triangle with `vertex`; twice where two triangles lie along the edge.
  template <typename Visit>
  void visit_ring(std::uint32_t vertex, Visit visit) const {
    for (std::uint32_t k = begin_[vertex]; k < begin_[vertex + 1]; ++k) {
      visit(corners_[k].next);
      visit(corners_[k].last);
    }
  }

 private:
  // The other two of a triangle.
  struct Corner {
    std::uint32_t next, last;
  };
  std::vector<std::uint32_t> begin_;  // V + 1: of the corners at every vertex
  std::vector<Corner> corners_;
};

}  // namespace bodyopt
