// Tables of push-out and of tangents: they depend on the skin at rest, whatever its pose is.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// J: does the joint carry more than one limb? A limb is a chain of bones of at least a quarter of the longest one from
// a root: an arm, a leg, no finger.
std::vector<char> trunk_joints(const Skeleton& skeleton);

// J, metres: how near to a fold's joint the skin of each joint must be, at rest, to belong to it. That is `reach` for
// the parent and for joints as near along the bones, else 0. Near the trunk, it is less for the trunk and beyond a
// limb's joint. Far from it, the trunk has 0, too: hands are not the groin's.
std::vector<float> fold_reaches(const Skeleton& skeleton, std::uint32_t joint, float reach);

// J: of each joint whether it is `joint` or one below it.
std::vector<char> at_or_below(const Skeleton& skeleton, std::uint32_t joint);

struct FoldTables {
  // T x 3: the skin's, in an order in which each kBoxTriangles of them lie together at rest.
  std::vector<std::uint32_t> triangles;
  // Words of bits, a bit for each fold. Each of V vertices has words for the folds within whose reach it lies, in space
  // and along the bones. As many say which folds' joints, or joints below those, hold it: the child's side. Then each
  // box of triangles has words for the folds of whose parent's side a corner is, and as many for the child's.
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

// `texture`: O x 2, finite; empty: none. As in MikkTSpace, triangles belong together where place and texture
// coordinates agree, and where they are mirrored alike. But an output vertex has one tangent, by those triangles around
// it, mirrored or not, that hold the larger angle at rest. Triangles without an area on the texture, or with two
// corners at one place at rest, have no part in it.
TangentTables tangent_tables(const MeshTable& mesh, std::span<const float> texture);

}  // namespace bodyopt
