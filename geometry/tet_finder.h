// Which tet of a filled surface carries a point.
#pragma once

#include <vector>

#include "geometry/box_tree.h"
#include "geometry/embedding.h"
#include "geometry/nearest_skin.h"

namespace bodyopt {

class TetFinder {
 public:
  // vertices and triangles: the surface that the mesh fills; they must outlive it. Throws Error(mismatch) where a
  // triangle is no face of a tet.
  TetFinder(const TetMesh& mesh, const Positions& vertices, const Triangles& triangles);

  // The tet that a point of the skin lies in, or, where it is outside, the tet behind the nearest triangle that faces
  // as the skin does there; of several tets the one that it lies deepest in. normal: of the skin at the point, away
  // from the body.
  EmbeddedPoint operator()(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  // The same of a point inside the body, with the tet behind the nearest triangle where none holds it.
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
