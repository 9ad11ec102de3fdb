#include "tests/support/detached_limb.h"

#include <array>

#include "tests/support/capsule_limb.h"

namespace bodyopt {

Character detached_limb() {
  const Character limb = limb_character();
  Character character = limb;
  Joint root, tip = limb.skeleton.joints[2], body = limb.skeleton.joints[0], elbow = limb.skeleton.joints[1];
  root.name = "root";
  tip.parent = 0;
  tip.bind.translation[2] = 0.5;
  tip.default_local = tip.bind;
  body.parent = 0;
  elbow.parent = 2;
  character.skeleton.joints = {root, tip, body, elbow};
  for (auto& weights : character.weights) {
    for (JointWeight& weight : weights) weight.joint = std::array{2u, 3u, 1u}[weight.joint];
  }
  return character;
}

}  // namespace bodyopt
