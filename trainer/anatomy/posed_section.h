// Sections of a body that was posed, where no tets tell how its inside moved: by what its skin and its joints did.
#pragma once

#include <vector>

#include "assets/character.h"
#include "runtime/core/transform.h"
#include "trainer/anatomy/section.h"

namespace bodyopt {

// All must outlive it.
struct PosedBody {
  const Character& character;
  const Positions& skin;                // V x 3, posed, metres
  const std::vector<Affine>& skinning;  // J, rest space to posed
};

// Where the pixels inside the posed skin (where its crossings along a row do not sum to none) lie at rest: a pixel goes
// back by the inverse of the linear blend of the joints that hold the skin nearest to it, and by as much as the skin
// there differs from that blend, less the deeper it lies. A picture, not mechanics: at sharp bends tissues of both
// sides meet at a seam.
RestPoints rest_points(const SectionPlane& plane, const PosedBody& body);

// The plane where a joint takes it.
SectionPlane moved_plane(const SectionPlane& plane, const Affine& joint);

}  // namespace bodyopt
