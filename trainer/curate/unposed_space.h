// The space in which modifiers act: a shape as the displacement of the rest skin that Direct Delta Mush of the default
// radius poses into it. There and back is an isometry: what is not touched stays where it is to 1e-7 of its size.
#pragma once

#include <vector>

#include "assets/character.h"
#include "runtime/basis/basis.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {

class UnposedSpace {
 public:
  explicit UnposedSpace(const Character& character);
  // `ddm`: what build_ddm_basis() makes of the character without options, where that is there already.
  UnposedSpace(const Character& character, Basis ddm);

  // Rotation and translation of every vertex in one pose.
  class Frame {
   public:
    Positions offsets(const Positions& shape) const;  // V x 3 posed -> V x 3 un-posed, metres
    Positions shape(const Positions& offsets) const;  // and back
    // How a vertex is turned, un-posed to posed.
    const Eigen::Matrix3d& rotation(std::size_t vertex) const { return placements_[vertex].rotation; }

   private:
    friend class UnposedSpace;
    std::vector<VertexPlacement> placements_;  // V, welded
  };
  // Throws Error(mismatch) where the pose is of another skeleton.
  Frame frame(const Pose& pose) const;

 private:
  Basis basis_;
  std::vector<std::uint32_t> order_;  // welded vertex of each runtime vertex
};

}  // namespace bodyopt
