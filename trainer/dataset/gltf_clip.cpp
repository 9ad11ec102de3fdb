#include "trainer/dataset/gltf_clip.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "runtime/basis/error.h"
#include "trainer/dataset/clip_common.h"
#include "trainer/dataset/gltf_animation.h"
#include "trainer/dataset/gltf_nodes.h"
#include "trainer/dataset/notes.h"

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
  file.fail("has no clip '" + name + "'; its clips are " + list_names(names));
}

// The node of each joint of the skeleton, by name; -1 for none. Joints of the file's own skin come before other nodes
// (a mesh may be called like a joint), animated nodes before still ones.
std::vector<int> match_nodes(const GltfFile& file, const Skeleton& skeleton, const std::vector<bool>& animated) {
  const tinygltf::Model& model = file.model();
  std::map<std::string, int> nodes;
  std::vector<std::string> unused;  // what reading the character notes already
  if (const int skin = choose_skin(file, unused); skin >= 0) {
    const SkinJoints joints = read_skin_joints(file, skin, unused);
    for (std::size_t k = 0; k < joints.nodes.size(); ++k) nodes.try_emplace(joints.names[k], joints.nodes[k]);
  }
  for (const bool wanted : {true, false}) {
    for (std::size_t n = 0; n < model.nodes.size(); ++n) {
      if (animated[n] == wanted && !model.nodes[n].name.empty()) {
        nodes.try_emplace(model.nodes[n].name, static_cast<int>(n));
      }
    }
  }
  std::vector<int> matched;
  for (const Joint& joint : skeleton.joints) {
    const auto found = nodes.find(joint.name);
    matched.push_back(found == nodes.end() ? -1 : found->second);
    if (found != nodes.end()) nodes.erase(found);  // a node moves one joint
  }
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

  Pose at(double seconds) const {
    std::vector<JointTransform> nodes = tree.local;
    for (const AnimationChannel& channel : channels) {
      set_component(nodes[channel.node], channel.path, channel.sample(seconds), unit);
    }
    Pose pose;
    pose.joints = fold.locals(nodes);
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      if (!fold.is_animated(j)) pose.joints[j] = skeleton.joints[j].default_local;
    }
    return pose;
  }
};

void note_names(const GltfFile& file, const Motion& motion, const std::vector<bool>& animated,
                std::vector<std::string>& notes) {
  std::vector<std::string> still, foreign, moved;
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {
    const Joint& joint = motion.skeleton.joints[j];
    if (motion.joint_nodes[j] < 0) {
      still.push_back(joint.name);
    } else if (motion.fold.joint_above(static_cast<std::size_t>(motion.joint_nodes[j])) != joint.parent) {
      moved.push_back(joint.name);
    }
  }
  for (std::size_t n = 0; n < animated.size(); ++n) {
    if (!animated[n] || motion.fold.joint_of_node()[n] >= 0 || motion.fold.folds(n)) continue;
    const std::string& name = file.model().nodes[n].name;
    foreign.push_back(name.empty() ? "node " + std::to_string(n) : name);
  }
  bool moves = false;
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) moves = moves || motion.fold.is_animated(j);
  if (!moves) fail_unmatched(file.path().string(), motion.skeleton, foreign);
  if (!still.empty())
    notes.push_back("Joints that the clip's file does not have stay at rest: " + list_names(still) + ".");
  if (!foreign.empty())
    notes.push_back("Animated nodes that are no joints of the skeleton: " + list_names(foreign) + ".");
  if (!moved.empty()) {
    notes.push_back("Joints with another parent in the clip's file (their local motion is applied as it is): " +
                    list_names(moved) + ".");
  }
}

void note_scale(const Clip& clip, const Skeleton& skeleton, std::vector<std::string>& notes) {
  std::vector<std::string> scaled;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const Vec3& rest = skeleton.joints[j].default_local.scale;
    if (std::any_of(clip.poses.begin(), clip.poses.end(),
                    [&](const Pose& pose) { return length(pose.joints[j].scale - rest) > 1e-4; })) {
      scaled.push_back(skeleton.joints[j].name);
    }
  }
  if (!scaled.empty()) {
    notes.push_back("The clip scales joints (" + list_names(scaled) +
                    "): scale moves the smoothed skin only, details keep their size.");
  }
}

// The offsets of joints are the character's own build: a clip that brings very different ones is of another.
void require_same_build(const GltfFile& file, const Motion& motion, const Clip& clip) {
  constexpr double kMostRatio = 2;
  double own = 0, brought = 0;
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {
    if (motion.skeleton.joints[j].parent < 0 || !motion.fold.is_animated(j)) continue;
    own += length(motion.skeleton.joints[j].default_local.translation);
    brought += length(clip.poses.front().joints[j].translation);
  }
  if (!(own > 0) || (brought < kMostRatio * own && brought * kMostRatio > own)) return;
  throw Error(ErrorKind::mismatch, file.path().string() + ": the bones it moves are " + std::to_string(brought / own) +
                                       " times as long as the character's: it was made for another character, or in "
                                       "another unit");
}

}  // namespace

Clip read_gltf_clip(const std::filesystem::path& path, const std::string& name, const Skeleton& skeleton,
                    const ClipOptions& options) {
  const GltfFile file(path);
  const std::size_t animation = find_animation(file, name);
  Clip clip;
  clip.name =
      file.model().animations[animation].name.empty() ? path.stem().string() : file.model().animations[animation].name;
  clip.fps = options.fps;
  clip.first_frame = options.first_frame;

  const double unit = options.unit == 0 ? 1 : options.unit;
  NodeTree tree = read_nodes(file, unit, clip.notes);
  std::vector<AnimationChannel> channels = read_channels(file, animation, clip.notes);
  std::vector<bool> animated(tree.parent.size(), false);
  double duration = 0;
  for (const AnimationChannel& channel : channels) {
    animated[channel.node] = true;
    duration = std::max(duration, channel.times.back());
  }
  const std::vector<int> joint_nodes = match_nodes(file, skeleton, animated);
  JointFold fold(tree, joint_nodes, animated);
  for (std::size_t j = 0; j < skeleton.size(); ++j) {  // what is not animated stays as the skeleton has it
    if (joint_nodes[j] >= 0 && !fold.is_folded(j)) {
      tree.local[static_cast<std::size_t>(joint_nodes[j])] = skeleton.joints[j].default_local;
    }
  }
  const Motion motion{skeleton, std::move(channels), std::move(tree), joint_nodes, std::move(fold), unit};
  note_names(file, motion, animated, clip.notes);
  const std::size_t frames =
      frame_count(file.path().string(), duration, std::max(skeleton.size(), animated.size()), options);
  for (std::size_t k = 0; k < frames; ++k) clip.poses.push_back(motion.at(static_cast<double>(k) / options.fps));
  require_same_build(file, motion, clip);
  note_scale(clip, skeleton, clip.notes);
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
