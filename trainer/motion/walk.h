// From one pose to the next in small steps.
#pragma once

#include "trainer/motion/limited_pose.h"

namespace bodyopt {

// The largest change of any angle, degrees.
double largest_change(const Angles& from, const Angles& to);

// That of any angle or of any joint's deviation.
double largest_change(const Posture& from, const Posture& to);

// Number of steps of at most `step` degrees.
std::size_t steps_between(const Angles& from, const Angles& to, double step);

// Appends evenly spaced angles after `from` up to `to` itself; nothing when they are the same.
void walk(const Angles& from, const Angles& to, double step, std::vector<Angles>& frames);

}  // namespace bodyopt
