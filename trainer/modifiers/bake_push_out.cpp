// Push-out: the triangles that each vertex comes to lie behind where skin folds, seen in poses that bend one joint
// after the other, and in those of a clip.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

#include "assets/clip.h"
#include "base/parallel.h"
#include "geometry/skin_in_skin.h"
#include "runtime/basis/character_unit.h"
#include "runtime/modifiers/fold_bend.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/fold_poses.h"
#include "trainer/modifiers/shown_skin.h"

namespace bodyopt {
namespace {

constexpr std::size_t kMostClipPoses = 200;
constexpr double kDeeper = 1.5;   // the reach over the deepest fold that was seen
constexpr double kEarlier = 0.6;  // the bend from which on a joint is at work over the least in which it folded skin
constexpr double kShallowest = 1e-3;  // metres: the least reach

class FoldSearch {
 public:
  explicit FoldSearch(const Basis& basis)
      : basis_(basis),
        triangles_(rest_triangles(basis)),
        shown_(without_modifiers(basis)),
        kept_(basis.mesh.vertex_count(), 0) {
    // What passes through itself as it was modelled stays so.
    const std::vector<Pose> rest = {bind_pose(basis.skeleton)};
    for (const BuriedVertex& buried : skin_in_skin(shown_(rest)[0], triangles_, triangles_)) kept_[buried.vertex] = 1;
  }

  // `searched`: as of skin_in_skin, by index. `joint`: that the poses bend; without it, that which bends most between
  // the two sides of each fold.
  void look(const std::vector<Pose>& poses, const std::vector<std::uint32_t>& searched,
            std::optional<std::uint32_t> joint) {
    const Triangles chosen = triangles_(searched, Eigen::all);
    const std::vector<Positions> skins = shown_(poses);
    std::vector<std::vector<BuriedVertex>> folds(skins.size());
    parallel_for(skins.size(), [&](std::size_t k) { folds[k] = skin_in_skin(skins[k], triangles_, chosen); });
    for (std::size_t k = 0; k < skins.size(); ++k) {
      for (const BuriedVertex& buried : folds[k]) {
        if (kept_[buried.vertex]) continue;
        deepest_ = std::max(deepest_, buried.depth);
        add(buried, poses[k], joint ? *joint : bent_between(poses[k], buried));
      }
    }
  }

  BakedModifier baked() const {
    BakedModifier baked;
    baked.numbers.push_back(static_cast<float>(std::max(kShallowest, kDeeper * deepest_)));
    for (const auto& [joint, fold] : folds_) {
      baked.joints.push_back(joint);
      baked.numbers.push_back(static_cast<float>(kEarlier * fold.bend));
      baked.components.push_back(Positions::Zero(basis_.mesh.vertex_count(), 3));
    }
    baked.folds = table();
    return baked;
  }

 private:
  using Partners = std::set<std::uint32_t>;  // triangles

  // Of a joint.
  struct Fold {
    double bend = 10;  // radians: the least in which skin lay in skin
    std::map<std::uint32_t, Partners> vertices;
  };

  FoldTable table() const {
    FoldTable table{{0}, {}, {}};
    for (std::uint32_t v = 0; v < basis_.mesh.vertex_count(); ++v) {
      std::uint32_t component = 0;
      for (const auto& [joint, fold] : folds_) {
        const auto found = fold.vertices.find(v);
        if (found != fold.vertices.end()) {
          table.lists.push_back({component, static_cast<std::uint32_t>(table.triangles.size())});
          table.triangles.insert(table.triangles.end(), found->second.begin(), found->second.end());
        }
        ++component;
      }
      table.begin.push_back(static_cast<std::uint32_t>(table.lists.size()));
    }
    table.lists.push_back({0, static_cast<std::uint32_t>(table.triangles.size())});
    return table;
  }

  // visit(t) of the triangles around a vertex.
  template <typename Visit>
  void around(std::uint32_t vertex, const Visit& visit) const {
    const MeshTable& mesh = basis_.mesh;
    for (std::uint32_t k = mesh.vertex_triangle_begin[vertex]; k < mesh.vertex_triangle_begin[vertex + 1]; ++k) {
      visit(mesh.vertex_triangles[k]);
    }
  }

  // The vertex and those beside it, which the next pose may bury, meet the triangles around the one nearest to it.
  void add(const BuriedVertex& buried, const Pose& pose, std::uint32_t joint) {
    Fold& fold = folds_[joint];
    fold.bend = std::min(fold.bend, fold_bend(basis_.skeleton, pose, joint));
    Partners met, vertices;
    around(buried.vertex,
           [&](std::uint32_t t) { vertices.insert(triangles_.row(t).begin(), triangles_.row(t).end()); });
    for (const std::uint32_t corner : buried.skin.vertices) {
      around(corner, [&](std::uint32_t t) { met.insert(t); });
    }
    for (const std::uint32_t v : vertices) {
      if (kept_[v]) continue;
      for (const std::uint32_t t : met) {
        if (!(triangles_.row(t).array() == v).any()) fold.vertices[v].insert(t);
      }
    }
  }

  std::uint32_t bent_between(const Pose& pose, const BuriedVertex& buried) const {
    const std::uint32_t one = basis_.ddm.vertices[buried.vertex].base_joint;
    std::uint32_t most = one;
    for (const std::uint32_t joint :
         joints_between(basis_.skeleton, one, basis_.ddm.vertices[buried.skin.vertices[0]].base_joint)) {
      if (fold_bend(basis_.skeleton, pose, joint) > fold_bend(basis_.skeleton, pose, most)) most = joint;
    }
    return most;
  }

  const Basis& basis_;
  const Triangles triangles_;
  ShownSkin shown_;
  std::vector<char> kept_;               // V
  std::map<std::uint32_t, Fold> folds_;  // of each joint that has any
  double deepest_ = 0;
};

std::vector<Pose> clip_poses(const BakeInput& input) {
  const std::string source = (input.folder / input.parameters.name("clip")).string();
  ClipOptions options;
  options.unit = clip_unit(source, kept_unit(input.basis));
  const Clip clip = read_clip(source, input.basis.skeleton, options);
  std::vector<Pose> poses;
  const std::size_t step = (clip.poses.size() + kMostClipPoses - 1) / kMostClipPoses;
  for (std::size_t k = 0; k < clip.poses.size(); k += step) {
    poses.push_back(clip.poses[k]);
    poses.back().controls.clear();
  }
  return poses;
}

}  // namespace

// joints, numbers: see runtime/modifiers/drive_push_out.cpp.
BakedModifier bake_push_out(const BakeInput& input) {
  const Skeleton& skeleton = input.basis.skeleton;
  FoldSearch search(input.basis);
  for (std::uint32_t joint = 0; joint < skeleton.size(); ++joint) {
    search.look(bent_poses(skeleton, joint, kFoldBends), triangles_near(input.basis, joint), joint);
  }
  if (input.parameters.has("clip")) {
    std::vector<std::uint32_t> all(input.basis.mesh.triangles.size() / 3);
    std::iota(all.begin(), all.end(), 0u);
    search.look(clip_poses(input), all, std::nullopt);
  }
  return search.baked();
}

}  // namespace bodyopt
