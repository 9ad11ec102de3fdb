// Regions of one piece each.
#pragma once

#include <vector>

#include "trainer/anatomy/muscle_candidates.h"

namespace bodyopt {

// Of each muscle's samples (label, L, -1: none's), the largest piece that is connected through faces stays; returns
// what falls away, and has no label.
std::vector<int> keep_largest_pieces(const LeanSamples& lean, std::size_t muscles, std::vector<int>& label);

// Loose samples go, the least distance first, to muscles that have a neighbour of theirs already, where they are nearer
// than `farthest` to the muscle's spindle (radii: M).
void grow_into(const LeanSamples& lean, const MuscleCandidates& candidates, const std::vector<double>& radii,
               double farthest, const std::vector<int>& loose, std::vector<int>& label);

}  // namespace bodyopt
