// The skeleton of a glTF skin.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "assets/gltf_file.h"
#include "runtime/basis/skeleton.h"
#include "runtime/core/transform.h"

namespace bodyopt {

// The node hierarchy of a glTF file and how a skeleton's joints come out of it.

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

// How the skeleton of a glTF file rests.

struct RestNodes {
  std::vector<JointTransform> local;  // per node
  bool is_bound = false;              // a skin tells it; else nodes may stand in any pose, that of a frame, say
};

// The bind pose of the file's skin in the skin's space, or else the nodes as they are. `unit`: metres per file unit.
// Throws Error(file).
RestNodes read_rest(const GltfFile& file, const NodeTree& tree, double unit);

// The fit of the clip's rest pose to a character when the joints' local transforms are applied as they are.
enum class RestFit {
  same,       // the pose it was compared with: joint by joint the motion is right
  same_axes,  // another pose, but all bones as they are in the character's joints: the same rig, rested otherwise
  other       // something twisted
};

struct RestComparison {
  RestFit fit = RestFit::same;
  double worst = 0;   // degrees between the rotations of a joint
  std::string joint;  // that joint
};

// `rest` and `pose`: per joint of the skeleton; only joints with `matched` count, and of roots only the rotation.
RestComparison compare_rests(std::span<const JointTransform> rest, std::span<const JointTransform> pose,
                             const std::vector<bool>& matched, const Skeleton& skeleton);

struct SkinSkeleton {
  Skeleton skeleton;
  std::vector<std::uint32_t> joint_of_skin;  // skeleton joint of each joint of the skin
  // Exporters often leave a mesh in other units than the world and let the joints scale, mirror or stretch it one way.
  // If the default pose does that to most joints alike, the rest space has it instead. It maps the file's space and
  // units to rest space, metres.
  Affine rest;
  // Per joint of the skeleton: from that rest space, in metres, to the world, as the file's nodes stand.
  std::vector<Affine> shown;
};

// Parents come before children; the order of the file is kept where it already is so. Nodes between joints and above
// the roots are folded into the local transforms, so that posed_joints gives the file's world matrices. `unit`: metres
// per file unit. Throws Error(file).
SkinSkeleton read_skin_skeleton(const GltfFile& file, int skin, double unit, std::vector<std::string>& notes);

// The skin whose nodes draw the most vertices, or one that has all of its joints and more, bound alike; -1 when nothing
// is skinned. Throws Error(file).
int choose_skin(const GltfFile& file);

// Per skin of the file, the joints of `skin` that its joints are, in its order. They are given if all of them are bound
// as there: the meshes of both are then one character. Empty else. Throws Error(file).
std::vector<std::vector<std::uint32_t>> joints_of_skins(const GltfFile& file, int skin);

// The median of some joints' scales, if most are within 1 % of it. It may also be one that only another unit explains,
// not between 1/2 and 2. Otherwise 1.
double common_scale(std::vector<double> scales);

// The determinant of the linear part.
double determinant(const Affine& a);

// One per joint of a skin, in its order; translations in metres. Throws Error(file).
std::vector<Affine> read_inverse_binds(const GltfFile& file, int skin, std::size_t joint_count, double unit);

// The length of a glTF file's unit.

// Metres per unit of the file: `given`, where it is not 0. Otherwise 1, if there is no skin, or its bounding box, as
// its joints scale it, then has a diagonal of 0.05 to 50 m. Else it is the centimetre, millimetre, hundred or thousand
// metres that brings it there and nearest to a person's 2 m. A note says so. Throws Error(file) where none does,
// Error(usage) for what is no unit.
double file_unit(const GltfFile& file, double given, std::vector<std::string>& notes);

// The diagonal of the box around points; 0 without points.
double bounding_box_diagonal(const std::vector<Vec3>& points);

}  // namespace bodyopt
