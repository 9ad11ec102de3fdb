// The shortest way around a sphere or a cylinder.
#pragma once

#include <optional>

#include "trainer/muscle_models/model.h"

namespace bodyopt::muscle_models {

struct Arc {
  Eigen::Vector3d from, to;  // where the path meets the surface and leaves it
  double length;             // on the surface
};

// How the straight path from `start` to `end` bends around the surface; nothing where it stays straight: it misses the
// surface, on the right side of it, or one of its ends lies inside. All in the surface's frame (a sphere about the
// origin, a cylinder without ends about the z axis), metres. A path with a side passes on that side; a side less than
// the radius from the origin makes it pass through the inside. The rule is MuJoCo's from 3.2.3 on (documentation,
// "tendon/spatial/geom/sidesite"); earlier, what counted was the side's distance in the plane of the bend.
std::optional<Arc> wrap_around(Wrap::Shape shape, double radius, const std::optional<Eigen::Vector3d>& side,
                               const Eigen::Vector3d& start, const Eigen::Vector3d& end);

}  // namespace bodyopt::muscle_models
