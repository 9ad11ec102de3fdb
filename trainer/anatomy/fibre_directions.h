// The way of fibres inside a muscle's region.
#pragma once

#include <array>
#include <vector>

#include "trainer/anatomy/lean_samples.h"
#include "trainer/anatomy/muscle_paths.h"

namespace bodyopt {

// L x 3: unit, from origin to insertion, along the gradient of a harmonic function (Laplace's equation, no flux through
// the region's sides; Choi and Blemker 2013), zero without a label. It is 0 where the region touches the bone of the
// muscle's origin in the path's first half, 1 where it touches that of its insertion in the other; where there is no
// contact, on the outer 7 % along the path.
// label, along (L): each sample's muscle, and its place along that muscle's path, 0 to 1; joints (M): of the bones at
// origin and insertion.
Positions fibre_directions(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles,
                           const std::vector<std::array<int, 2>>& joints, const std::vector<int>& label,
                           const std::vector<double>& along);

}  // namespace bodyopt
