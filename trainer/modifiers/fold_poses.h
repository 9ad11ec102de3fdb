// Poses in which a character's skin folds.
#pragma once

#include <vector>

#include "geometry/skin_in_skin.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

// A joint bent one way: about an axis across its bone (unit, rest space).
struct FoldDirection {
  std::uint32_t joint;
  Vec3 axis;
};

// Evenly all around the joint's bone, from `first` degrees on. None of a joint without a parent or a bone.
std::vector<FoldDirection> fold_directions(const Skeleton& skeleton, std::uint32_t joint, double first);

// Whether what is buried is no fold any more, but a part of the body that goes through another: more than a tenth of it
// lies deeper than three tenths of the body's thickness. thickness: V, metres (geometry/thickness.h).
bool goes_through(const std::vector<BuriedVertex>& buried, const Eigen::VectorXd& thickness);

// Joints whose bone is longer than the body around it is thick, so that they may fold skin by themselves; others, of a
// spine, say, fold it together. thickness: as above.
std::vector<std::uint32_t> folding_joints(const Basis& basis, const Eigen::VectorXd& thickness);

// The bind pose, but for that joint, which is bent so many degrees.
Pose bent_pose(const Skeleton& skeleton, const FoldDirection& direction, double degrees);

// The bends that push-out is made of, and, between them, those that it is measured at.
inline constexpr double kFoldAngles[] = {40, 60, 80, 100, 120, 140}, kMeasuredAngles[] = {70, 110, 130};
inline constexpr double kFirstFold = 0, kFirstMeasured = 15;

// The joints along the skeleton from one to another, over what both hang on, but for that.
std::vector<std::uint32_t> joints_between(const Skeleton& skeleton, std::uint32_t from, std::uint32_t to);

// The triangles of a basis' skin that follow joints no more than three steps from one, along the skeleton: those whose
// folds a bend of it makes.
std::vector<std::uint32_t> triangles_near(const Basis& basis, std::uint32_t joint);

}  // namespace bodyopt
