#include "assets/gltf/gltf_rest.h"

#include <numbers>

#include "assets/gltf/gltf_skeleton.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

// The skin that motion is of: that which draws most, or one whose mesh was left out.
int skin_of_motion(const GltfFile& file) {
  const int drawn = choose_skin(file);
  return drawn < 0 && !file.model().skins.empty() ? 0 : drawn;
}

}  // namespace

RestNodes read_rest(const GltfFile& file, const NodeTree& tree, double unit) {
  RestNodes rest{tree.local, false};
  std::vector<std::string> unused;  // what reading the character notes already
  const int skin = skin_of_motion(file);
  if (skin < 0 || file.model().skins[static_cast<std::size_t>(skin)].inverseBindMatrices < 0) return rest;
  const SkinSkeleton bound = read_skin_skeleton(file, skin, unit, unused);
  const std::vector<int> nodes = read_skin_joints(file, skin, tree, unused).nodes;
  const std::vector<Affine> bind = posed_joints(bound.skeleton, bind_pose(bound.skeleton).joints);
  std::vector<int> joint_of_node(tree.parent.size(), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    joint_of_node[static_cast<std::size_t>(nodes[k])] = static_cast<int>(bound.joint_of_skin[k]);
  }

  std::vector<Affine> world(tree.parent.size());
  for (const std::size_t n : tree.order) {
    const Affine above = tree.parent[n] < 0 ? Affine{} : world[static_cast<std::size_t>(tree.parent[n])];
    if (joint_of_node[n] < 0) {
      world[n] = above * affine_from(tree.local[n]);
      continue;
    }
    world[n] = bind[static_cast<std::size_t>(joint_of_node[n])];
    try {
      rest.local[n] = decompose(inverse(above) * world[n]);
    } catch (const Error&) {
      file.fail("the nodes above joint '", bound.skeleton.joints[static_cast<std::size_t>(joint_of_node[n])].name,
                "' are scaled to nothing");
    }
  }
  rest.is_bound = true;
  return rest;
}

RestComparison compare_rests(std::span<const JointTransform> rest, std::span<const JointTransform> pose,
                             const std::vector<bool>& matched, const Skeleton& skeleton) {
  constexpr double kSameDegrees = 0.5, kSameLength = 0.01, kOfAllBones = 1e-4;
  const auto is_bone = [&](std::size_t j) { return matched[j] && skeleton.joints[j].parent >= 0; };
  double all_bones = 0;
  for (std::size_t j = 0; j < skeleton.size(); ++j) all_bones += is_bone(j) ? length(pose[j].translation) : 0;
  const double slack = kOfAllBones * all_bones;
  bool same_bones = true, same_directions = true;
  RestComparison comparison;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const double turned =
        matched[j] ? angle_between(normalized(pose[j].rotation), normalized(rest[j].rotation)) * 180 / std::numbers::pi
                   : 0;
    if (turned > comparison.worst) {
      comparison.worst = turned;
      comparison.joint = skeleton.joints[j].name;
    }
    if (!is_bone(j)) continue;
    const Vec3 &bone = pose[j].translation, &other = rest[j].translation;
    const double size = length(bone), other_size = length(other);
    const Vec3 as_long = other_size > 0 ? (size / other_size) * other : other;
    same_bones = same_bones && length(other - bone) <= kSameLength * size + slack;
    same_directions = same_directions && length(as_long - bone) <= kSameDegrees * std::numbers::pi / 180 * size + slack;
  }
  if (comparison.worst <= kSameDegrees && same_directions) return comparison;
  comparison.fit = same_bones ? RestFit::same_axes : RestFit::other;
  return comparison;
}

}  // namespace bodyopt
