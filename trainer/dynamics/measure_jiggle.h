// What diffuse and jiggle do in a frame.
#pragma once

namespace bodyopt {

struct Dynamics;
struct NodeMotion;

struct JiggleMeasure {
  std::uint32_t inverted_tets = 0;  // inside out where diffuse carries them
  double rms_mm = 0, max_mm = 0;    // of the skin's vertices, from the quasi-static skin
  // Vertices that without their limit would move beyond it, and the one of these
  // that would go furthest for it, in runtime order.
  std::uint32_t limited = 0, most_limited = 0;
};

// motion: after the frame, as JiggleState holds it.
JiggleMeasure measure_jiggle(const Dynamics& dynamics, const NodeMotion& motion);

}  // namespace bodyopt
