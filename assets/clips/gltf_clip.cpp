#include "assets/clips/gltf_clip.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "assets/clips/clip_common.h"
#include "assets/clips/gltf_cameras.h"
#include "assets/clips/joint_match.h"
#include "assets/clips/retarget.h"
#include "assets/gltf/gltf_animation.h"
#include "assets/gltf/gltf_nodes.h"
#include "assets/gltf/gltf_rest.h"
#include "assets/gltf/gltf_skeleton.h"
#include "assets/gltf/gltf_unit.h"
#include "base/spread_evenly.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

std::string animation_name(const tinygltf::Model& model, std::size_t animation) {
  const std::string& name = model.animations[animation].name;
  return name.empty() ? "animation_" + std::to_string(animation) : name;
}

std::size_t find_animation(const GltfFile& file, const std::string& name) {
  const tinygltf::Model& model = file.model();
  if (model.animations.empty()) file.fail("has no animation");
  if (name.empty()) return 0;
  std::vector<std::string> names;
  for (std::size_t a = 0; a < model.animations.size(); ++a) {
    names.push_back(animation_name(model, a));
    if (names.back() == name) return a;
  }
  file.fail("has no clip '", name, "'; its clips are ", list_names(names));
}

// The unit must be as the character's reader finds it. A skin without one, as of a stand-in, does not matter to motion.
double unit_of_skin(const GltfFile& file) {
  std::vector<std::string> unused;
  try {
    return file_unit(file, 0, unused);
  } catch (const Error&) {
    return 1;
  }
}

// Names that joints are matched by, per node. Joints of the file's own skin come before other nodes (a mesh may be
// called like a joint). Animated nodes come before still ones; other nodes have no name.
std::vector<std::string> joint_names(const GltfFile& file, const NodeTree& tree, const std::vector<bool>& animated) {
  const tinygltf::Model& model = file.model();
  std::vector<std::string> names(model.nodes.size());
  std::set<std::string> known;
  std::vector<std::string> unused;  // what reading the character notes already
  if (const int skin = choose_skin(file); skin >= 0) {
    const SkinJoints joints = read_skin_joints(file, skin, tree, unused);
    for (std::size_t k = 0; k < joints.nodes.size(); ++k) {
      names[static_cast<std::size_t>(joints.nodes[k])] = joints.names[k];
      known.insert(joints.names[k]);
    }
  }
  for (const bool wanted : {true, false}) {
    for (std::size_t n = 0; n < model.nodes.size(); ++n) {
      const tinygltf::Node& node = model.nodes[n];
      const bool may_move = animated[n] || node.mesh < 0;
      if (animated[n] == wanted && may_move && names[n].empty() && known.insert(node.name).second) names[n] = node.name;
    }
  }
  return names;
}

// The node of each joint of the skeleton; -1 for none.
std::vector<int> match_nodes(const GltfFile& file, const NodeTree& tree, const Skeleton& skeleton,
                             const std::vector<bool>& animated, const std::string& joint_map,
                             std::vector<std::string>& notes) {
  const std::vector<std::string> names = joint_names(file, tree, animated);
  std::vector<NamedJoint> joints;
  std::vector<int> place(tree.parent.size(), -1);
  for (const std::size_t n : tree.order) {
    const int above = tree.parent[n];
    place[n] = static_cast<int>(joints.size());
    joints.push_back({names[n], above < 0 ? -1 : place[static_cast<std::size_t>(above)]});
  }
  std::vector<int> matched = match_joints(joints, skeleton, joint_map, "the clip " + file.path().string(), notes);
  for (int& node : matched) node = node < 0 ? -1 : static_cast<int>(tree.order[static_cast<std::size_t>(node)]);
  return matched;
}

void set_component(JointTransform& t, ChannelPath path, const std::array<double, 4>& value, double unit) {
  switch (path) {
    case ChannelPath::translation:
      t.translation = unit * Vec3{value[0], value[1], value[2]};
      return;
    case ChannelPath::rotation:
      t.rotation = value;
      return;
    case ChannelPath::scale:
      t.scale = {value[0], value[1], value[2]};
      return;
  }
}

// Everything that stays the same from frame to frame.
struct Motion {
  const Skeleton& skeleton;
  std::vector<AnimationChannel> channels;
  NodeTree tree;
  std::vector<int> joint_nodes;
  JointFold fold;
  double unit;
  double size = 1;  // how much more its joints are scaled than the skeleton's, by an armature: no joint takes that over

