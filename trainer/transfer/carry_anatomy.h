// Muscles and painted regions, carried to another body.
#pragma once

#include <vector>

#include "assets/muscles.h"
#include "geometry/region_weights.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt {

// Each point goes with its joint, scaled as the joint's bones are, and from there as the skin around it does that the
// target has fitted otherwise (inverse distance to the fourth power, Shepard 1968). Radii are scaled alike. A muscle of
// a joint that the target does not have is held by the nearest joint above that it has; without one it is left out,
// with a note.
std::vector<Muscle> carried_muscles(const TransferPair& pair, const std::vector<Muscle>& muscles,
                                    std::vector<std::string>& notes);

// Regions on the source's runtime vertices to regions on the target's: as they are where the match is sure, elsewhere
// filled in smoothly.
std::vector<RegionWeights> carried_regions(const TransferPair& pair, const std::vector<RegionWeights>& regions);

}  // namespace bodyopt
