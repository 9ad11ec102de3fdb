// The shapes of a breath, learnt of frames in which the skin breathes.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

struct LearntBreath {
  std::vector<Positions> shapes;  // kBreathShapes, V x 3: beyond the skin that is breathed out
  double litres = 0;              // between the emptiest frame and the fullest
};

// offsets: of consecutive frames, V x 3 each, un-posed, what their skin has beyond that of the same pose. How far a
// frame is filled is told by the volume that the skin encloses, and whether the breath comes in by the frames beside
// it; the shapes are those that fit all frames best. Throws Error(mismatch), naming `place`, where the skin gains no
// volume, or there is no whole breath.
LearntBreath learn_breath(const Positions& rest, const Triangles& triangles, const std::vector<Positions>& offsets,
                          const std::string& place);

}  // namespace bodyopt
