// Recovers which vertex is which, and which way is up, after another program has written a mesh in ways of its own.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "geometry/mesh.h"
#include "geometry/nearest_skin.h"
#include "trainer/curate/frame_files.h"

namespace bodyopt::trainer {

// A vertex, and a place of the texture that it has: one along a seam has several.
struct TexturedVertex {
  std::uint32_t vertex = 0;
  double u = 0, v = 0;
};

// A surface, V x 3 metres and T x 3, and what is known of its texture.
struct TexturedSurface {
  Positions vertices;
  Triangles triangles;
  std::vector<TexturedVertex> texture;
};

// The vertex of `known` that each vertex of `given` is, -1 where that is not clear. Both are one surface but for the
// order of vertices and triangles, and for where some vertices are. Unmoved vertices (within `tolerance`, metres) are
// known by their places. Moved ones are known by their place on the texture, where no other vertex has that. What is
// left is known by the triangles between them, from neighbour to neighbour.
std::vector<int> match_vertices(const TexturedSurface& known, const TexturedSurface& given, double tolerance);

// How many vertices of `given` lie where one of `known` does (within `tolerance`, metres).
std::size_t vertices_in_place(const Positions& known, const Positions& given, double tolerance);

// The rotation between coordinate axes that brings a mesh (`given`: N x 3, metres, in any order) to the skin it was
// made of. The identity where its extent is theirs as it is, or is theirs in no turn. Half of its vertices or more then
// lie where that skin has them. Throws Error(mismatch) where fewer do, but its extent is that of a turned skin.
Eigen::Matrix3d turn_back(std::span<const WrittenSkin> written, const Positions& given,
                          const std::filesystem::path& path);

}  // namespace bodyopt::trainer
