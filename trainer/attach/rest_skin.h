// A basis' skin at rest, as meshes that are to ride on it see it.
#pragma once

#include <vector>

#include "geometry/nearest_skin.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

class RestSkin {
 public:
  explicit RestSkin(const Basis& basis);
  RestSkin(const RestSkin&) = delete;
  RestSkin& operator=(const RestSkin&) = delete;

  const Skeleton& skeleton() const { return skeleton_; }
  double diagonal() const { return diagonal_; }  // of its bounding box, metres

  SkinPoint nearest(const Eigen::Vector3d& point) const { return search_(point); }
  // Of skin that faces as `normal` does, where that is no more than twice as far as the nearest: so a sleeve finds the
  // arm, and not the flank beside it, and a lining the skin under it, and not the other side of the body.
  SkinPoint facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

  Eigen::Vector3d normal(const SkinPoint& point) const;  // interpolated; unit, or zero
  // By joint, 1 in sum: how much each moves the skin there, as Direct Delta Mush has smoothed the skin weights.
  std::vector<double> joint_weights(const SkinPoint& point) const;

 private:
  const Skeleton& skeleton_;
  const DdmTable& ddm_;
  Positions vertices_, normals_;
  Triangles triangles_;
  double diagonal_;
  NearestSkin search_;
};

}  // namespace bodyopt
