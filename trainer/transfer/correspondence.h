// Matches each point of the target's skin to a point of the source's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/nearest_skin.h"
#include "runtime/basis/basis.h"
#include "trainer/transfer/match_skeletons.h"

namespace bodyopt::trainer {

// A point of the source's skin and the point of the target's that it is to be, by the numbers of output vertices.
struct SkinMarker {
  std::uint32_t source = 0, target = 0;
};

struct Correspondence {
  bool same_topology = false;
  Positions target;              // V' x 3, runtime order: the target's rest skin in the common pose, metres
  std::vector<Quat> rotation;    // V': of the target's skin, from its rest to the common pose
  Positions fitted;              // V x 3, runtime order: the source's rest skin, laid onto `target`
  std::vector<SkinPoint> at;     // V': where on the source's skin (runtime vertices and triangles)
  Eigen::VectorXd alike;         // V', 0 .. 1: in normal and joints, to the point of the source that it is
  Eigen::VectorXd source_alike;  // V, the same of the source's vertices, to the points of the target that they lie on
  Eigen::VectorXd confidence;    // V', 0 .. 1: how alike, and how near
  Eigen::VectorXd distance;      // V', metres: from the fitted source
  Eigen::VectorXd area;          // V', square metres: of the target's skin around each vertex, above 0
  std::vector<std::string> notes;

  // Weighed by area: a head of many vertices is not more of a body than it is.
  double mean_confidence() const { return confidence.size() == 0 ? 0 : confidence.dot(area) / area.sum(); }
};

// Less than this is unsure: what is carried there is filled in from around it, but for vertices of the same number.
constexpr double kSureConfidence = 0.4;

// The bases need skeleton, mesh and ddm. Output vertices and triangles of the same numbers mean the same vertices. A
// marker contradicts that further than 1.5 % of the target's size from the vertex of its number. The confidence of same
// vertices is how alike they are in joints, and in normal, with the source warped by the joints. Otherwise the source
// is warped by the joints, then laid onto the target from coarse to fine, through the markers. That is by non-rigid
// closest points (Amberg, Romdhani, Vetter 2007, with a membrane in place of affine maps). They are sought among
// triangles that face alike and are held by the same joints. Throws Error(mismatch) for markers that are not there.
Correspondence match_skins(const Basis& source, const Basis& target, const SkeletonMatch& match,
                           const std::vector<SkinMarker>& markers);

// V: of every vertex of the source the confidence of the target's skin where the source is laid onto it. `triangles`:
// T' x 3, the target's, runtime vertices.
Eigen::VectorXd source_confidence(const Correspondence& correspondence, const Triangles& triangles);

// Linear RGB of points by their place in the box around them. V x 3 metres to V x 3.
Positions place_colours(const Positions& rest);

// V' x 3: of every vertex of the target the colour of the point of the source that it is. `colours`: V x 3.
Positions matched_colours(const Correspondence& correspondence, const Positions& colours);

}  // namespace bodyopt::trainer
