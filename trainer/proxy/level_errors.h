// How far a level's skin, carried to the full one, is from it.
#pragma once

#include <vector>

#include "dataset/compare.h"
#include "runtime/basis/levels.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

// What the level's skin itself leaves: with every vertex of the proxy exactly where it is in the full shape. Of the
// samples of `full`, those of `proxy` being the same frames. `level` needs the mesh and where it carries the full skin.
double carried_rms_mm(const Level& level, const Character& full, const std::vector<Sample>& samples,
                      const std::vector<Sample>& proxy);

// What the level's result is off, on the CPU, over all samples of the full skin.
ErrorStatistics level_errors(const Level& level, const Character& full, const std::vector<Sample>& samples);

// At most `most` of the samples, spread evenly.
std::vector<Sample> some_samples(const std::vector<Sample>& samples, std::size_t most);

}  // namespace bodyopt
