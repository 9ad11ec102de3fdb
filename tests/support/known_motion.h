// A motion that is known, in a BVH file as one program or another might write it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "assets/clips/clip.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt::testing {

struct KnownMotion {
  std::string bvh, what;  // the file; how it came to be
  double fps = 24;
  Skeleton skeleton;  // whom it is carried to
  // What comes out right, per frame: world rotations of the skeleton's joints; the first one's place, metres.
  std::vector<std::vector<Quat>> rotations;
  std::vector<Vec3> places;
};

// Everything that the file and the skeleton leave open is random: the axis that is up, the unit, orders of channels,
// fingers, joints with positions, offsets or none beside them; how the file's zero pose stands (T, A, arms down, lying)
// or that it is none, bones along an axis of their joints or joints turned at random; how the skeleton is bound, which
// way it faces and the axes of its joints.
KnownMotion known_motion(std::uint32_t seed);

// What is wrong by more than half a degree or a thousandth of the body's height; empty: nothing.
std::string wrong_in(const KnownMotion& known, const Clip& clip);

// Whether a note asks which axis is up: the body may lie, and has no floor under it that would tell.
bool asks_for_up(const Clip& clip);

}  // namespace bodyopt::testing