  std::vector<JointTransform> nodes_at(double seconds) const {
    std::vector<JointTransform> nodes = tree.local;
    for (const AnimationChannel& channel : channels) {
      set_component(nodes[channel.node], channel.path, channel.sample(seconds), unit);
    }
    return nodes;
  }

  std::vector<Affine> world_at(double seconds) const {
    NodeTree moved = tree;
    const std::vector<JointTransform> nodes = nodes_at(seconds);
    for (const AnimationChannel& channel : channels) moved.exact[channel.node] = affine_from(nodes[channel.node]);
    return world_of_nodes(moved);
  }

  bool is_topmost(std::size_t joint) const {
    return fold.joint_above(static_cast<std::size_t>(joint_nodes[joint])) < 0;
  }

  // Transforms of joints with a node are scaled to the skeleton's size.
  std::vector<JointTransform> locals(std::span<const JointTransform> nodes) const {
    std::vector<JointTransform> all = fold.locals(nodes);
    for (std::size_t j = 0; j < all.size(); ++j) {
      if (joint_nodes[j] >= 0) resize(j, 1 / size, size, all[j]);
    }
    return all;
  }

  void resize(std::size_t joint, double scale, double length, JointTransform& t) const {
    if (is_topmost(joint)) {
      t.scale = scale * t.scale;
    } else {
      t.translation = length * t.translation;
    }
  }

  // Joint by joint.
  Pose at(double seconds) const {
    Pose pose;
    pose.joints = locals(nodes_at(seconds));
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      if (!fold.is_animated(j)) pose.joints[j] = skeleton.joints[j].default_local;
    }
    return pose;
  }
};

void note_unmatched_nodes(const GltfFile& file, const Motion& motion, const std::vector<bool>& animated,
                          std::vector<std::string>& notes) {
  std::vector<std::string> still, foreign;
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {
    if (motion.joint_nodes[j] < 0) still.push_back(motion.skeleton.joints[j].name);
  }
  for (std::size_t n = 0; n < animated.size(); ++n) {
    const tinygltf::Node& node = file.model().nodes[n];
    const bool is_camera = node.camera >= 0 && file.look().contains("cameras");
    if (!animated[n] || motion.fold.joint_of_node()[n] >= 0 || motion.fold.folds(n) || is_camera) continue;
    const std::string& name = node.name;
    foreign.push_back(name.empty() ? "node " + std::to_string(n) : name);
  }
  bool moves = false;
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) moves = moves || motion.fold.is_animated(j);
  if (!moves) fail_unmatched(file.path().string(), motion.skeleton, foreign);
  note_names("Joints that the clip's file does not have stay at rest: ", still, notes);
  note_names("Animated nodes that are no joints of the skeleton: ", foreign, notes);
}

void note_moved(const Motion& motion, std::vector<std::string>& notes) {
  std::vector<std::string> moved;
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {
    const int node = motion.joint_nodes[j], parent = motion.skeleton.joints[j].parent;
    if (node >= 0 && motion.fold.joint_above(static_cast<std::size_t>(node)) != parent) {
      moved.push_back(motion.skeleton.joints[j].name);
    }
  }
  note_names("Joints with another parent in the clip's file (their local motion is applied as it is): ", moved, notes);
}

void note_scale(const Clip& clip, const Skeleton& skeleton, std::vector<std::string>& notes) {
  std::vector<std::string> scaled;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const Vec3& rest = skeleton.joints[j].default_local.scale;
    if (std::ranges::any_of(clip.poses, [&](const Pose& pose) { return length(pose.joints[j].scale - rest) > 1e-4; })) {
      scaled.push_back(skeleton.joints[j].name);
    }
  }
  if (!scaled.empty()) {
    notes.push_back("The clip scales joints (" + list_names(scaled) +
                    "): scale moves the smoothed skin only, details keep their size.");
  }
}

void note_longer(double longer, std::vector<std::string>& notes) {
  notes.push_back("The bones of the clip's character are " + rounded(longer) +
                  " times as long as this one's; how far it travels is scaled by " + rounded(1 / longer) + ".");
}

[[noreturn]] void fail_build(const GltfFile& file, double ratio) {
  throw Error(ErrorKind::mismatch, file.path(), ": the bones it moves are ", ratio,
              " times as long as the character's: it was made for another character, or in another unit");
}

bool is_other_build(double ratio) {
  constexpr double kMostRatio = 2;
  return !(ratio < kMostRatio && ratio * kMostRatio > 1);
}

