// A muscle model carried to a character.
#pragma once

#include <vector>

#include "assets/character.h"
#include "assets/muscles.h"
#include "trainer/muscle_models/mapping.h"
#include "trainer/muscle_models/model.h"

namespace bodyopt::muscle_models {

struct FittedMuscle {
  Muscle muscle;
  double full_radius = 0;   // metres: of a round belly with the muscle's cross-section, before it is fitted in
  double largest_push = 0;  // metres: how far a point was moved to lie under the skin
};

// The model in its default pose, each segment carried by the affine map that takes its joint centres to the
// character's (mapping), points pushed under the skin, radii from the largest forces and made to fit.
// Throws Error(mismatch) naming the muscle, segment or joint when model, mapping and character do not belong together.
std::vector<FittedMuscle> fit_muscles(const Model& model, const Mapping& mapping, const Character& character);

}  // namespace bodyopt::muscle_models
