// How a node of an FBX file stands in its parent: translation, rotation, scale, and what else its transform is made of.
#pragma once

#include "assets/fbx/fbx_scene.h"

namespace bodyopt {

struct FbxChannels {
  Vec3 translation{0, 0, 0};
  Vec3 degrees{0, 0, 0};
  Vec3 scale{1, 1, 1};
};

// The effect of the parents' scales on a node, beside moving it.
enum class FbxInheritance { without_shear, with_shear, without_parent };

// Units and axes of the file.
class FbxNodeTransform {
 public:
  // Throws Error(file) for spheric rotation.
  FbxNodeTransform(const FbxScene& scene, const FbxObject& model);

  const FbxChannels& channels() const { return channels_; }  // where nothing animates them
  JointTransform at(const FbxChannels& channels) const;
  // The transform from the node's mesh to the node.
  const Affine& geometry() const { return geometry_; }
  FbxInheritance inheritance() const { return inheritance_; }

 private:
  FbxChannels channels_;
  Vec3 rotation_offset_, rotation_pivot_, scale_offset_, scale_pivot_;
  Quat before_{0, 0, 0, 1}, after_{0, 0, 0, 1};  // pre-rotation, and the inverse of the post-rotation
  int order_ = 0;
  FbxInheritance inheritance_ = FbxInheritance::with_shear;
  Affine geometry_;
};

}  // namespace bodyopt
