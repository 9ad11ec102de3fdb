// Welding of seam duplicates: exporters repeat a vertex wherever its texture coordinates or normals split.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "runtime/core/transform.h"

namespace bodyopt {

struct Weld {
  std::vector<std::uint32_t> welded_of;  // welded vertex of each vertex, numbered by first appearance
  std::vector<std::uint32_t> first;      // the vertex each welded vertex stands for
};

// Vertices whose coordinates differ by at most `tolerance` and whose weights (ascending by joint) differ by at most
// 1e-4 become one. Nothing when thousands of different vertices lie within `tolerance`: no skin is like that, and
// comparing them all would take forever.
[[nodiscard]] std::optional<Weld> weld_vertices(std::span<const Vec3> positions,
                                                std::span<const std::vector<JointWeight>> weights, double tolerance);

// The pieces that a surface is in.

struct SurfacePieces {
  std::vector<int> of_vertex;  // V: numbered by first vertex; a vertex of no triangle is a piece of its own
  int count = 0;
};

// Vertices joined by triangles, directly or through others, are one piece.
SurfacePieces surface_pieces(Eigen::Index vertices, const Triangles& triangles);

// Edges that keep a skin from being closed.

using VertexPair = std::pair<std::uint32_t, std::uint32_t>;  // ascending

// Each list ascending.
struct BadEdges {
  std::vector<VertexPair> open;     // of a single triangle
  std::vector<VertexPair> shared;   // of more than two
  std::vector<VertexPair> flipped;  // of two that run through it in the same direction
};

[[nodiscard]] BadEdges find_bad_edges(const Triangles& triangles);

// Keeps one of equal triangles, whichever way they wind: their edges are neither open nor turned.
[[nodiscard]] Triangles each_once(const Triangles& triangles);

}  // namespace bodyopt
