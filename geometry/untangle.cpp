#include "geometry/untangle.h"

#include <vector>

#include "geometry/self_intersections.h"
#include "geometry/vertex_normals.h"

namespace bodyopt {
namespace {

constexpr int kRounds = 60, kRoundsPerRing = 12;
constexpr int kHalvings = 4;         // of a step, before it is given up
constexpr double kRoom = 2;          // a step is taken that may be so many times as long
constexpr double kInwards = 0.05;    // of the mean edge around a vertex, a round
constexpr double kSmoothing = 0.15;  // of the way to the middle of its neighbours, a round

std::vector<std::vector<std::uint32_t>> neighbours_of(Eigen::Index vertices, const Triangles& triangles) {
  std::vector<std::vector<std::uint32_t>> result(static_cast<std::size_t>(vertices));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) result[triangles(t, k)].push_back(triangles(t, (k + 1) % 3));
  }
  return result;
}

void mark_corners(const Triangles& triangles, const std::vector<TrianglePair>& pairs, std::vector<bool>& marked) {
  for (const TrianglePair& pair : pairs) {
    for (const Eigen::Index t : {pair.first, pair.second}) {
      for (int k = 0; k < 3; ++k) marked[triangles(t, k)] = true;
    }
  }
}

void mark_ring(const std::vector<std::vector<std::uint32_t>>& neighbours, std::vector<bool>& marked) {
  const std::vector<bool> before = marked;
  for (std::size_t v = 0; v < marked.size(); ++v) {
    if (!before[v]) continue;
    for (const std::uint32_t n : neighbours[v]) marked[n] = true;
  }
}

Positions stepped(const Positions& vertices, const Triangles& triangles,
                  const std::vector<std::vector<std::uint32_t>>& neighbours, const std::vector<bool>& marked) {
  const Positions normals = vertex_normals(vertices, triangles);
  Positions result = vertices;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    const std::vector<std::uint32_t>& around = neighbours[static_cast<std::size_t>(v)];
    if (!marked[static_cast<std::size_t>(v)] || around.empty()) continue;
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    double edge = 0;
    for (const std::uint32_t n : around) {
      middle += vertices.row(n) / static_cast<double>(around.size());
      edge += (vertices.row(n) - vertices.row(v)).norm() / static_cast<double>(around.size());
    }
    result.row(v) += kSmoothing * (middle - vertices.row(v)) - kInwards * edge * normals.row(v);
  }
  return result;
}

// So many steps, but none into another intersection.
void make_room(const Triangles& triangles, const std::vector<std::vector<std::uint32_t>>& neighbours,
               const std::vector<bool>& marked, int steps, Positions& vertices) {
  for (int step = 0; step < steps; ++step) {
    const Positions further = stepped(vertices, triangles, neighbours, marked);
    if (!self_intersections(further, triangles).empty()) return;
    vertices = further;
  }
}

}  // namespace

bool untangle(const Triangles& triangles, int room, Positions& vertices) {
  const auto neighbours = neighbours_of(vertices.rows(), triangles);
  std::vector<bool> marked(static_cast<std::size_t>(vertices.rows()), false);
  Positions moved = vertices;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<TrianglePair> pairs = self_intersections(moved, triangles);
    if (pairs.empty()) {
      if (round > 0) make_room(triangles, neighbours, marked, room, moved);
      vertices = moved;
      return true;
    }
    mark_corners(triangles, pairs, marked);
    if (round % kRoundsPerRing == 0) mark_ring(neighbours, marked);
    moved = stepped(moved, triangles, neighbours, marked);
  }
  return false;
}

void step_apart(const Triangles& triangles, Positions steps, Positions& vertices) {
  bool are_apart = false;
  for (int round = 0; !are_apart; ++round) {
    std::vector<bool> marked(static_cast<std::size_t>(vertices.rows()), false);
    for (const double far : {1.0, kRoom}) {
      mark_corners(triangles, self_intersections(vertices + far * steps, triangles), marked);
    }
    are_apart = true;
    for (Eigen::Index v = 0; v < steps.rows(); ++v) {
      if (!marked[static_cast<std::size_t>(v)] || steps.row(v).isZero(0)) continue;
      steps.row(v) *= round < kHalvings ? 0.5 : 0.0;
      are_apart = false;
    }
  }
  vertices += steps;
}

}  // namespace bodyopt