// No build is so much larger or smaller.
bool is_other_unit(double ratio) {
  constexpr double kMostRatio = 8;
  return !(ratio < kMostRatio && ratio * kMostRatio > 1);
}

// The offsets of joints are the character's own build: a clip that brings very different ones is of another. Those of
// topmost joints, which may be below armatures that are joints, are where the character goes.
void require_same_build(const GltfFile& file, const Motion& motion, const Clip& clip) {
  double own = 0, brought = 0;
  std::vector<bool> is_topmost(motion.skeleton.size(), true);
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {
    if (const int parent = motion.skeleton.joints[j].parent; parent >= 0) {
      const auto above = static_cast<std::size_t>(parent);
      is_topmost[j] = is_topmost[above] && !scales_evenly(motion.skeleton.joints[above].default_local);
    }
    if (is_topmost[j] || !motion.fold.is_animated(j)) continue;
    own += length(motion.skeleton.joints[j].default_local.translation);
    brought += length(clip.poses.front().joints[j].translation);
  }
  if (own > 0 && is_other_build(brought / own)) fail_build(file, brought / own);
}

// Bones may rest at other offsets than this character's, as bound and as its nodes stand. Where they keep them, that is
// the build of the clip's character and no motion: this one keeps its bind offsets.
void keep_own_build(const Motion& motion, const RestNodes& rest, Clip& clip) {
  constexpr double kSame = 0.01, kStays = 1e-3;  // of a bone's length
  constexpr double kRounding = 1e-4;             // of all bones
  const std::vector<JointTransform> brought = motion.locals(rest.local);
  double all = 0;
  for (const Joint& joint : motion.skeleton.joints) all += joint.parent < 0 ? 0 : length(joint.bind.translation);
  std::vector<std::string> kept;
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {
    const Joint& joint = motion.skeleton.joints[j];
    if (joint.parent < 0 || !motion.fold.is_animated(j)) continue;
    if (motion.fold.joint_above(static_cast<std::size_t>(motion.joint_nodes[j])) != joint.parent) continue;
    const Vec3& its = brought[j].translation;
    const auto is_own = [&](const Vec3& own) { return length(its - own) <= kSame * length(own) + kRounding * all; };
    if (is_own(joint.bind.translation) || is_own(joint.default_local.translation)) continue;
    const bool stays = std::ranges::all_of(
        clip.poses, [&](const Pose& pose) { return length(pose.joints[j].translation - its) <= kStays * length(its); });
    if (!stays) continue;
    for (Pose& pose : clip.poses) pose.joints[j].translation = joint.bind.translation;
    kept.push_back(joint.name);
  }
  if (kept.empty()) return;
  clip.notes.push_back("Bones of the clip's character have other lengths (" + list_names(kept) +
                       "): this one keeps its own.");
}

void copy_motion(const GltfFile& file, Motion motion, const RestNodes& rest, std::size_t frames, Clip& clip) {
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {  // what is not animated stays as the skeleton has it
    if (motion.joint_nodes[j] >= 0 && !motion.fold.is_folded(j)) {
      JointTransform& own = motion.tree.local[static_cast<std::size_t>(motion.joint_nodes[j])];
      own = motion.skeleton.joints[j].default_local;
      motion.resize(j, motion.size, 1 / motion.size, own);
    }
  }
  note_moved(motion, clip.notes);
  for (std::size_t k = 0; k < frames; ++k) clip.poses.push_back(motion.at(static_cast<double>(k) / clip.fps));
  require_same_build(file, motion, clip);
  keep_own_build(motion, rest, clip);
  note_scale(clip, motion.skeleton, clip.notes);
}

// Volume ratios of matched joints in space to the skeleton's; below 0 where they are mirrored.
std::vector<double> volumes_of(const Motion& motion, std::span<const JointTransform> nodes) {
  NodeTree tree = motion.tree;
  tree.exact = transformed(nodes, affine_from);
  const std::vector<Affine> world = world_of_nodes(tree),
                            bind = posed_joints(motion.skeleton, bind_pose(motion.skeleton).joints);
  std::vector<double> volumes;
  for (std::size_t j = 0; j < bind.size(); ++j) {
    if (motion.joint_nodes[j] < 0) continue;
    volumes.push_back(determinant(world[static_cast<std::size_t>(motion.joint_nodes[j])]) / determinant(bind[j]));
  }
  return volumes;
}

