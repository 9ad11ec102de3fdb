// Tetrahedra that fill a body.
#pragma once

#include <functional>
#include <limits>

#include "geometry/nearest_skin.h"
#include "geometry/tet_mesh.h"

namespace bodyopt::trainer {

// Netgen's nglib on the welded skin (which must be closed and free of self-intersections). The first V nodes are the
// skin's vertices, unmoved. `size` is the largest edge wanted inside, metres. Throws Error(mismatch) naming the cause
// when the skin cannot be filled.
TetMesh tetrahedralise(const Positions& vertices, const Triangles& triangles, double size);

// A skin remeshed with longer edges, then filled with tetrahedra.

// A closed skin to be remeshed, wound outwards, and the relative lengths of a coarser one's edges at its vertices. They
// grow with the root of the body's thickness there. Equal edges leave limbs of a few tets, which hardly bend; edges as
// long as the body is thick spend all nodes on the fingers.
struct FineSkin {
  const Positions& vertices;
  Triangles triangles;
  Positions normals;
  Eigen::VectorXd edge;
  NearestSkin nearest;

  // `vertices` must outlive it. Throws Error(mismatch) where the skin is not closed.
  FineSkin(const Positions& vertices, const Triangles& wound);
  FineSkin(const FineSkin&) = delete;
  FineSkin& operator=(const FineSkin&) = delete;
  double edge_at(const Eigen::Vector3d& point) const;
};

struct CoarseSkin {
  Positions vertices;
  Triangles triangles;
};

// A coarser skin, and tets whose first nodes are its vertices.
struct FilledSkin {
  CoarseSkin skin;
  TetMesh mesh;
};

struct FillLimit {
  Eigen::Index nodes = std::numeric_limits<Eigen::Index>::max();
  Eigen::Index tets = std::numeric_limits<Eigen::Index>::max();
};

// The finest found within the limit, and not finer than the skin itself. The vertices of the coarser skin lie on the
// fine one, then `adjust` moves them. Edges stay short where a part is thin. A function of its arguments alone.
// Throws Error(mismatch) when none can be filled with tets of a mean-ratio quality of 0.05 at least.
FilledSkin fill_coarser(const FineSkin& fine, FillLimit limit, const std::function<void(CoarseSkin&)>& adjust);

}  // namespace bodyopt::trainer
