// The residual: what shapes are beyond Direct Delta Mush, learned region by region.
#pragma once

#include <cstdint>
#include <vector>

#include "trainer/train/train.h"

namespace bodyopt {

// Fills basis.residual; basis.mesh, ddm and strain must be there. `character` in runtime order; `order`: welded vertex
// of each runtime vertex; samples in time order. Throws Error(mismatch) for poses that do not fit together.
void train_residual(Basis& basis, const Character& character, const std::vector<std::uint32_t>& order,
                    const std::vector<Sample>& samples, const TrainOptions& options);

}  // namespace bodyopt
