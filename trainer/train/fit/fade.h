// Fades what was learned to Direct Delta Mush (FadeTable in runtime/basis/basis.h).
#pragma once

#include <cstddef>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/train/fit/groundwork.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt::trainer {

// The joints' manifold, and how much every region of the model minds that a joint stands off it. It minds in proportion
// to the joint's part in what its features explain, and in its skin. That is per mean square that the joint turned in
// training, as strongly as fade_strengths() says.
// `folds`, `origins`: of every frame, as RegressionData and training_origins() have them.
FadeTable fade_table(const Groundwork& ground, const std::vector<RegionModel>& regions, const std::vector<int>& folds,
                     const std::vector<std::size_t>& origins);

// How strongly it fades: factors for the weights of each region in a fade table. A factor is 4, or as much less as
// frames ask for that are as far off as another shot's. Fifths of the frames, one after the other, are left out. The
// others say what was shown, and so fade what fits of them predict of the fifth. The strongest fade stays that leaves
// at most a hundredth more than the best. Where nothing tells, as in a range of motion that shows all that it holds
// out, that is 4. A correction by joints that stand as far off as they ever turned is as likely wrong as right. The
// factor is four times that because a wrong one is worse than none: measured on limits that couple joints. `regions`:
// components scaled, as fitted; `table`: its region weights for a strength of 1.
std::vector<double> fade_strengths(const Groundwork& ground, const std::vector<RegionModel>& regions,
                                   const std::vector<int>& folds, const std::vector<std::size_t>& origins,
                                   const FadeTable& table);

}  // namespace bodyopt::trainer
