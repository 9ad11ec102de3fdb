#include "trainer/modifiers/bones.h"

namespace bodyopt {

Vec3 bone_of(const Skeleton& skeleton, std::uint32_t joint) {
  const Vec3 own = bind_place(skeleton, joint);
  Vec3 sum{0, 0, 0};
  double children = 0;
  for (std::uint32_t other = 0; other < skeleton.size(); ++other) {
    if (skeleton.joints[other].parent != static_cast<int>(joint)) continue;
    sum = sum + (bind_place(skeleton, other) - own);
    ++children;
  }
  if (children > 0) return (1 / children) * sum;
  const int parent = skeleton.joints[joint].parent;
  return parent < 0 ? sum : own - bind_place(skeleton, static_cast<std::uint32_t>(parent));
}

}  // namespace bodyopt
