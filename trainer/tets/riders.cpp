#include "trainer/tets/riders.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/linear_algebra.h"
#include "geometry/nearest_skin.h"
#include "geometry/surface_pieces.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr double kTouching = 0.5;   // of a piece's mean edge: further than the nearest by more is not held
constexpr double kAgreeing = 0.5;   // of the best agreement with the joints beneath: less is not held
constexpr double kHeld = 1e4;       // times the pull of the edges around: held as well as exactly
constexpr double kShortest = 1e-3;  // of the mean edge: shorter ones pull no harder

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// Each once, by the vertices that stand for merged ones.
std::set<Edge> edges_of(const Triangles& triangles, const std::vector<std::uint32_t>& first) {
  std::set<Edge> edges;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = first[triangles(t, k)], b = first[triangles(t, (k + 1) % 3)];
      if (a != b) edges.insert(std::minmax(a, b));
    }
  }
  return edges;
}

class RiderSystem {
 public:
  RiderSystem(const FillableSkin& fillable, const Positions& vertices, const Triangles& triangles,
              const SkinWeights& weights)
      : fillable_(fillable), vertices_(vertices), weights_(weights), unknown_(fillable.host.size(), -1) {
    for (std::uint32_t v = 0; v < unknown_.size(); ++v) {
      if (fillable.host[v] >= 0 || fillable.first[v] != v) continue;
      unknown_[v] = static_cast<int>(standing_.size());
      standing_.push_back(v);
    }
    pull_.assign(standing_.size(), 0);
    find_pieces(edges_of(triangles, fillable.first));
    hold_pieces();
  }

  int unknown(std::uint32_t vertex) const { return unknown_[fillable_.first[vertex]]; }

  Eigen::SparseMatrix<double> pulls() const {
    const auto size = static_cast<Eigen::Index>(standing_.size());
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(pulls_.begin(), pulls_.end());
    return matrix;
  }

  Eigen::SparseMatrix<double> held() const {
    Eigen::SparseMatrix<double> matrix(static_cast<Eigen::Index>(standing_.size()), vertices_.rows());
    matrix.setFromTriplets(held_.begin(), held_.end());
    return matrix;
  }

 private:
  struct Piece {
    std::vector<std::uint32_t> vertices;  // that stand for themselves
    double mean_edge = 0;
    bool is_held = false;  // by edges that it shares with the body
  };
  // The point of the body beneath a vertex.
  struct Beneath {
    SkinPoint point;
    double gap = 0, agreement = 0;  // metres; of the weights
  };

  std::uint32_t skin_vertex(std::uint32_t host) const { return fillable_.vertex[host]; }

  void pull(std::uint32_t v, double weight) {
    const int row = unknown_[v];
    pulls_.emplace_back(row, row, weight);
    pull_[static_cast<std::size_t>(row)] += weight;
  }

  // Edges that end at a rider, and the pieces they make.
  void find_pieces(const std::set<Edge>& edges) {
    DisjointSets sets(standing_.size());
    for (const auto& [a, b] : edges) {
      if (unknown_[a] < 0 || unknown_[b] < 0) continue;
      sets.join(static_cast<std::size_t>(unknown_[a]), static_cast<std::size_t>(unknown_[b]));
    }
    std::vector<int> number(standing_.size(), -1);
    for (std::size_t k = 0; k < standing_.size(); ++k) {
      int& piece = number[sets.lowest(k)];
      if (piece < 0) {
        piece = static_cast<int>(pieces_.size());
        pieces_.emplace_back();
      }
      piece_.push_back(piece);
      pieces_[static_cast<std::size_t>(piece)].vertices.push_back(standing_[k]);
    }
    add_edges(edges);
  }

  Piece& piece_of(std::uint32_t v) {
    return pieces_[static_cast<std::size_t>(piece_[static_cast<std::size_t>(unknown_[v])])];
  }

