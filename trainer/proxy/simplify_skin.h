// A skin of fewer vertices that moves as the full one does.
#pragma once

#include <cstdint>
#include <vector>

#include "assets/character.h"

namespace bodyopt {

struct SimplifiedSkin {
  std::vector<std::uint32_t> vertices;  // welded vertices that stay, ascending
  Triangles triangles;                  // T x 3, numbers into `vertices`
};

// Collapses edges onto one of their ends, so that what stays is a subset of the vertices, in the order of the harm
// done: the quadric error (Garland and Heckbert 1997) summed over several shapes (Mohr and Gleicher 2003, Deformation
// Sensitive Decimation), which keeps vertices where the skin bends and folds, not only where it is curved at rest.
//
// `shapes`: V x 3 each, posed, metres, the first at rest. `error`: metres; no edge is collapsed whose vertex would lie
// further than that from the planes of the triangles it stands for then, root mean square over their area and the
// shapes.
//
// A closed skin stays closed and manifold, of the same genus; vertices at open or irregular edges stay, those of no
// triangle go. Every joint keeps three of the vertices that follow it most, or all it has. A function of its arguments
// alone.
SimplifiedSkin simplify_skin(const Character& character, const std::vector<Positions>& shapes, double error);

}  // namespace bodyopt
