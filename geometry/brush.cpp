#include "geometry/brush.h"

#include <algorithm>
#include <utility>

#include "geometry/mesh.h"

namespace bodyopt {
namespace {

constexpr double kInflates = 0.05;  // of the radius, a touch

// 1 at 0, flat there and at 1, where it is 0.
double falloff(double way) {
  const double near = 1 - std::min(way, 1.0);
  return near * near * (3 - 2 * near);
}

}  // namespace

BrushStroke::BrushStroke(const SurfaceDistance& paths, const Triangles& triangles, Positions surface, Positions erased,
                         const Brush& brush)
    : paths_(paths),
      triangles_(triangles),
      surface_(std::move(surface)),
      erased_(std::move(erased)),
      held_surface_(surface_),
      brush_(brush) {}

void BrushStroke::touch(std::span<const SkinPoint> hands) {
  hands_.clear();
  for (const SkinPoint& point : hands) hands_.push_back(hold(point));
  held_surface_ = surface_;
  if (brush_.kind == BrushKind::grab) return;
  std::vector<Positions> moves;
  for (const Hand& hand : hands_) moves.push_back(moves_of(hand));
  move(moves);
}

void BrushStroke::pull(std::span<const Eigen::Vector3d> ways) {
  if (brush_.kind != BrushKind::grab) return;
  std::vector<Positions> moves;
  for (std::size_t h = 0; h < hands_.size(); ++h) {
    moves.push_back(ways[h].transpose().replicate(static_cast<Eigen::Index>(hands_[h].size()), 1));
  }
  move(moves);
}

BrushStroke::Hand BrushStroke::hold(const SkinPoint& point) const {
  Hand hand;
  if (!(brush_.radius > 0)) return hand;
  for (const SurfacePlace& place : paths_.around(surface_, point, brush_.radius)) {
    const double share = falloff(place.distance / brush_.radius);
    if (share > 0) hand.push_back({place.vertex, share});
  }
  return hand;
}

// Displacements of what a hand holds, before strength and shares: one row for each.
Positions BrushStroke::moves_of(const Hand& hand) const {
  Positions moves(static_cast<Eigen::Index>(hand.size()), 3);
  const Positions normals = vertex_normals(surface_, triangles_).rowwise().normalized();
  Eigen::RowVector3d middle = Eigen::RowVector3d::Zero(), across = middle;
  double sum = 0;
  for (const Held& held : hand) {
    middle += held.share * surface_.row(held.vertex);
    across += held.share * normals.row(held.vertex);
    sum += held.share;
  }
  middle /= std::max(sum, 1e-300);
  across.normalize();
  for (Eigen::Index k = 0; k < moves.rows(); ++k) {
    const std::uint32_t v = hand[static_cast<std::size_t>(k)].vertex;
    const Eigen::RowVector3d normal = normals.row(v);
    switch (brush_.kind) {
      case BrushKind::smooth:
        moves.row(k) = towards_neighbours(v).dot(normal) * normal;
        break;
      case BrushKind::inflate:
        moves.row(k) = kInflates * brush_.radius * normal;
        break;
      case BrushKind::flatten:
        moves.row(k) = (middle - surface_.row(v)).dot(across) * across;
        break;
      case BrushKind::erase:
        moves.row(k) = erased_.row(v) - surface_.row(v);
        break;
      case BrushKind::grab:
        moves.row(k).setZero();
        break;
    }
  }
  return moves;
}

Eigen::RowVector3d BrushStroke::towards_neighbours(std::uint32_t vertex) const {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  int count = 0;
  paths_.visit_ring(vertex, [&](std::uint32_t other) {
    sum += surface_.row(other);
    ++count;
  });
  return sum / std::max(1, count) - surface_.row(vertex);
}

void BrushStroke::move(const std::vector<Positions>& moves) {
  Positions sum = Positions::Zero(surface_.rows(), 3);
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(surface_.rows());
  for (std::size_t h = 0; h < hands_.size(); ++h) {
    for (std::size_t k = 0; k < hands_[h].size(); ++k) {
      const auto& [vertex, share] = hands_[h][k];
      sum.row(vertex) += share * moves[h].row(static_cast<Eigen::Index>(k));
      shares[vertex] += share;
    }
  }
  surface_ = held_surface_ + Positions((brush_.strength / shares.array().max(1.0)).matrix().asDiagonal() * sum);
}

}  // namespace bodyopt
