// Random tets, and what hangs on them, for the kernel tests of diffuse and jiggle.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/basis/dynamics.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {

// Point k of an array of points.
Eigen::Vector3d point_of(std::span<const float> values, std::size_t k);

void append_point(std::vector<float>& values, const Eigen::Vector3d& point);

// Columns: the edges from corner 0 to the others.
Eigen::Matrix3d tet_edges(std::span<const float> nodes, const std::uint32_t* corners);

// shapes, corner_begin and corners of the nodes and tets there are.
void complete_tets(TetTable& table);

// Nodes in a box, as many tets, of any of them (over one another; some nodes in none), none flat.
TetTable random_tets(Random& random, std::uint32_t nodes);

// Skin vertices in the tets and a little outside; every third takes nothing of its tet's displacement.
std::vector<TetPoint> random_tet_points(Random& random, std::uint32_t tets, std::uint32_t vertices);

// Every node somewhere on the skin.
std::vector<SurfacePoint> random_surface_points(Random& random, std::uint32_t vertices, std::uint32_t nodes);

}  // namespace bodyopt::testing
