#include "geometry/extent.h"

namespace bodyopt {

Eigen::RowVector3d box_sides(const Positions& points) {
  if (points.rows() == 0) return Eigen::RowVector3d::Zero();
  return points.colwise().maxCoeff() - points.colwise().minCoeff();
}

double longest_extent(const Positions& points) { return box_sides(points).maxCoeff(); }

double box_diagonal(const Positions& points) { return box_sides(points).norm(); }

}  // namespace bodyopt
