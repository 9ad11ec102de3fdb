// Poses in which a character's skin folds.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// One joint bent, and no other: about axes across its bone, evenly all around it from `first_direction` degrees on, by
// each of the angles (degrees).
struct FoldBends {
  double first_direction;
  std::vector<double> angles;
};

// Those that push-out is made of, and, between them, those that it is measured at.
inline const FoldBends kFoldBends{0, {50, 90, 130}}, kMeasuredBends{30, {70, 110}};

std::vector<Pose> bent_poses(const Skeleton& skeleton, std::uint32_t joint, const FoldBends& bends);

// The triangles of a basis' skin that follow joints no more than three steps from one, along the skeleton: those whose
// folds a bend of it makes.
std::vector<std::uint32_t> triangles_near(const Basis& basis, std::uint32_t joint);

}  // namespace bodyopt
