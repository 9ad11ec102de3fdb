// An animation stack of an FBX file, and keys that straight lines may join.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assets/fbx/fbx_curve.h"
#include "assets/fbx/fbx_node_transform.h"

namespace bodyopt {

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

}  // namespace bodyopt
