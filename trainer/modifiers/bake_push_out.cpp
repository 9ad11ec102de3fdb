// Push-out: the triangles that each vertex comes to lie behind where skin folds, seen in poses that bend one joint
// after the other, and in those of a clip.
#include <algorithm>
#include <numeric>
#include <set>

#include "assets/clip.h"
#include "assets/notes.h"
#include "base/parallel.h"
#include "geometry/skin_in_skin.h"
#include "runtime/basis/character_unit.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/fold_poses.h"
#include "trainer/modifiers/shown_skin.h"

namespace bodyopt {
namespace {

constexpr std::size_t kMostClipPoses = 200;
constexpr double kDeeper = 1.5;  // the reach over the deepest fold that was seen

class FoldSearch {
 public:
  explicit FoldSearch(const Basis& basis)
      : basis_(basis),
        triangles_(rest_triangles(basis)),
        shown_(without_modifiers(basis)),
        kept_(basis.mesh.vertex_count(), 0),
        partners_(basis.mesh.vertex_count()) {
    // What passes through itself as it was modelled stays so.
    const std::vector<Pose> rest = {bind_pose(basis.skeleton)};
    for (const BuriedVertex& buried : skin_in_skin(shown_(rest)[0], triangles_, triangles_)) kept_[buried.vertex] = 1;
  }

  // `searched`: as of skin_in_skin, by index.
  void look(const std::vector<Pose>& poses, const std::vector<std::uint32_t>& searched) {
    const Triangles chosen = triangles_(searched, Eigen::all);
    const std::vector<Positions> skins = shown_(poses);
    std::vector<std::vector<BuriedVertex>> folds(skins.size());
    parallel_for(skins.size(), [&](std::size_t k) { folds[k] = skin_in_skin(skins[k], triangles_, chosen); });
    for (const std::vector<BuriedVertex>& fold : folds) {
      for (const BuriedVertex& buried : fold) {
        if (kept_[buried.vertex]) continue;
        deepest_ = std::max(deepest_, buried.depth);
        add(buried);
      }
    }
  }

  FoldTable table() const {
    FoldTable folds{{0}, {}};
    for (const std::set<std::uint32_t>& partners : partners_) {
      folds.triangles.insert(folds.triangles.end(), partners.begin(), partners.end());
      folds.begin.push_back(static_cast<std::uint32_t>(folds.triangles.size()));
    }
    return folds;
  }

  double deepest() const { return deepest_; }

 private:
  // visit(t) of the triangles around a vertex.
  template <typename Visit>
  void around(std::uint32_t vertex, const Visit& visit) const {
    const MeshTable& mesh = basis_.mesh;
    for (std::uint32_t k = mesh.vertex_triangle_begin[vertex]; k < mesh.vertex_triangle_begin[vertex + 1]; ++k) {
      visit(mesh.vertex_triangles[k]);
    }
  }

  // The vertex and those beside it, which the next pose may bury, meet the triangles around the one nearest to it.
  void add(const BuriedVertex& buried) {
    std::set<std::uint32_t> vertices, met;
    around(buried.vertex,
           [&](std::uint32_t t) { vertices.insert(triangles_.row(t).begin(), triangles_.row(t).end()); });
    for (const std::uint32_t corner : buried.skin.vertices) {
      around(corner, [&](std::uint32_t t) { met.insert(t); });
    }
    for (const std::uint32_t v : vertices) {
      if (kept_[v]) continue;
      for (const std::uint32_t t : met) {
        if (!(triangles_.row(t).array() == v).any()) partners_[v].insert(t);
      }
    }
  }

  const Basis& basis_;
  const Triangles triangles_;
  ShownSkin shown_;
  std::vector<char> kept_;                         // V
  std::vector<std::set<std::uint32_t>> partners_;  // V: triangles
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

// numbers: the reach, metres.
BakedModifier bake_push_out(const BakeInput& input) {
  const Skeleton& skeleton = input.basis.skeleton;
  FoldSearch search(input.basis);
  for (std::uint32_t joint = 0; joint < skeleton.size(); ++joint) {
    if (skeleton.joints[joint].parent < 0) continue;
    search.look(bent_poses(skeleton, joint, kFoldBends), triangles_near(input.basis, joint));
  }
  if (input.parameters.has("clip")) {
    std::vector<std::uint32_t> all(input.basis.mesh.triangles.size() / 3);
    std::iota(all.begin(), all.end(), 0u);
    search.look(clip_poses(input), all);
  }
  BakedModifier baked;
  baked.components.push_back(Positions::Zero(input.basis.mesh.vertex_count(), 3));
  baked.folds = search.table();
  baked.numbers.push_back(static_cast<float>(std::max(1e-3, kDeeper * search.deepest())));
  return baked;
}

}  // namespace bodyopt
