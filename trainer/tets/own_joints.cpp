#include "trainer/tets/own_joints.h"

#include <algorithm>
#include <functional>
#include <map>
#include <queue>
#include <utility>

#include "trainer/tets/apart_skin.h"

namespace bodyopt {
namespace {

constexpr double kOther = 0.5;    // of a vertex' weights: a tet that follows less of them follows other joints
constexpr double kOwn = 0.8;      // and one that follows as much follows the same
constexpr double kFarthest = -4;  // barycentric weight of a vertex outside its tet: further, it would be a spike

// How far along the edges of a skin.
class SkinPaths {
 public:
  SkinPaths(const Positions& vertices, const Triangles& triangles)
      : vertices_(vertices), beside_(static_cast<std::size_t>(vertices.rows())) {
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) beside_[triangles(t, k)].push_back(triangles(t, (k + 1) % 3));
    }
  }

  // What can be reached within so many metres (Dijkstra 1959), and how far it is.
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

  // That the vertex' tet follows most, beside its own main one.
  std::uint32_t other_joint(std::uint32_t v) const {
    Eigen::RowVectorXd joints = joints_of(skin_[v].tet);
    joints[weights_[v].front().joint] = -1;
    Eigen::Index other = 0;
    joints.maxCoeff(&other);
    return static_cast<std::uint32_t>(other);
  }

  // Of the tets that follow the same joints, the one that holds a vertex best; none: where it is.
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

}  // namespace bodyopt
