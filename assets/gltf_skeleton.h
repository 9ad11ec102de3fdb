// The skeleton of a glTF skin.
#pragma once

#include <string>
#include <vector>

#include "assets/gltf_nodes.h"

namespace bodyopt {

struct SkinSkeleton {
  Skeleton skeleton;
  std::vector<std::uint32_t> joint_of_skin;  // skeleton joint of each joint of the skin
  // Exporters often leave a mesh in other units than the world and let the joints scale it. Where the default pose
  // scales the whole skin alike, the rest space is scaled instead: multiply rest positions by this.
  double rest_scale = 1;
};

// Parents come before children; the order of the file is kept where it already is so. Nodes between joints and above
// the roots are folded into the local transforms, so that posed_joints gives the file's world matrices. `unit`: metres
// per file unit. Throws Error(file).
SkinSkeleton read_skin_skeleton(const GltfFile& file, int skin, double unit, std::vector<std::string>& notes);

// Of the linear part.
double determinant(const Affine& a);

// Of each joint of a skin, in its order; translations in metres. Throws Error(file).
std::vector<Affine> read_inverse_binds(const GltfFile& file, int skin, std::size_t joint_count, double unit);

}  // namespace bodyopt
