// Skin weights by diffusion along the skin.
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "trainer/builtin/implicit.h"

namespace bodyopt {

// The space that moves with a joint, and how softly the skin goes over into that of the neighbouring joints.
struct JointRegion {
  Solid solid;
  double softness = 0.02;  // metres: standard deviation of the diffusion
};

// Each vertex starts with the joint whose solid is nearest; the weights then spread by heat flow on the surface, so
// that nothing leaks through the air of the armpit or between fingers. One region per joint. Returns V lists of at most
// 6, descending, sum 1.
std::vector<std::vector<JointWeight>> diffuse_weights(const Positions& vertices, const Triangles& triangles,
                                                      const std::vector<JointRegion>& regions);

}  // namespace bodyopt
