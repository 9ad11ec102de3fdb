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

}  // namespace bodyopt
