#include "trainer/modifiers/fold_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "base/parallel.h"
#include "geometry/closed_skin.h"
#include "geometry/thickness.h"
#include "geometry/vertex_normals.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "runtime/modifiers/joint_turns.h"
#include "shaders/include/fold.h"

namespace bodyopt {
namespace {

constexpr double kDeeper = 1.2;    // the reach over the deepest that a vertex, or one beside it, was seen
constexpr double kNear = 1.2;      // edges: what lies so near is met besides
constexpr double kShare = 0.45;    // of a body's thickness: deeper in skin the other side is as near
constexpr double kEarlier = 0.6;   // the bend from which on a joint is at work over the least in which it folded skin
constexpr float kUnmoved = 5e-5f;  // metres

}  // namespace

FoldSearch::FoldSearch(const Basis& basis)
    : basis_(basis),
      triangles_(rest_triangles(basis)),
      shown_(without_modifiers(basis)),
      kept_(basis.mesh.vertex_count(), 0),
      thickness_(thickness(rest_positions(basis), triangles_)) {
  const std::vector<Pose> rest = {bind_pose(basis.skeleton)};
  for (const BuriedVertex& buried : skin_in_skin(shown_(rest)[0], triangles_, triangles_)) kept_[buried.vertex] = 1;
}

void FoldSearch::bend_all() {
  for (const std::uint32_t joint : folding_joints(basis_, thickness_)) {
    const std::vector<std::uint32_t> searched = triangles_near(basis_, joint);
    for (const FoldDirection& direction : fold_directions(basis_.skeleton, joint, kFirstFold)) {
      std::vector<Pose> poses;
      for (const double degrees : kFoldAngles) poses.push_back(bent_pose(basis_.skeleton, direction, degrees));
      look(poses, searched, direction);
    }
  }
}

void FoldSearch::look(const std::vector<Pose>& poses) {
  std::vector<std::uint32_t> all(static_cast<std::size_t>(triangles_.rows()));
  std::iota(all.begin(), all.end(), 0u);
  look(poses, all, std::nullopt);
}

void FoldSearch::look(const std::vector<Pose>& poses, const std::vector<std::uint32_t>& searched,
                      const std::optional<FoldDirection>& direction) {
  const Triangles chosen = triangles_(searched, Eigen::all);
  const std::vector<Positions> skins = shown_(poses);
  std::vector<std::vector<BuriedVertex>> found(skins.size());
  parallel_for(skins.size(), [&](std::size_t k) { found[k] = skin_in_skin(skins[k], triangles_, chosen); });
  Looked looked;
  for (std::size_t k = 0; k < skins.size(); ++k) {
    if (goes_through(found[k], thickness_)) continue;
    looked.poses.push_back(poses[k]);
    looked.buried.emplace_back();
    for (const BuriedVertex& buried : found[k]) looked.buried.back().insert(buried.vertex);
    add(found[k], poses[k], skins[k], searched, direction);
  }
  looked_.push_back(std::move(looked));
}

// Null where the joint has no bone, or is not bent that way.
FoldSearch::Fold* FoldSearch::fold_of(const FoldDirection& direction, const std::vector<Vec3>& bends) {
  const std::vector<FoldDirection> all = fold_directions(basis_.skeleton, direction.joint, kFirstFold);
  const auto nearest =
      std::ranges::max_element(all, {}, [&](const FoldDirection& other) { return dot(other.axis, direction.axis); });
  if (nearest == all.end()) return nullptr;
  const double bend = dot(bends[direction.joint], nearest->axis);
  if (!(bend > 0)) return nullptr;
  Fold& fold = folds_[{direction.joint, static_cast<std::size_t>(nearest - all.begin())}];
  fold.axis = nearest->axis;
  fold.least_bend = std::min(fold.least_bend, bend);
  return &fold;
}

// Of two sides that one joint holds, that joint.
FoldDirection FoldSearch::bent_most(const std::vector<Vec3>& bends, const BuriedVertex& buried) const {
  const std::uint32_t own = basis_.ddm.vertices[buried.vertex].base_joint,
                      other = basis_.ddm.vertices[buried.skin.vertices[0]].base_joint;
  std::uint32_t most = own;
  for (const std::uint32_t joint : joints_between(basis_.skeleton, own, other)) {
    if (length(bends[joint]) > length(bends[most])) most = joint;
  }
  return {most, bends[most]};
}

template <typename Visit>
void FoldSearch::around(std::uint32_t vertex, const Visit& visit) const {
  const MeshTable& mesh = basis_.mesh;
  for (std::uint32_t k = mesh.vertex_triangle_begin[vertex]; k < mesh.vertex_triangle_begin[vertex + 1]; ++k) {
    visit(mesh.vertex_triangles[k]);
  }
}

// A vertex, and those beside it, which the next pose may bury, meet all skin near them that faces them.
void FoldSearch::add(const std::vector<BuriedVertex>& found, const Pose& pose, const Positions& skin,
                     const std::vector<std::uint32_t>& searched, const std::optional<FoldDirection>& direction) {
  const std::vector<Vec3> bends = fold_bends(basis_.skeleton, pose);
  std::map<std::pair<Fold*, std::uint32_t>, double> depths;  // of vertices
  for (const BuriedVertex& buried : found) {
    if (kept_[buried.vertex] || buried.depth > kShare * thickness_[buried.vertex]) continue;
    Fold* fold = fold_of(direction ? *direction : bent_most(bends, buried), bends);
    if (fold == nullptr) continue;
    around(buried.vertex, [&](std::uint32_t t) {
      for (const std::uint32_t v : triangles_.row(t)) {
        double& depth = depths[{fold, v}];
        depth = std::max(depth, buried.depth);
      }
    });
  }
  if (depths.empty()) return;
  const Positions normals = vertex_normals(skin, triangles_).rowwise().normalized();
  Positions centres(std::ssize(searched), 3), theirs(std::ssize(searched), 3);
  for (Eigen::Index k = 0; k < centres.rows(); ++k) {
    const Eigen::RowVector3d a = skin.row(triangles_(searched[k], 0)), b = skin.row(triangles_(searched[k], 1)),
                             c = skin.row(triangles_(searched[k], 2));
    centres.row(k) = (a + b + c) / 3;
    theirs.row(k) = (b - a).cross(c - a).normalized();
  }
  const double edge = mean_edge(skin, triangles_);
  for (const auto& [of, depth] : depths) {
    const auto& [fold, v] = of;
    if (kept_[v]) continue;
    Partners& partners = fold->vertices[v];
    partners.deepest = std::max(partners.deepest, depth);
    const double near = kNear * edge + kDeeper * depth;
    for (Eigen::Index k = 0; k < centres.rows(); ++k) {
      if ((centres.row(k) - skin.row(v)).squaredNorm() > near * near || theirs.row(k).dot(normals.row(v)) > 0) continue;
      if (!(triangles_.row(searched[k]).array() == v).any()) partners.triangles.insert(searched[k]);
    }
  }
}

// Those around a vertex; of many some, spread evenly.
FoldVertex FoldSearch::ring_of(std::uint32_t vertex) const {
  FoldVertex fold{};
  std::ranges::fill(fold.ring, vertex);
  std::map<std::uint32_t, std::uint32_t> next;  // of each vertex around it, counter-clockwise
  around(vertex, [&](std::uint32_t t) {
    for (int k = 0; k < 3; ++k) {
      if (triangles_(t, k) == vertex) next[triangles_(t, (k + 1) % 3)] = triangles_(t, (k + 2) % 3);
    }
  });
  if (next.empty()) return fold;
  std::vector<std::uint32_t> ring = {next.begin()->first};
  for (const auto& [from, to] : next) {  // an open ring begins where nothing leads to
    if (std::ranges::none_of(next, [&](const auto& edge) { return edge.second == from; })) ring = {from};
  }
  while (ring.size() <= next.size() && next.contains(ring.back())) ring.push_back(next.at(ring.back()));
  const std::size_t count = ring.back() == ring.front() ? ring.size() - 1 : ring.size();
  for (std::size_t k = 0; k < kFoldRing; ++k) {
    fold.ring[k] = count > kFoldRing ? ring[k * count / kFoldRing] : ring[std::min(k, count - 1)];
  }
  return fold;
}

BakedModifier FoldSearch::tables() const {
  BakedModifier baked;
  FoldTable& table = baked.folds;
  for (const auto& [way, fold] : folds_) {
    baked.joints.push_back(way.first);
    baked.components.push_back(Positions::Zero(basis_.mesh.vertex_count(), 3));
    for (const double x : fold.axis) {
      baked.numbers.push_back(static_cast<float>(x / (kEarlier * std::max(0.01, fold.least_bend))));
    }
  }
  for (std::uint32_t v = 0; v < basis_.mesh.vertex_count(); ++v) {
    table.vertices.push_back(ring_of(v));
    table.vertices.back().first_list = static_cast<std::uint32_t>(table.lists.size());
    std::uint32_t component = 0;
    for (const auto& [way, fold] : folds_) {
      const auto found = fold.vertices.find(v);
      if (found != fold.vertices.end() && !found->second.triangles.empty()) {
        const Partners& partners = found->second;
        const double reach = std::min(kDeeper * partners.deepest + 0.002, kShare * thickness_[v]);
        table.lists.push_back(
            {component, static_cast<std::uint32_t>(table.triangles.size()), static_cast<float>(reach)});
        table.triangles.insert(table.triangles.end(), partners.triangles.begin(), partners.triangles.end());
      }
      ++component;
    }
  }
  table.vertices.push_back({static_cast<std::uint32_t>(table.lists.size()), {}});
  table.lists.push_back({0, static_cast<std::uint32_t>(table.triangles.size()), 0});
  return baked;
}

// Takes from the lists of vertices that are in no skin what would move them.
void FoldSearch::prune(const Looked& looked, const Basis& pushed) {
  std::vector<Pose> poses = looked.poses;
  drive_modifiers(pushed, {}, 1, poses);
  const std::vector<Positions> skins = shown_(looked.poses);
  for (std::size_t p = 0; p < poses.size(); ++p) {
    for (std::uint32_t v = 0; v < basis_.mesh.vertex_count(); ++v) {
      if (!looked.buried[p].contains(v)) prune(v, skins[p], poses[p].modifiers, pushed.modifiers.folds);
    }
  }
}

// As output_separate sees it in its first step.
void FoldSearch::prune(std::uint32_t v, const Positions& skin, const std::vector<float>& weights,
                       const FoldTable& table) {
  const auto way_to = [&](std::uint32_t to, float(&way)[3]) {
    for (int i = 0; i < 3; ++i) way[i] = static_cast<float>(skin(to, i) - skin(v, i));
  };
  float sum[4] = {}, normal[3] = {}, last[3], next[3];
  way_to(table.vertices[v].ring[kFoldRing - 1], last);
  for (const std::uint32_t to : table.vertices[v].ring) {
    way_to(to, next);
    add_fold_cross(last, next, normal);
    std::copy_n(next, 3, last);
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pulling;  // component, triangle
  for (std::uint32_t l = table.vertices[v].first_list; l < table.vertices[v + 1].first_list; ++l) {
    const FoldList& list = table.lists[l];
    if (!(weights[list.component] > 0)) continue;
    for (std::uint32_t k = list.first; k < table.lists[l + 1].first; ++k) {
      float corners[3][3], pull[4] = {};
      for (int c = 0; c < 3; ++c) way_to(triangles_(table.triangles[k], c), corners[c]);
      add_fold_pull(normal, corners[0], corners[1], corners[2], list.reach, pull);
      for (int i = 0; i < 4; ++i) sum[i] += pull[i];
      if (pull[0] != 0 || pull[1] != 0 || pull[2] != 0) pulling.emplace_back(list.component, table.triangles[k]);
    }
  }
  if (!(std::hypot(sum[0], sum[1], sum[2]) > kUnmoved * sum[3])) return;
  for (const auto& [component, triangle] : pulling) {
    std::next(folds_.begin(), component)->second.vertices.at(v).triangles.clear();
  }
}

BakedModifier FoldSearch::baked() {
  Basis pushed = without_modifiers(basis_);
  BakedModifier all = tables();
  SkinModifier& modifier = pushed.modifiers.stack.emplace_back();
  modifier.type = kPushOut;
  modifier.component_count = static_cast<std::uint32_t>(all.components.size());
  modifier.joints = std::move(all.joints);
  modifier.numbers = std::move(all.numbers);
  pushed.modifiers.folds = std::move(all.folds);
  for (const Looked& looked : looked_) prune(looked, pushed);
  return tables();
}

}  // namespace bodyopt
