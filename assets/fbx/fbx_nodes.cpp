#include "assets/fbx/fbx_nodes.h"

#include <algorithm>
#include <cmath>

namespace bodyopt {
namespace {

// Is the scale the same along all axes, and not 0?
bool is_even(const Vec3& scale) {
  const auto [least, most] = std::ranges::minmax(scale);
  return most - least <= 1e-4 * std::abs(most) && most != 0;
}

}  // namespace

FbxNodes::FbxNodes(const FbxScene& scene) : scene_(scene), unit_(scene.unit()), axes_(scene.axes()) {
  const auto append_children = [&](int parent) {
    const FbxObject* above = parent < 0 ? nullptr : nodes_[static_cast<std::size_t>(parent)].model;
    const bool is_lesser = parent >= 0 && is_lesser_level(static_cast<std::size_t>(parent));
    bool is_first = true;
    for (const FbxObject* model : scene.into(above == nullptr ? 0 : above->id, "Model")) {
      if (!place_.emplace(model->id, nodes_.size()).second) continue;
      const bool is_other_level = above != nullptr && above->type == "LodGroup" && !is_first;
      nodes_.push_back({model, parent, is_lesser || is_other_level, FbxNodeTransform(scene, *model)});
      is_first = false;
    }
  };
  append_children(-1);
  for (std::size_t n = 0; n < nodes_.size(); ++n) append_children(static_cast<int>(n));
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    const auto binds = [](const FbxScene::Target& target) { return target.object->kind == "Deformer"; };
    node.bears_joints = node.bears_joints || node.model->type.starts_with("Limb") ||
                        std::ranges::any_of(scene.targets(node.model->id), binds);
    if (node.bears_joints && node.parent >= 0) nodes_[static_cast<std::size_t>(node.parent)].bears_joints = true;
  }
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const Vec3 scale = nodes_[n].transform.channels().scale;
    if (is_even(scale) && scale[0] > 0) nodes_[n].own_scale = scale[0] / inherited_scale(n, nullptr, 0);
    nodes_[n].taken_scale =
        nodes_[n].own_scale * (parent(n) < 0 ? 1 : taken_scale(static_cast<std::size_t>(parent(n))));
  }
}

int FbxNodes::find(const FbxObject& model) const {
  const auto found = place_.find(model.id);
  return found == place_.end() ? -1 : static_cast<int>(found->second);
}

FbxChannels FbxNodes::channels(std::size_t n, const FbxMotion* motion, double seconds) const {
  const bool moves = motion != nullptr && motion->is_animated(model(n));
  return moves ? motion->at(model(n), seconds) : nodes_[n].transform.channels();
}

// The divisor of the scale of a joint, or of a node above joints: its parent's scale where it does not inherit it.
double FbxNodes::inherited_scale(std::size_t n, const FbxMotion* motion, double seconds) const {
  const FbxInheritance inheritance = nodes_[n].transform.inheritance();
  if (inheritance == FbxInheritance::with_shear || !nodes_[n].bears_joints) return 1;
  double of_parent = 1;
  for (int above = parent(n); above >= 0; above = parent(static_cast<std::size_t>(above))) {
    const Vec3 scale = channels(static_cast<std::size_t>(above), motion, seconds).scale;
    if (!is_even(scale)) {
      scene_.fail("'", model(n).name, "' does not inherit the shear of '", model(static_cast<std::size_t>(above)).name,
                  "', whose scale differs along its axes (InheritType); export it without such scale");
    }
    if (above == parent(n) && inheritance == FbxInheritance::without_parent) of_parent = scale[0];
  }
  return of_parent;
}

JointTransform FbxNodes::local(std::size_t n, const FbxMotion* motion, double seconds) const {
  JointTransform local = nodes_[n].transform.at(channels(n, motion, seconds));
  const double above = parent(n) < 0 ? 1 : taken_scale(static_cast<std::size_t>(parent(n)));
  local.translation = (unit_ * above) * local.translation;
  local.scale = (1 / (nodes_[n].own_scale * inherited_scale(n, motion, seconds))) * local.scale;
  if (parent(n) < 0) {
    local.translation = rotate(axes_, local.translation);
    local.rotation = axes_ * local.rotation;
  }
  if (!is_finite(local)) scene_.fail("'", model(n).name, "' stands beyond all numbers; the FBX file is damaged");
  return local;
}

Affine FbxNodes::world(std::size_t n) const {
  Affine world = scaling(taken_scale(n));
  for (int at = static_cast<int>(n); at >= 0; at = parent(static_cast<std::size_t>(at))) {
    world = affine_from(local(static_cast<std::size_t>(at))) * world;
  }
  return world;
}

std::vector<const FbxObject*> FbxNodes::movers(std::size_t n) const {
  std::vector<const FbxObject*> movers{&model(n)};
  if (parent(n) >= 0 && nodes_[n].transform.inheritance() == FbxInheritance::without_parent) {
    movers.push_back(&model(static_cast<std::size_t>(parent(n))));
  }
  return movers;
}

Affine FbxNodes::in_metres(Affine matrix) const {
  for (auto& row : matrix.m) row[3] *= unit_;
  return matrix;
}

}  // namespace bodyopt
