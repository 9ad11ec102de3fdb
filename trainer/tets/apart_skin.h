// Skin that moves of the joints part, however near to each other it lies at rest.
#pragma once

#include "geometry/nearest_skin.h"
#include "geometry/surface_distance.h"

namespace bodyopt {

constexpr double kSharedByOne = 0.6;  // of the weights of two points in common: less is skin of other joints
constexpr double kDetour = 3;         // along the skin, times the way through the air: further is not beside it

// Whether two points of a skin (rest, metres) follow other joints and are far from each other along it, as lips, thighs
// and fingers that touch are; about a joint they are not. Nor are those between which flesh lies, as in and out of a
// cheek: one is behind the other by more than `overlap` metres. The arrays must outlive this.
class ApartSkin {
 public:
  ApartSkin(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights);
  bool operator()(const SkinPoint& a, const SkinPoint& b, double overlap) const;

 private:
  std::vector<JointWeight> weights_at(const SkinPoint& point) const;
  double depth(const SkinPoint& point, const SkinPoint& other) const;

  const Positions& vertices_;
  const SkinWeights& weights_;
  double outwards_;  // 1 where triangles wind outwards, else -1
  SurfaceDistance distance_;
};

}  // namespace bodyopt