void require_same_hand(const GltfFile& file, const Motion& motion, const RestNodes& rest) {
  const std::vector<double> volumes = volumes_of(motion, rest.local);
  if (2 * std::ranges::count_if(volumes, [](double volume) { return volume < 0; }) <= std::ssize(volumes)) return;
  throw Error(ErrorKind::mismatch, file.path(),
              ": its nodes mirror the whole character, which would turn the skin inside out: a scale below zero above "
              "its joints? Apply it before the export");
}

double size_of(const Motion& motion, std::span<const JointTransform> nodes) {
  return common_scale(
      transformed(volumes_of(motion, nodes), [](const double volume) { return std::cbrt(std::abs(volume)); }));
}

// The size at rest is 1 where an armature scales joints as the skeleton's own. Nodes that no skin vouches for may stand
// in a frame that stretches joints, which is motion.
double size_at_rest(const Motion& motion, const RestNodes& rest) {
  const double size = size_of(motion, rest.local);
  if (rest.is_bound || size == 1 || is_other_build(size)) return size;
  std::vector<JointTransform> unstretched = rest.local;
  for (const int node : motion.joint_nodes) {
    if (node >= 0) unstretched[static_cast<std::size_t>(node)].scale = {1, 1, 1};
  }
  return size_of(motion, unstretched);
}

// How long the bones are at rest that both have, beside the skeleton's; 1 where there are none.
struct BoneLengths {
  double ratio = 1;
  bool are_alike = false;  // of the same rig, as a whole larger or smaller
};

BoneLengths lengths_of(const Motion& motion, const RestNodes& rest) {
  constexpr double kSame = 0.01;
  constexpr std::size_t kFewest = 3;  // bones that tell without an armature
  const std::vector<JointTransform> locals = motion.locals(rest.local);
  std::vector<std::pair<double, double>> bones;
  double own = 0, brought = 0;
  for (std::size_t j = 0; j < locals.size(); ++j) {
    const int parent = motion.skeleton.joints[j].parent, node = motion.joint_nodes[j];
    if (parent < 0 || node < 0 || motion.fold.joint_above(static_cast<std::size_t>(node)) != parent) continue;
    bones.emplace_back(length(motion.skeleton.joints[j].bind.translation), length(locals[j].translation));
    own += bones.back().first;
    brought += bones.back().second;
  }
  const double ratio = brought / own;
  if (!(own > 0 && brought > 0 && std::isfinite(ratio))) return {};
  const bool by_armature = motion.size != 1 && std::abs(ratio - motion.size) <= kSame * ratio;
  const bool by_bones = bones.size() >= kFewest && std::ranges::all_of(bones, [&](const auto& bone) {
                          return std::abs(bone.second - ratio * bone.first) <= kSame * (bone.second + 0.01 * brought);
                        });
  return {ratio, by_armature || by_bones};
}

// Metres from where the file's nodes put a joint to where joints without shear do, at most; 0 where rounding may do it.
double sheared_by(const Motion& motion, std::span<const JointTransform> nodes, const std::vector<Affine>& world) {
  constexpr double kOff = 1e-4;  // of how far joints are from the origin
  const std::vector<JointTransform> locals = motion.fold.locals(nodes);
  std::vector<Affine> without(locals.size());
  double most = 0, farthest = 0;
  for (const std::size_t n : motion.tree.order) {
    const int j = motion.fold.joint_of_node()[n], above = motion.fold.joint_above(n);
    if (j < 0) continue;
    const Affine own = affine_from(locals[static_cast<std::size_t>(j)]);
    Affine& placed = without[static_cast<std::size_t>(j)];
    placed = above < 0 ? own : without[static_cast<std::size_t>(above)] * own;
    const Vec3 origin = world[n] * Vec3{0, 0, 0};
    most = std::max(most, length(placed * Vec3{0, 0, 0} - origin));
    farthest = std::max(farthest, length(origin));
  }
  return most > kOff * farthest ? most : 0;
}

// Looks at the nodes as they stand and in some of the frames.
void note_shear(const Motion& motion, std::size_t frames, double fps, std::vector<std::string>& notes) {
  constexpr std::size_t kLooks = 16;
  double most = sheared_by(motion, motion.tree.local, world_of_nodes(motion.tree));
  for (const std::size_t k : spread_evenly(frames, kLooks)) {
    const double seconds = static_cast<double>(k) / fps;
    most = std::max(most, sheared_by(motion, motion.nodes_at(seconds), motion.world_at(seconds)));
  }
  if (most == 0) return;
  notes.push_back("Nodes of the clip's file shear its joints, which joints of a character cannot: they lie up to " +
                  rounded(most) + " m from where they should. Apply scales before the export.");
}

