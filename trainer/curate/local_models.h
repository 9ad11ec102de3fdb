// Mixed models (Henderson 1975; Sacks et al. 1989) of what passes of the motion by a pose disagree in. Near a frame, a
// part of the skin has the shapes y_m = a + g(f_m, h_m) + o_pass(m) + e_m. Here a is a mean, g varies smoothly with the
// pose, o is what each pass is off by, and e is noise. Variances: cov g = exp(-(|f - f'|^2 + r |h - h'|^2) / 2 l^2),
// var o = p, var e = s / w_m. The turns f are of the joints that move the part. The turns h of others count r times as
// much: soft tissue and coarse cages carry far. Parameters l, r, p and s are what makes the shapes of all
// neighbourhoods of the part likeliest (restricted likelihood, Patterson & Thompson 1971). Where shapes vary with the
// pose alone, p is zero, and nothing is found. A variogram's nugget (Matheron 1963) of frames in the same pose bounds
// p: smooth functions do not bend as shapes do where skin touches skin. A pass is a stretch of a take in one direction:
// its frames share what they have of history. What slopes and curves with the pose is in all passes and stays; o is
// what one alone has. The model is linear in the shapes: o at a frame is sum_m s_m y_m.
#pragma once

#include <vector>

#include "geometry/region_weights.h"
#include "trainer/curate/pose_database.h"
#include "trainer/train/regression/components.h"

namespace bodyopt::trainer {

// How far poses are that are alike, where nobody says.
constexpr double kAlikeDegrees = 20;
// How far consistency moves a vertex at most, where nobody says.
constexpr double kUsualCapMm = 20;

struct FrameShare {
  std::size_t frame = 0;
  double share = 0;
};

// A part of the skin and the joints that move it.
struct SkinPart {
  RegionWeights region;               // welded vertices
  std::vector<std::uint32_t> joints;  // its pose space: those that move it, and the nearest beside them that turn
  std::vector<std::uint32_t> others;  // that turn, too, and may move it from afar
};

// Painted regions, where they cover the skin; otherwise the joints' own skin weights. Weights sum to 1 at most.
std::vector<SkinPart> skin_parts(const PoseDatabase& database);

struct LocalModels {
  // The shares of frames' displacements that add up to the effect of every frame's pass; none where no other passes by.
  std::vector<std::vector<FrameShare>> shares;
  std::vector<std::vector<std::size_t>> others;  // of every frame: those of other passes near it, the nearest first
  std::vector<int> neighbours;                   // how many frames are near
  // How many frames have one of another pass in the same pose. None: nothing tells history from what is another in
  // another pose, and all shares are 0.
  std::size_t same_pose = 0;
};

// `degrees`: how far frames are that say nothing. Frames that are not `used` are left out; the effects of passes with
// `anchors` vary by a tenth. `displacements`: N x 3V.
LocalModels local_models(const PoseDatabase& database, const SkinPart& part, double degrees,
                         const std::vector<char>& used, const std::vector<char>& anchors,
                         const Displacements& displacements);

}  // namespace bodyopt::trainer
