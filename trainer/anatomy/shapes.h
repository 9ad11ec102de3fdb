// Signed distances to the simple shapes that bones are put together of: negative inside, metres.
#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <vector>

namespace bodyopt {

double sphere_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& centre, double radius);
// Between two balls; linear in between (not the exact distance to a cone).
double cone_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius_a,
                     double radius_b);
struct ChainLink {
  Eigen::Vector3d place;
  double radius;
};
double chain_distance(const Eigen::Vector3d& point, const std::vector<ChainLink>& links);
// axes: unit, by rows. Exact on the surface only.
double ellipsoid_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& centre, const Eigen::Matrix3d& axes,
                          const Eigen::Vector3d& radii);
// A triangle, thickened on either side by `half`.
double plate_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c, double half);

}  // namespace bodyopt
