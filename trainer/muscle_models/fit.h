// A muscle model fitted to a character.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "trainer/muscle_models/mapping.h"
#include "trainer/muscle_models/model.h"

namespace bodyopt::trainer::muscle_models {

struct FittedMuscle {
  Muscle muscle;
  double full_radius = 0;   // metres: of a round belly with the muscle's cross-section, before it is fitted in
  double largest_push = 0;  // metres: how far a point was moved to lie under the skin
};

// Fits the model in its default pose to a character. An affine map takes each segment by its joint centres to the
// character's (mapping). Points are pushed under the skin, radii follow from the largest forces and are made to fit.
// Throws Error(mismatch) naming the muscle, segment or joint when model, mapping and character do not belong together.
std::vector<FittedMuscle> fit_muscles(const Model& model, const Mapping& mapping, const Character& character);

// The affine map that takes some points to others.
struct Alignment {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // its rotation
  double scale = 1;                                    // of lengths, the mean over all directions
};

// The best similarity of `from` to `to` (two points or more, the first two apart), corrected by the smallest linear map
// that takes points exactly. If they are too many or too nearly on a line for that, it does so as well as it can. It
// turns by `turn` where the points leave that open.
Alignment align(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to,
                const Eigen::Matrix3d& turn);

}  // namespace bodyopt::trainer::muscle_models
