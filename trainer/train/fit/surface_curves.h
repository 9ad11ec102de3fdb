// Strains where no muscle is: curves drawn across the parts of the skin that move in ways nothing explains yet.
#pragma once

#include <vector>

#include "assets/muscles.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/options.h"

namespace bodyopt {

// At most options.surface_curves pairs of curves, named "surface 1 along", "surface 1 across": along the bone of the
// joint that moves the place most, and across it. They are put, one after the other, where the un-posed motion is
// largest that a linear map of all features (fitted to other frames) leaves, and not near those before. Shows progress.
// Throws as train().
std::vector<Muscle> surface_curves(const SampleSet& set, const TrainOptions& options);

// How many pairs a character without muscles needs: 40 where a linear map of its joints leaves more than a third of the
// un-posed motion of other frames (root mean square); none where it leaves less, and of fewer than 80 or more than 800
// frames. Shows progress. Throws as train().
int needed_surface_curves(const SampleSet& set, const TrainOptions& options);

// A curve through points on the skin, as a muscle of one fibre.
inline Muscle surface_curve(const std::string& name, std::vector<MusclePoint> path) {
  Muscle muscle;
  muscle.name = name;
  muscle.path = std::move(path);
  muscle.radius = 0;
  muscle.fibre_count = 1;
  return muscle;
}

}  // namespace bodyopt