// Compares with the bind pose. Nodes that no skin vouches for may also stand as the character's own do.
RestComparison compare_with_character(const Motion& motion, const RestNodes& rest) {
  const std::vector<bool> matched = transformed(motion.joint_nodes, [&](const int node) { return node >= 0; });
  std::vector<JointTransform> bind, own;
  for (const Joint& joint : motion.skeleton.joints) {
    bind.push_back(joint.bind);
    own.push_back(joint.default_local);
  }
  const std::vector<JointTransform> locals = motion.locals(rest.local);
  RestComparison with_bind = compare_rests(locals, bind, matched, motion.skeleton);
  if (rest.is_bound || with_bind.fit != RestFit::other) return with_bind;
  return compare_rests(locals, own, matched, motion.skeleton);
}

SourceMotion source_of(const Motion& motion, const RestNodes& rest) {
  SourceMotion source;
  source.kind = "clip";
  source.in_world = true;
  std::vector<int> place(motion.tree.parent.size(), -1);
  std::vector<bool> travels(motion.tree.parent.size(), false);
  for (const AnimationChannel& channel : motion.channels) {
    if (channel.path == ChannelPath::translation) travels[channel.node] = true;
  }
  for (const std::size_t n : motion.tree.order) {
    const int above = motion.tree.parent[n];
    place[n] = static_cast<int>(source.joints.size());
    source.joints.push_back({{"", above < 0 ? -1 : place[static_cast<std::size_t>(above)]}, rest.local[n], travels[n]});
  }
  source.locals_at = [&motion](double seconds) {
    const std::vector<JointTransform> nodes = motion.nodes_at(seconds);
    return transformed(motion.tree.order, [&](const std::size_t n) { return nodes[n]; });
  };
  return source;
}

void note_lost_scale(const Motion& motion, std::size_t frames, double fps, std::vector<std::string>& notes) {
  std::vector<std::string> scaled;
  for (const AnimationChannel& channel : motion.channels) {
    const int joint = motion.fold.joint_of_node()[channel.node];
    if (channel.path != ChannelPath::scale || joint < 0) continue;
    const Vec3& rest = motion.tree.local[channel.node].scale;
    for (std::size_t k = 0; k < frames; ++k) {
      const std::array<double, 4> scale = channel.sample(static_cast<double>(k) / fps);
      if (length(Vec3{scale[0], scale[1], scale[2]} - rest) <= 1e-4) continue;
      scaled.push_back(motion.skeleton.joints[static_cast<std::size_t>(joint)].name);
      break;
    }
  }
  if (!scaled.empty()) {
    notes.push_back("The clip scales joints (" + list_names(scaled) + "): scale is left out where rest poses differ.");
  }
}

// Less than a third of the joints of either: a few names are those of any creature.
bool has_few_in_common(const Motion& motion) {
  std::set<std::size_t> animated;
  for (const AnimationChannel& channel : motion.channels) animated.insert(channel.node);
  const auto matched =
      static_cast<std::size_t>(std::ranges::count_if(motion.joint_nodes, [](int node) { return node >= 0; }));
  return 3 * matched < std::min(motion.skeleton.size(), animated.size());
}

// Motion of a character that rests in another pose.
void carry_motion(const GltfFile& file, const Motion& motion, const RestNodes& rest, std::size_t frames, Clip& clip) {
  const SourceMotion source = source_of(motion, rest);
  std::vector<int> place(motion.tree.order.size()), match;
  for (std::size_t k = 0; k < place.size(); ++k) place[motion.tree.order[k]] = static_cast<int>(k);
  for (const int node : motion.joint_nodes) match.push_back(node < 0 ? -1 : place[static_cast<std::size_t>(node)]);
  const Retarget retarget(source, motion.skeleton, match, frames, clip.fps, clip.notes);
  const double unit = retarget.fitted_unit() > 0 ? retarget.fitted_unit() : 1;
  if (is_other_build(1 / unit) && has_few_in_common(motion)) fail_build(file, 1 / unit);
  if (std::abs(unit - 1) > 0.01) note_longer(1 / unit, clip.notes);
  for (std::size_t k = 0; k < frames; ++k) clip.poses.push_back(retarget.at(static_cast<double>(k) / clip.fps, unit));
  for (ClipCamera& camera : clip.cameras) {
    camera.height *= unit;
    for (Affine& at : camera.places) {
      for (auto& row : at.m) row[3] *= unit;
    }
  }
  note_lost_scale(motion, frames, clip.fps, clip.notes);
  check_positions(clip, file.path().string());
}

}  // namespace

