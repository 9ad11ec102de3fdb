// What is left of the motion when a residual keeps no more than a selection, as cross-validation expects it.
#pragma once

#include <vector>

#include "trainer/train/pack/residual.h"

namespace bodyopt {

// Root mean square (metres) of what a selection leaves of the displacements, over the vertices and at most 400 frames
// that cross-validation held out. An estimate: the motion that no component of a region holds is taken to agree with
// that of the regions it overlaps, and rounding to bytes to cost nothing.
double expected_error(const ResidualModel& model, const Selection& selection);

// Of one region in every frame, square metres over its vertices; without its prediction's error in frames that no fold
// held out.
std::vector<double> frame_energies(const RegionModel& region, const SelectedRegion& selected);

}  // namespace bodyopt
