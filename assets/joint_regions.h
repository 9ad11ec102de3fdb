// Regions of the skin by the joints that it follows: to begin painting from.
#pragma once

#include <vector>

#include "assets/character.h"
#include "geometry/region_weights.h"

namespace bodyopt {

// A region for every joint that moves as much skin as 40 vertices, by skin weights; what less skin follows goes to the
// nearest joint above that has a region. On welded vertices, by joint; a partition of unity.
std::vector<RegionWeights> joint_regions(const Character& character);

}  // namespace bodyopt
