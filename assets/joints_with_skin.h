// Which joints move skin, which all of it, and what skin each moves.
#pragma once

#include <cstdint>
#include <vector>

#include "assets/character.h"
#include "geometry/region_weights.h"

namespace bodyopt {

// Of every joint, how many joints that skin follows, by more than a trace, are at or below it.
std::vector<int> joints_with_skin(const Character& character);

// Of every joint, whether all joints that skin follows are at or below it: it moves all of the skin and bends none of
// it, as a root does, wherever it stands.
std::vector<bool> joints_of_all_skin(const Character& character);

// The joints that a pose is told by: all but roots and those of all skin, ascending.
std::vector<std::uint32_t> joints_that_bend(const Character& character);

// Regions to begin painting from: one for every joint that moves as much skin as 40 vertices, by skin weights; what
// less skin follows goes to the nearest joint above that has a region. On welded vertices, by joint; a partition of
// unity.
std::vector<RegionWeights> joint_regions(const Character& character);

}  // namespace bodyopt
