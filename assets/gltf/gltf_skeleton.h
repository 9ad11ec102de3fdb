// The skeleton of a glTF skin.
#pragma once

#include <string>
#include <vector>

#include "assets/gltf/gltf_nodes.h"

namespace bodyopt {

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

}  // namespace bodyopt
