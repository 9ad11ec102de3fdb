// Joints that move skin, or all of it, and the skin that each moves.
#pragma once

#include <cstdint>
#include <vector>

#include "assets/characters/character.h"
#include "geometry/region_weights.h"

namespace bodyopt {

// Counts, per joint, the joints at or below it that skin follows by more than a trace.
std::vector<int> joints_with_skin(const Character& character);

// Per joint, whether all joints that skin follows are at or below it. Like a root, it then moves all of the skin and
// bends none of it.
std::vector<bool> joints_of_all_skin(const Character& character);

// The joints that describe a pose: all but roots and those of all skin, ascending.
std::vector<std::uint32_t> joints_that_bend(const Character& character);

// Regions to begin painting from: one for every joint, roots apart, that moves as much skin as 40 vertices, by skin
// weights. Skin of others goes to the nearest joint above that has a region, or the root. They are on welded vertices,
// by joint; a partition of unity.
std::vector<RegionWeights> joint_regions(const Character& character);

}  // namespace bodyopt
