// How the skeleton of a glTF file rests.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "assets/gltf/gltf_nodes.h"

namespace bodyopt {

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

}  // namespace bodyopt
