// The poses of a database as points of a plane: along the two directions in which the joints that move a part of the
// skin vary most.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "trainer/curate/local_models.h"

namespace bodyopt {

struct PoseMap {
  Eigen::MatrixX2d places;      // N, degrees, around their mean
  std::vector<int> neighbours;  // N: other frames whose poses are near
};

// Root mean square distance of poses from their mean, in all directions, degrees.
double pose_spread(const PoseDatabase& database, const SkinPart& part);

// `degrees`: how far poses are near.
PoseMap pose_map(const PoseDatabase& database, const SkinPart& part, double degrees);

}  // namespace bodyopt
