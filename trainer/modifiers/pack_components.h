// Components of modifiers to the blocks that the runtime adds.
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/skin_modifiers.h"

namespace bodyopt {

// Fills blend_begin and blend. Each component V x 3, metres. A block takes an entry of eight bits a number for each
// component that moves it by more than a micron, and a second one for what the first leaves where that is more.
void pack_components(const std::vector<Positions>& components, std::uint32_t vertex_count, SkinModifiers& modifiers);

}  // namespace bodyopt
