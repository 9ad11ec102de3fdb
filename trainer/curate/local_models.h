// What passes of the motion by a pose disagree in: per part of the skin, a local affine model of shape over pose
// (weighted least squares over the frames near in the part's pose space, Cleveland & Devlin 1988) with an effect of
// each pass,
//   y_m = a + B f_m + o_pass(m),   min sum_m w_m |y_m - a - B f_m - o|^2 + kappa |B|^2 + lambda sum_p |o_p|^2,
// a mixed model (Henderson 1975). A pass is a stretch of a take in one direction: its frames share what they have of
// history. What slopes and curves along a pass is in all of its frames and stays; o is what it alone has. Linear in the
// shapes: o at a frame is sum_m s_m y_m.
#pragma once

#include <vector>

#include "geometry/region_weights.h"
#include "trainer/curate/pose_database.h"

namespace bodyopt {

struct FrameShare {
  std::size_t frame = 0;
  double share = 0;
};

// A part of the skin and the joints that move it.
struct SkinPart {
  RegionWeights region;               // welded vertices
  std::vector<std::uint32_t> joints;  // its pose space: those that move it, and those next to them
};

// Painted regions, where they cover the skin; otherwise the joints' own skin weights. Weights sum to 1 at most.
std::vector<SkinPart> skin_parts(const PoseDatabase& database);

struct LocalModels {
  // Of every frame: what of whose displacements adds up to the effect of its pass; none where no other passes by.
  std::vector<std::vector<FrameShare>> shares;
  std::vector<std::vector<std::size_t>> others;  // of every frame: those of other passes near it, the nearest first
  std::vector<int> neighbours;                   // how many frames are near
};

// `degrees`: how far frames are that say nothing. Frames that are not `used` are left out; effects of passes with
// `anchors` weigh ten times.
LocalModels local_models(const PoseDatabase& database, const SkinPart& part, double degrees,
                         const std::vector<char>& used, const std::vector<char>& anchors);

}  // namespace bodyopt