Clip read_gltf_clip(const GltfFile& file, const std::string& name, const SkeletonChoice& choose,
                    const ClipOptions& options) {
  std::set<std::string> names;
  for (const tinygltf::Node& node : file.model().nodes) names.insert(node.name);
  const Skeleton skeleton = choose(names);
  const std::size_t animation = find_animation(file, name);
  Clip clip;
  clip.name = file.model().animations[animation].name;
  if (clip.name.empty()) clip.name = file.path().stem().string();
  clip.fps = options.fps;
  clip.first_frame = options.first_frame;

  std::vector<std::string> unused;  // what reading the file notes twice
  const double unit = options.unit == 0 ? unit_of_skin(file) : options.unit;
  NodeTree tree = read_nodes(file, unit, clip.notes);
  std::vector<AnimationChannel> channels = read_channels(file, animation, clip.notes);
  std::vector<bool> animated(tree.parent.size(), false);
  double duration = 0;
  for (const AnimationChannel& channel : channels) {
    animated[channel.node] = true;
    duration = std::max(duration, channel.times.back());
  }
  RestNodes rest = read_rest(file, tree, unit);
  const std::vector<int> joint_nodes = match_nodes(file, tree, skeleton, animated, options.joint_map, clip.notes);
  JointFold fold(tree, joint_nodes, animated);
  Motion motion{skeleton, std::move(channels), std::move(tree), joint_nodes, std::move(fold), unit};
  note_unmatched_nodes(file, motion, animated, clip.notes);
  note_parted(skeleton, joint_nodes, clip.notes);
  const std::size_t frames =
      frame_count(file.path().string(), duration, std::max(skeleton.size(), animated.size()), options);
  motion.size = size_at_rest(motion, rest);
  const auto [longer, alike] = lengths_of(motion, rest);
  if (is_other_unit(longer) || (alike && std::abs(longer - 1) > 0.01)) {
    if (is_other_build(longer) && has_few_in_common(motion)) fail_build(file, longer);
    motion.unit = unit / longer;
    motion.tree = read_nodes(file, motion.unit, unused);
    rest = read_rest(file, motion.tree, motion.unit);
    if (is_other_unit(longer)) {
      clip.notes.push_back("A unit of the clip's file is taken as " + rounded(motion.unit) +
                           " m, from the length of the bones.");
    } else {
      note_longer(longer, clip.notes);
    }
  }

  clip.cameras = read_gltf_cameras(
      file, motion.unit, frames, [&](std::size_t k) { return motion.world_at(static_cast<double>(k) / clip.fps); },
      clip.notes);
  note_shear(motion, frames, clip.fps, clip.notes);
  require_same_hand(file, motion, rest);
  const RestComparison rests = compare_with_character(motion, rest);
  if (rests.fit == RestFit::other) {
    carry_motion(file, motion, rest, frames, clip);
    return clip;
  }
  if (rests.fit == RestFit::same_axes && rest.is_bound) {
    clip.notes.push_back("The rest poses of clip and character differ by up to " + rounded(rests.worst) +
                         " degrees ('" + rests.joint +
                         "'), in joints with the same bones: their rotations are applied as they are.");
  }
  const bool travels = std::ranges::any_of(
      motion.channels, [](const AnimationChannel& channel) { return channel.path == ChannelPath::translation; });
  if (travels && motion.unit == unit && is_other_build(longer)) {
    clip.notes.push_back("The bones of the clip's character are " + rounded(longer) +
                         " times as long as this one's, and it travels as far as there: was it made in another unit " +
                         "(--unit " + rounded(unit / longer) + ")?");
  }
  copy_motion(file, std::move(motion), rest, frames, clip);
  return clip;
}

std::vector<int> read_gltf_keys(const std::filesystem::path& path, const std::string& name,
                                const ClipOptions& options) {
  const GltfFile file(path);
  std::vector<std::string> unused;  // what reading the clip notes already
  std::set<int> frames;
  for (const AnimationChannel& channel : read_channels(file, find_animation(file, name), unused)) {
    for (const double time : channel.times) {
      if (time >= 0) frames.insert(options.first_frame + static_cast<int>(std::lround(time * options.fps)));
    }
  }
  return {frames.begin(), frames.end()};
}

}  // namespace bodyopt
