// What the frames around a frame say of its shape: per part of the skin, a local affine model of shape over pose.
//   y(f) = a + B f  by weighted least squares over the frames near in the part's pose space (Cleveland & Devlin 1988),
// which is linear in the shapes: the model at the frame itself is sum_m s_m y_m.
// A motion that passes by counts once, however many frames it has there: frames beside each other in time share what
// they have of history, and agree where passes do not.
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
  std::vector<std::uint32_t> joints;  // its pose space
};

// Painted regions, where they cover the skin; otherwise the joints' own skin weights. Weights sum to 1 at most.
std::vector<SkinPart> skin_parts(const PoseDatabase& database);

struct LocalModels {
  std::vector<std::vector<FrameShare>> shares;   // of every frame; none where nothing else passes by its pose
  std::vector<std::vector<std::size_t>> others;  // of every frame: those of other passes near it, the nearest first
  std::vector<int> neighbours;                   // how many frames are near
};

// `degrees`: how far frames are that say nothing. Frames that are not `used` are left out; `anchors` count ten times.
LocalModels local_models(const PoseDatabase& database, const SkinPart& part, double degrees,
                         const std::vector<char>& used, const std::vector<char>& anchors);

}  // namespace bodyopt
