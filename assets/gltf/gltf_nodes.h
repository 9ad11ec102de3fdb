// The node hierarchy of a glTF file and how a skeleton's joints come out of it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "assets/gltf/gltf_file.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt {

struct NodeTree {
  std::vector<int> parent;            // -1 at the top
  std::vector<std::size_t> order;     // parents before children
  std::vector<JointTransform> local;  // metres, unit rotations
  std::vector<Affine> exact;          // the same, with the shear that a matrix may hold
};

// `unit`: metres per file unit. Adds a note when a node's matrix holds shear, which is dropped. Throws Error(file) for
// cycles, two parents, indices out of range, numbers that are not finite.
NodeTree read_nodes(const GltfFile& file, double unit, std::vector<std::string>& notes);

// Per node, from its space to the world; metres.
std::vector<Affine> world_of_nodes(const NodeTree& tree);

bool scales_evenly(const JointTransform& t);  // all axes alike, but for mirroring

// The joints of a skin by name. Unnamed joints are called joint_<index in the skin>; a name that is already taken gets
// a suffix and a note. Throws Error(file) for an empty skin, joints out of range or listed twice.
struct SkinJoints {
  std::vector<int> nodes;
  std::vector<std::string> names;
  // The number of joints that the skin lists. After them are nodes above them that scale one axis more than another.
  // Folded into joints that turn they would shear them, which no joint holds, but joints above it do.
  std::size_t listed = 0;
};
SkinJoints read_skin_joints(const GltfFile& file, int skin, const NodeTree& tree, std::vector<std::string>& notes);

// Local transforms of joints from those of nodes. Nodes between a joint and the nearest joint above, or the root, are
// folded into it. Resting identity nodes change nothing and are left out.
class JointFold {
 public:
  // joint_nodes: the node of each joint, -1 for none. animated: per node.
  JointFold(const NodeTree& tree, std::span<const int> joint_nodes, const std::vector<bool>& animated);

  // J local transforms; identity for joints without a node. Shear is dropped.
  std::vector<JointTransform> locals(std::span<const JointTransform> node_local) const;

  bool is_folded(std::size_t joint) const { return folded_[joint]; }      // nodes above belong to the joint
  bool is_animated(std::size_t joint) const { return animated_[joint]; }  // the joint's node or one folded into it is
  bool folds(std::size_t node) const { return folds_[node]; }             // the node is folded into some joint
  const std::vector<int>& joint_of_node() const { return joint_of_node_; }
  int joint_above(std::size_t node) const { return joint_above_[node]; }  // nearest joint above a node, or -1

 private:
  std::vector<int> joint_nodes_, joint_of_node_, joint_above_;
  std::vector<int> above_;                 // per node: the next node to fold, or -1
  std::vector<std::size_t> folded_nodes_;  // nodes that some joint folds in, parents first
  std::vector<bool> folds_;                // per node
  std::vector<bool> folded_, animated_;    // per joint
};

}  // namespace bodyopt
