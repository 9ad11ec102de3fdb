// Direct Delta Mush (Le & Lewis 2019, v0) in the centred form: the moments, and their packing for the runtime.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

struct DdmOptions {
  double radius = 0.045;  // smoothing radius, metres
  int steps = 20;         // implicit smoothing steps
  double prune = 2e-5;    // joints with less omega at a vertex are dropped (1e-4 moves vertices by 2.4e-5 of the
                          // bounding box, this by 7e-6, for 6 % more bytes); 0 keeps all
};

// Moments of one joint at one vertex, around the vertex's centre, divided by its radius2 (omega is not).
struct JointMoments {
  std::uint32_t joint = 0;
  double omega = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

struct VertexMoments {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // p_i, rest space, metres
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // d_i
  double radius2 = 0;                                // square metres; 0 for a vertex without neighbours
  double kept = 0;                                   // sum of the omegas kept, before they were normalised: without
                                                     // pruning the row sum of B, which is 1
  std::vector<JointMoments> joints;                  // ascending; the omegas sum to 1
};

// Rest positions V x 3 (metres), triangles, weights of every vertex -> V.
std::vector<VertexMoments> ddm_moments(const Positions& rest, const Triangles& triangles,
                                       const std::vector<std::vector<JointWeight>>& weights, const DdmOptions& options);

DdmTable pack_ddm(const std::vector<VertexMoments>& moments);

// The default radius: 1/40 of the longest extent, so that a body of any size has the same shape.
double default_smoothing_radius(const Positions& rest);

}  // namespace bodyopt
