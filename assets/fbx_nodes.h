// The models of an FBX file as a tree of nodes. Metres, Y up. Armatures that were modelled in other units have a scale
// at rest, along all axes alike. It moves from the nodes into what is below them: joints of a clip are then as far
// apart as those of another file.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assets/fbx_scene.h"

namespace bodyopt {

// One number of an FBX file over time.

class FbxCurve {
 public:
  // Throws Error(file): keys that do not fit, times that decrease, numbers that are not finite.
  FbxCurve(const FbxScene& scene, const FbxObject& curve);

  const std::vector<double>& times() const { return times_; }  // seconds; at least one
  // The value is held before the first and after the last key.
  double at(double seconds) const;
  // Does the file say so, too? Otherwise the curve repeats or goes on.
  bool is_held() const { return is_held_; }

 private:
  enum class Kind { constant, constant_next, linear, cubic };
  // The curve from a key to the next. Weights are how far its tangents reach, of the time between the two.
  struct Span {
    Kind kind = Kind::linear;
    double slope_out = 0, slope_in = 0, weight_out = 1.0 / 3, weight_in = 1.0 / 3;
  };
  void set_spans(const FbxScene& scene, const FbxObject& curve);
  void set_slopes(std::size_t key, std::int64_t flags, const double* data, double before);
  double slope_between(std::size_t key, std::int64_t flags, double bias) const;

  std::vector<double> times_, values_;
  std::vector<Span> spans_;
  bool is_held_ = true;
};

// How a node of an FBX file stands in its parent: translation, rotation, scale, and what else its transform is made of.

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

// An animation stack of an FBX file, and keys that straight lines may join.

class FbxMotion {
 public:
  // Throws Error(file): curves that are damaged, several layers.
  FbxMotion(const FbxScene& scene, const FbxObject& stack);

  bool is_animated(const FbxObject& model) const { return tracks_.contains(model.id); }
  // The model must be animated.
  FbxChannels at(const FbxObject& model, double seconds) const;
  // Seconds, rising: the keys of the models that are animated, within the stack's range, and its ends.
  std::vector<double> times(std::span<const FbxObject* const> models) const;
  bool moves_shapes() const { return moves_shapes_; }  // blend shapes, too

 private:
  struct Track {
    std::array<std::optional<FbxCurve>, 3> curves;  // x, y, z
    Vec3 held;                                      // where there is no curve
  };
  using Tracks = std::array<Track, 3>;              // translation, rotation, scale
  using TrackMap = std::map<std::int64_t, Tracks>;  // by a model's id
  TrackMap read_layer(const FbxScene& scene, const FbxObject& layer);
  static void read_track(const FbxScene& scene, const FbxObject& animated, const FbxObject& model, std::size_t property,
                         TrackMap& tracks);
  void set_range(const FbxScene& scene, const FbxObject& stack);
  void check_ends(const FbxScene& scene, const FbxObject& stack) const;

  TrackMap tracks_;
  double first_ = 0, last_ = 0;  // seconds
  bool moves_shapes_ = false;
};

struct FbxKeys {
  std::vector<double> times;  // seconds from the first
  std::vector<JointTransform> locals;
};

// Samples a node's transform `at` (metres) by keys at `times`. It adds keys in between where straight lines would be
// off by 0.02 mm, 0.0023 degrees or 0.00004 of scale. It adds no more once there are `most`.
FbxKeys straight_keys(std::span<const double> times, const std::function<JointTransform(double seconds)>& at,
                      std::size_t most);

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