  void add_edges(const std::set<Edge>& edges) {
    std::vector<Edge> own;
    std::vector<double> count(pieces_.size(), 0);
    for (const auto& [a, b] : edges) {
      if (unknown_[a] < 0 && unknown_[b] < 0) continue;
      const std::uint32_t rider = unknown_[a] < 0 ? b : a;
      own.emplace_back(rider, rider == a ? b : a);
      piece_of(rider).mean_edge += (vertices_.row(a) - vertices_.row(b)).norm();
      ++count[static_cast<std::size_t>(piece_[static_cast<std::size_t>(unknown_[rider])])];
    }
    for (std::size_t p = 0; p < pieces_.size(); ++p) pieces_[p].mean_edge /= std::max(count[p], 1.0);
    for (const auto& [rider, other] : own) {
      Piece& piece = piece_of(rider);
      const double length = (vertices_.row(rider) - vertices_.row(other)).norm();
      const double weight = piece.mean_edge > 0 ? piece.mean_edge / std::max(length, kShortest * piece.mean_edge) : 1;
      pull(rider, weight);
      if (unknown_[other] < 0) {
        held_.emplace_back(unknown_[rider], static_cast<int>(other), weight);
        piece.is_held = true;
        continue;
      }
      pull(other, weight);
      pulls_.emplace_back(unknown_[rider], unknown_[other], -weight);
      pulls_.emplace_back(unknown_[other], unknown_[rider], -weight);
    }
  }

  void hold_pieces() {
    const NearestSkin nearest(fillable_.vertices, fillable_.triangles);
    for (const Piece& piece : pieces_) {
      if (!piece.is_held) hold(piece, nearest);
    }
  }

  // Where it comes nearest to skin of the same joints.
  void hold(const Piece& piece, const NearestSkin& nearest) {
    std::vector<Beneath> beneath;
    double best = 0, least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t v : piece.vertices) {
      beneath.push_back(beneath_of(v, nearest));
      best = std::max(best, beneath.back().agreement);
    }
    const auto agrees = [&](const Beneath& at) { return at.agreement >= kAgreeing * best; };
    for (const Beneath& at : beneath) {
      if (agrees(at)) least = std::min(least, at.gap);
    }
    for (std::size_t k = 0; k < beneath.size(); ++k) {
      if (agrees(beneath[k]) && beneath[k].gap <= least + kTouching * piece.mean_edge) {
        hold_at(piece.vertices[k], beneath[k].point);
      }
    }
  }

  Beneath beneath_of(std::uint32_t v, const NearestSkin& nearest) const {
    Beneath at{nearest(vertices_.row(v))};
    at.gap = (at.point.position - vertices_.row(v).transpose()).norm();
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t host = at.point.vertices[static_cast<std::size_t>(k)];
      at.agreement += at.point.weights[k] * shared_weight(weights_[v], weights_[skin_vertex(host)]);
    }
    return at;
  }

  void hold_at(std::uint32_t v, const SkinPoint& point) {
    const int row = unknown_[v];
    const double weight = kHeld * std::max(pull_[static_cast<std::size_t>(row)], 1.0);
    pulls_.emplace_back(row, row, weight);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t host = point.vertices[static_cast<std::size_t>(k)];
      held_.emplace_back(row, static_cast<int>(skin_vertex(host)), weight * point.weights[k]);
    }
  }

  const FillableSkin& fillable_;
  const Positions& vertices_;
  const SkinWeights& weights_;
  std::vector<int> unknown_;             // V: -1 where the body is, or another vertex stands for it
  std::vector<std::uint32_t> standing_;  // the vertex of every unknown
  std::vector<int> piece_;               // of every unknown
  std::vector<Piece> pieces_;
  std::vector<double> pull_;  // of the edges around every unknown
  std::vector<Eigen::Triplet<double>> pulls_, held_;
};

}  // namespace

Riders::Riders(const FillableSkin& fillable, const Positions& vertices, const Triangles& triangles,
               const SkinWeights& weights) {
  for (std::uint32_t v = 0; v < fillable.host.size(); ++v) {
    if (fillable.host[v] < 0) vertices_.push_back(v);
  }
  if (vertices_.empty()) return;
  const RiderSystem system(fillable, vertices, triangles, weights);
  for (const std::uint32_t v : vertices_) unknown_.push_back(system.unknown(v));
  held_ = system.held();
  solver_ = std::make_shared<const SparseSolver>(system.pulls());
  if (!solver_->is_solvable()) {
    throw Error(ErrorKind::mismatch, "a loose piece has no area, and cannot follow the skin");
  }
}

Positions Riders::spread(const Positions& values) const {
  if (empty()) return Positions(0, 3);
  const Eigen::MatrixXd sum = held_ * values;
  return solver_->solve(sum)(unknown_, Eigen::all);
}

}  // namespace bodyopt
