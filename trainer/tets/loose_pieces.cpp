#include "trainer/tets/loose_pieces.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/linear_algebra.h"
#include "geometry/nearest_skin.h"
#include "geometry/surface_topology.h"
#include "runtime/core/error.h"
#include "trainer/tets/cage.h"

namespace bodyopt::trainer {
namespace {

constexpr double kOther = 0.5;    // of a vertex' weights: a tet that follows less of them follows other joints
constexpr double kOwn = 0.8;      // and one that follows as much follows the same
constexpr double kFarthest = -4;  // barycentric weight of a vertex outside its tet: further, it would be a spike

// Distances along the edges of a skin.
class SkinPaths {
 public:
  SkinPaths(const Positions& vertices, const Triangles& triangles)
      : vertices_(vertices), beside_(static_cast<std::size_t>(vertices.rows())) {
    for_each_edge(triangles, [&](std::uint32_t a, std::uint32_t b) { beside_[a].push_back(b); });
  }

  // The vertices within so many metres along the edges (Dijkstra 1959), and how far they are.
  std::map<std::uint32_t, double> within(std::uint32_t from, double metres) const {
    std::map<std::uint32_t, double> reached;
    using Step = std::pair<double, std::uint32_t>;
    std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
    open.push({0, from});
    while (!open.empty()) {
      const auto [distance, vertex] = open.top();
      open.pop();
      if (!reached.emplace(vertex, distance).second) continue;
      for (const std::uint32_t next : beside_[vertex]) {
        const double further = distance + (vertices_.row(next) - vertices_.row(vertex)).norm();
        if (further <= metres && !reached.contains(next)) open.push({further, next});
      }
    }
    return reached;
  }

 private:
  const Positions& vertices_;
  std::vector<std::vector<std::uint32_t>> beside_;  // every edge once from either end, on a closed skin
};

class CarriedSkin {
 public:
  CarriedSkin(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights, const TetMesh& mesh,
              const std::vector<EmbeddedPoint>& skin)
      : vertices_(vertices),
        weights_(weights),
        mesh_(mesh),
        skin_(skin),
        paths_(vertices, triangles),
        carried_(static_cast<std::size_t>(mesh.nodes.rows())) {
    std::uint32_t joints = 0;
    for (const std::vector<JointWeight>& vertex : weights) {
      for (const JointWeight& w : vertex) joints = std::max(joints, w.joint + 1);
    }
    followed_ = Eigen::MatrixXd::Zero(mesh.nodes.rows(), joints);
    for (std::uint32_t v = 0; v < skin.size(); ++v) {
      for (int a = 0; a < 4; ++a) {
        const int node = mesh.tets(skin[v].tet, a);
        carried_[static_cast<std::size_t>(node)].push_back(v);
        const double share = std::max(skin[v].weights[a], 0.0);
        for (const JointWeight& w : weights[v]) followed_(node, w.joint) += share * w.weight;
      }
    }
    for (Eigen::Index n = 0; n < followed_.rows(); ++n) followed_.row(n) /= std::max(followed_.row(n).sum(), 1e-300);
  }

  bool follows_others(std::uint32_t v) const {
    const double own = agreement(v, skin_[v].tet);
    return own < kOther || (own < kOwn && shares_with_far_skin(v));
  }

  bool is_glued(std::uint32_t v) const { return agreement(v, skin_[v].tet) < kOwn && shares_with_far_skin(v); }

  // The joint that the vertex' tet follows most, beside its own main one.
  std::uint32_t other_joint(std::uint32_t v) const {
    Eigen::RowVectorXd joints = joints_of(skin_[v].tet);
    joints[weights_[v].front().joint] = -1;
    Eigen::Index other = 0;
    joints.maxCoeff(&other);
    return static_cast<std::uint32_t>(other);
  }

  // The tet that holds a vertex best of those that follow the same joints; if there is none, its present one.
  EmbeddedPoint own_tet(std::uint32_t v) const {
    EmbeddedPoint best{-1, Eigen::Vector4d::Constant(kFarthest)};
    for (int t = 0; t < mesh_.tets.rows(); ++t) {
      const Eigen::Vector4d at = weights_in(mesh_, t, vertices_.row(v));
      if (at.minCoeff() > best.weights.minCoeff() && agreement(v, t) >= kOwn) best = {t, at};
    }
    return best.tet < 0 ? skin_[v] : best;
  }

 private:
  // How much of what a tet carries follows every joint; all 0 where it carries nothing.
  Eigen::RowVectorXd joints_of(int tet) const {
    Eigen::RowVectorXd joints = Eigen::RowVectorXd::Zero(followed_.cols());
    for (int a = 0; a < 4; ++a) joints += followed_.row(mesh_.tets(tet, a));
    return joints / std::max(joints.sum(), 1e-300);
  }

  // The share of its weights that a tet follows.
  double agreement(std::uint32_t v, int tet) const {
    const Eigen::RowVectorXd joints = joints_of(tet);
    double sum = 0;
    for (const JointWeight& w : weights_[v]) sum += std::min(w.weight, joints[w.joint]);
    return sum;
  }

  double longest_edge(int tet) const {
    double longest = 0;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < a; ++b) {
        longest = std::max(longest, (mesh_.nodes.row(mesh_.tets(tet, a)) - mesh_.nodes.row(mesh_.tets(tet, b))).norm());
      }
    }
    return longest;
  }

