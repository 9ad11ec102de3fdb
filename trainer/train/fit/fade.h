// Where what was learned fades to Direct Delta Mush (FadeTable in runtime/basis/basis.h).
#pragma once

#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/train/fit/groundwork.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt {

// The joints' manifold, and how much every region of the model minds that a joint stands off it: in proportion to the
// joint's part in what the region's features explain, and in its skin, per mean square that the joint turned in
// training, as strongly as fade_strengths() says.
FadeTable fade_table(const Groundwork& ground, const std::vector<RegionModel>& regions, const std::vector<int>& folds);

// That of some of its regions, ascending.
FadeTable fade_of(const FadeTable& table, const std::vector<std::size_t>& regions);

}  // namespace bodyopt
