// A character's left for its right: poses and shapes as in a mirror.
#pragma once

#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "geometry/mesh.h"
#include "geometry/nearest_skin.h"

namespace bodyopt::trainer {

// Whether every vertex of the rest skin has its mirror image on the skin, and every joint at its counterpart: to a
// thousandth and a hundredth of the character's size.
bool is_own_mirror_image(const Character& character);

// Mirrors across the plane x = that of the middle of the rest skin.
class MirrorImage {
 public:
  // Throws Error(mismatch), naming a joint or vertex, where the skeleton or the skin is not its own mirror image. A
  // joint may be 2 % of the character's size from any image, a vertex 5 %.
  MirrorImage(const Character& character, const std::vector<std::string>& controls);

  // Joints turn, and move against their parents, as their counterparts do in the mirror.
  Pose pose(const Pose& pose) const;
  // V x 3, posed, of the mirrored pose.
  Positions shape(const Positions& shape) const;

 private:
  Vec3 moved_from_bind(const Pose& pose, std::size_t joint, const std::vector<Quat>& bind) const;

  const Skeleton& skeleton_;
  double middle_ = 0;                     // metres
  std::vector<std::size_t> counterpart_;  // of every joint
  std::vector<std::size_t> control_counterpart_;
  std::vector<SkinPoint> image_;  // of every vertex the point of the skin that is its mirror image
};

}  // namespace bodyopt::trainer