  bool shares_with_far_skin(std::uint32_t v) const {
    const int tet = skin_[v].tet;
    const std::map<std::uint32_t, double> near = paths_.within(v, kDetour * longest_edge(tet));
    const auto is_beside = [&](std::uint32_t other) {
      const auto way = near.find(other);
      return way != near.end() && way->second <= kDetour * (vertices_.row(other) - vertices_.row(v)).norm();
    };
    for (int a = 0; a < 4; ++a) {
      for (const std::uint32_t other : carried_[static_cast<std::size_t>(mesh_.tets(tet, a))]) {
        if (!is_beside(other) && shared_weight(weights_[v], weights_[other]) < kSharedByOne) return true;
      }
    }
    return false;
  }

  const Positions& vertices_;
  const SkinWeights& weights_;
  const TetMesh& mesh_;
  const std::vector<EmbeddedPoint>& skin_;
  SkinPaths paths_;
  std::vector<std::vector<std::uint32_t>> carried_;  // by the tets around every node
  Eigen::MatrixXd followed_;                         // nodes x joints
};

constexpr double kTouching = 0.5;   // of a piece's mean edge: further than the nearest by more is not held
constexpr double kAgreeing = 0.5;   // of the best agreement with the joints beneath: less is not held
constexpr double kHeld = 1e4;       // times the pull of the edges around: held as well as exactly
constexpr double kShortest = 1e-3;  // of the mean edge: shorter ones pull no harder

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// Each once, by the vertices that stand for merged ones.
std::set<Edge> edges_of(const Triangles& triangles, const std::vector<std::uint32_t>& first) {
  std::set<Edge> edges;
  for_each_edge(triangles, [&](std::uint32_t a, std::uint32_t b) {
    if (first[a] != first[b]) edges.insert(std::minmax(first[a], first[b]));
  });
  return edges;
}

class LoosePieceSystem {
 public:
  LoosePieceSystem(const FillableSkin& fillable, const Positions& vertices, const Triangles& triangles,
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
    return sparse_matrix(size, size, pulls_);
  }

  Eigen::SparseMatrix<double> held() const {
    return sparse_matrix(static_cast<Eigen::Index>(standing_.size()), vertices_.rows(), held_);
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

  // Edges that end at a loose vertex, and the pieces they make.
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
      const std::uint32_t loose = unknown_[a] < 0 ? b : a;
      own.emplace_back(loose, loose == a ? b : a);
      piece_of(loose).mean_edge += (vertices_.row(a) - vertices_.row(b)).norm();
      ++count[static_cast<std::size_t>(piece_[static_cast<std::size_t>(unknown_[loose])])];
    }
    for (std::size_t p = 0; p < pieces_.size(); ++p) pieces_[p].mean_edge /= std::max(count[p], 1.0);
    for (const auto& [loose, other] : own) {
      Piece& piece = piece_of(loose);
      const double length = (vertices_.row(loose) - vertices_.row(other)).norm();
      const double weight = piece.mean_edge > 0 ? piece.mean_edge / std::max(length, kShortest * piece.mean_edge) : 1;
      pull(loose, weight);
      if (unknown_[other] < 0) {
        held_.emplace_back(unknown_[loose], static_cast<int>(other), weight);
        piece.is_held = true;
        continue;
      }
      pull(other, weight);
      pulls_.emplace_back(unknown_[loose], unknown_[other], -weight);
      pulls_.emplace_back(unknown_[other], unknown_[loose], -weight);
    }
  }

  void hold_pieces() {
    const NearestSkin nearest(fillable_.vertices, fillable_.triangles);
    for (const Piece& piece : pieces_) {
      if (!piece.is_held) hold(piece, nearest);
    }
  }

  // Holds a piece where it comes nearest to skin of the same joints.
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

void carry_by_own_joints(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                         const TetMesh& mesh, std::vector<EmbeddedPoint>& skin) {
  const CarriedSkin carried(vertices, triangles, weights, mesh, skin);
  std::vector<EmbeddedPoint> own = skin;
  for (std::uint32_t v = 0; v < skin.size(); ++v) {
    if (carried.follows_others(v)) own[v] = carried.own_tet(v);
  }
  skin = std::move(own);
}

std::vector<GluedVertex> glued_vertices(const Positions& vertices, const Triangles& triangles,
                                        const SkinWeights& weights, const TetMesh& mesh,
                                        const std::vector<EmbeddedPoint>& skin) {
  const CarriedSkin carried(vertices, triangles, weights, mesh, skin);
  std::vector<GluedVertex> glued;
  for (std::uint32_t v = 0; v < skin.size(); ++v) {
    if (carried.is_glued(v)) glued.push_back({v, carried.other_joint(v)});
  }
  return glued;
}

LoosePieces::LoosePieces(const FillableSkin& fillable, const Positions& vertices, const Triangles& triangles,
                         const SkinWeights& weights) {
  for (std::uint32_t v = 0; v < fillable.host.size(); ++v) {
    if (fillable.host[v] < 0) vertices_.push_back(v);
  }
  if (vertices_.empty()) return;
  const LoosePieceSystem system(fillable, vertices, triangles, weights);
  for (const std::uint32_t v : vertices_) unknown_.push_back(system.unknown(v));
  held_ = system.held();
  solver_ = std::make_shared<const SparseSolver>(system.pulls());
  if (!solver_->is_solvable()) {
    throw Error(ErrorKind::mismatch, "a loose piece has no area, and cannot follow the skin");
  }
}

Positions LoosePieces::spread(const Positions& values) const {
  if (empty()) return Positions(0, 3);
  const Eigen::MatrixXd sum = held_ * values;
  return solver_->solve(sum)(unknown_, Eigen::all);
}

}  // namespace bodyopt::trainer
