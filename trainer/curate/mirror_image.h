// A character's left for its right: poses and shapes as in a mirror.
#pragma once

#include <string>
#include <vector>

#include "assets/character.h"
#include "geometry/nearest_skin.h"

namespace bodyopt {

// Across the plane x = that of the middle of the rest skin.
class MirrorImage {
 public:
  // Throws Error(mismatch), naming a joint, where the skeleton or the skin is not its own mirror image: a joint is 2 %
  // of the character's size from any image, a vertex 5 %.
  MirrorImage(const Character& character, const std::vector<std::string>& controls);

  // Joints turn as their counterparts do in the mirror; lengths of bones stay their own.
  Pose pose(const Pose& pose) const;
  // V x 3, posed, of the mirrored pose.
  Positions shape(const Positions& shape) const;

 private:
  const Skeleton& skeleton_;
  double middle_ = 0;                     // metres
  std::vector<std::size_t> counterpart_;  // of every joint
  std::vector<std::size_t> control_counterpart_;
  std::vector<SkinPoint> image_;  // of every vertex the point of the skin that is its mirror image
};

}  // namespace bodyopt
