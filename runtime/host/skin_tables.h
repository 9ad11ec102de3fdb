// What push-out knows of a skin, whatever its pose is.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// J: does the joint carry more than one limb? A limb is a chain of bones longer than a quarter of the longest one from
// a root: an arm, a leg, a tail, no finger.
std::vector<char> trunk_joints(const Skeleton& skeleton);

// J, metres: how far around a fold's joint at rest skin that each joint holds belongs to it. All of `reach` what the
// joint bends, and what is as near along the bones; of the trunk less, and nothing where the limb's joint is far from
// it; nothing of all else: hands are not the groin's.
std::vector<float> fold_reaches(const Skeleton& skeleton, std::uint32_t joint, float reach);

// J: of each joint whether it is `joint` or one below it.
std::vector<char> at_or_below(const Skeleton& skeleton, std::uint32_t joint);

struct FoldTables {
  // T x 3: the skin's, in an order in which each kBoxTriangles of them lie together at rest.
  std::vector<std::uint32_t> triangles;
  // Of each of V vertices words of a bit for each fold whose reach it lies within, in space and along the bones, and as
  // many of a bit for each whose joint, or one below that, holds it: the child's side. Then of each box of triangles
  // words of a bit for each fold of whose parent's side a corner is, and as many of a bit for each of whose child's
  // side one is.
  std::vector<std::uint32_t> sides;
};

// Nothing where there is no push-out.
FoldTables fold_tables(const Basis& basis);
// Their parts: triangles in such an order, and what boxes of triangles add to the vertices' sides.
std::vector<std::uint32_t> boxed_triangles(const MeshTable& mesh);
void add_box_sides(std::size_t words, FoldTables& tables);

// Empty where no texture coordinates were given.
struct TangentTables {
  std::vector<TangentVertex> vertices;  // O
  std::vector<TangentCorner> corners;   // those of output vertices of one place and one texture coordinate once
};

// texture: O x 2, finite; empty: none. As in MikkTSpace, triangles belong together where place and texture coordinates
// agree, and where they are mirrored alike; but an output vertex has one tangent: of the triangles around it those have
// their way that hold the larger angle at rest. Triangles without an area on the texture, and those of which two
// corners are at one place at rest, have no part in it.
TangentTables tangent_tables(const MeshTable& mesh, std::span<const float> texture);

}  // namespace bodyopt
