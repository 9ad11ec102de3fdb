// The models of an FBX file as a tree of nodes. Metres, Y up. Armatures that were modelled in other units have a scale
// at rest, along all axes alike. It moves from the nodes into what is below them: joints of a clip are then as far
// apart as those of another file.
#pragma once

#include <map>
#include <vector>

#include "assets/fbx/fbx_motion.h"

namespace bodyopt {

class FbxNodes {
 public:
  // Throws Error(file).
  explicit FbxNodes(const FbxScene& scene);

  std::size_t size() const { return nodes_.size(); }  // parents before children
  const FbxObject& model(std::size_t n) const { return *nodes_[n].model; }
  int parent(std::size_t n) const { return nodes_[n].parent; }                     // -1 at the top
  int find(const FbxObject& model) const;                                          // -1 where it is not in the scene
  bool is_lesser_level(std::size_t n) const { return nodes_[n].is_lesser_level; }  // of detail than another's

  // The transform in the parent, at rest or by a motion. Throws Error(file) where a joint does not inherit a scale that
  // is not the same along all axes.
  JointTransform local(std::size_t n, const FbxMotion* motion = nullptr, double seconds = 0) const;
  Affine world(std::size_t n) const;  // as it rests, with the scale that was taken out
  double taken_scale(std::size_t n) const { return nodes_[n].taken_scale; }
  // Models whose motion moves the node in its parent.
  std::vector<const FbxObject*> movers(std::size_t n) const;
  // The transform from the node's mesh, in metres, to the node.
  Affine geometry(std::size_t n) const { return in_metres(nodes_[n].transform.geometry()); }

  double unit() const { return unit_; }  // metres
  Affine in_metres(Affine matrix) const;
  static Affine scaling(double scale) { return affine_from({{0, 0, 0}, {0, 0, 0, 1}, {scale, scale, scale}}); }
  const Quat& axes() const { return axes_; }  // from those of the file

 private:
  struct Node {
    const FbxObject* model;
    int parent;
    bool is_lesser_level;
    FbxNodeTransform transform;
    bool bears_joints = false;
    double own_scale = 1, taken_scale = 1;  // what is taken out of the node, and with all above it
  };
  FbxChannels channels(std::size_t n, const FbxMotion* motion, double seconds) const;
  double inherited_scale(std::size_t n, const FbxMotion* motion, double seconds) const;

  const FbxScene& scene_;
  double unit_;
  Quat axes_;
  std::vector<Node> nodes_;
  std::map<std::int64_t, std::size_t> place_;  // of a model's id
};

}  // namespace bodyopt
