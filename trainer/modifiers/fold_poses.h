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

// Direction by direction, each by all angles. None of a joint without a parent or a bone.
std::vector<Pose> bent_poses(const Skeleton& skeleton, std::uint32_t joint, const FoldBends& bends);

// The joints along the skeleton from one to another, over what both hang on, but for that.
std::vector<std::uint32_t> joints_between(const Skeleton& skeleton, std::uint32_t from, std::uint32_t to);

// The triangles of a basis' skin that follow joints no more than three steps from one, along the skeleton: those whose
// folds a bend of it makes.
std::vector<std::uint32_t> triangles_near(const Basis& basis, std::uint32_t joint);

}  // namespace bodyopt
