// Isotropic remeshing: well-shaped triangles of wanted sizes on a surface.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

namespace bodyopt {

struct Surface {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise seen from outside
};

using Project = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;  // a point near the surface onto it
using EdgeLength = std::function<double(const Eigen::Vector3d&)>;        // metres, wanted at a point

// Splits long edges, collapses short ones, flips, and moves points along the surface and back onto it (Botsch and
// Kobbelt 2004). Keeps the surface closed, manifold and of the same genus. `surface` has to be closed.
Surface remesh(Surface surface, const Project& project, const EdgeLength& edge_length, int rounds);

}  // namespace bodyopt
