// Skin that coarse tets carry, kept apart where it follows different joints.
#pragma once

#include <vector>

#include "geometry/embedding.h"
#include "trainer/tets/fillable_skin.h"

namespace bodyopt {

// Vertices carried by tets that follow other joints than they do, as one lip or tooth by the other jaw, are carried
// instead by the tet that holds them best of those that follow the same. A tet follows the joints of the vertices that
// its nodes carry. Where it follows theirs as well, they stay, unless skin of other joints in it is far from them along
// the skin: about a joint one tet may follow both bones, between the jaws none may.
//
// `vertices` (V x 3, rest, metres), `triangles`, `weights`: of the skin; `skin`: V, what carries each vertex.
void carry_by_own_joints(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                         const TetMesh& mesh, std::vector<EmbeddedPoint>& skin);

// A vertex that a tet of other joints carries because skin of theirs is next to it.
struct GluedVertex {
  std::uint32_t vertex;
  std::uint32_t joint;  // of the others, the one that the tet follows most
};

// Those that moves of the joints would part, but the tets do not: skin that follows other joints and is far from them
// along the skin shares their tet, and that tet follows less than four fifths of their weights. By vertex. As
// carry_by_own_joints().
std::vector<GluedVertex> glued_vertices(const Positions& vertices, const Triangles& triangles,
                                        const SkinWeights& weights, const TetMesh& mesh,
                                        const std::vector<EmbeddedPoint>& skin);

}  // namespace bodyopt
