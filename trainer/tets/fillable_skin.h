// The part of a skin that can be filled with tetrahedra, and how it was mended for that.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/tet_mesh.h"

namespace bodyopt::trainer {

// The triangles of sheets that share edges with a surface and bound no volume: fins, webs, frills. They end in open
// edges and meet the rest at edges of three triangles or more. The smallest is cut off first, until no edge that is
// left has more than two triangles, or what meets there has no open edge.
std::vector<bool> sheet_triangles(const Positions& vertices, const Triangles& triangles);

struct FillableSkin {
  Positions vertices;                       // H x 3, rest space, metres: moved where the skin passes through itself
  Triangles triangles;                      // closed, wound outwards, free of self-intersections
  std::vector<std::uint32_t> vertex;        // H: the skin's own vertex that each stands for
  std::vector<int> host;                    // V: the row of `vertices` that stands for each; -1: it is attached
  std::vector<std::uint32_t> first;         // V: the vertex that each was merged with, or itself
  std::vector<std::uint32_t> tangled;       // vertices of the skin at self-intersections, ascending
  Eigen::Index intersections = 0;           // pairs of triangles, before mending
  Eigen::Index turned = 0, filled = 0;      // triangles turned round; added in holes
  Eigen::Index cut = 0;                     // triangles of sheets, which are attached to what is filled
  Eigen::Index merged = 0, doubled = 0;     // vertices merged at open edges; triangles that were there twice
  int pieces = 0;                           // that are filled
  std::vector<std::uint32_t> loose_pieces;  // a vertex of each
  double farthest = 0;                      // that a vertex was moved, metres

  // One sentence of what was done; empty: nothing.
  std::string mending() const;
};

// The pieces of a skin that enclose a volume, with the rest attached to them. Flipped triangles are turned, open edges
// in one place joined, triangles that are there twice dropped, self-intersections moved apart (untangle). Holes are
// filled where that takes less than a fifth of a piece's area. Pieces are attached that lie in others, pass through
// larger ones, are open, or are small and follow the same joints. So are sheets that share edges with them
// (sheet_triangles). A skin that needs nothing of this comes back bit for bit.
//
// Throws Error(mismatch) naming the cause if no piece encloses a volume or self-intersections cannot be moved apart.
// Another cause is a large piece that cannot be filled and follows other joints than what it would be attached to.
// `room`: as of untangle; more where tets do not fit otherwise.
FillableSkin fillable_skin(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                           int room = 1);

// The tets that carry each vertex of the skin (V x 3), V. `mesh`: tets that carry the vertices of the fillable skin at
// `hosts`, H. Vertices that were moved, or attached, are carried by the tet near their host that holds them best.
// LoosePieces says how loose pieces move.
std::vector<EmbeddedPoint> carry_skin(const FillableSkin& fillable, const Positions& vertices, const TetMesh& mesh,
                                      const std::vector<EmbeddedPoint>& hosts);

// Tets whose first nodes are the vertices of the fillable skin carry them so, H.
std::vector<EmbeddedPoint> own_nodes(const TetMesh& mesh, Eigen::Index vertices);

}  // namespace bodyopt::trainer
