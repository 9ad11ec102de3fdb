#include "assets/clips/gltf_motion.h"

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace bodyopt {
namespace {

// The numbers of one property of one joint over the clip, frames x 3 or 4, and whether it ever leaves the default.
struct Track {
  std::vector<float> values;
  bool varies = false;
};

template <class Property>
Track track_of(const Clip& clip, const JointTransform& rest, std::size_t joint, Property property) {
  Track track;
  for (const Pose& pose : clip.poses) {
    const auto& value = pose.joints[joint].*property;
    track.varies = track.varies || value != rest.*property;
    for (const double x : value) track.values.push_back(static_cast<float>(x));
  }
  return track;
}

}  // namespace

Clip with_continuous_rotations(Clip clip) {
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    for (std::size_t j = 0; j < clip.poses[k].joints.size(); ++j) {
      Quat& q = clip.poses[k].joints[j].rotation;
      q = normalized(q);
      if (k > 0) {
        const Quat& before = clip.poses[k - 1].joints[j].rotation;
        if (before[0] * q[0] + before[1] * q[1] + before[2] * q[2] + before[3] * q[3] < 0) {
          for (double& x : q) x = -x;
        }
      }
    }
  }
  return clip;
}

Json motion_animation(const Clip& clip, const Skeleton& skeleton, GlbWriter& glb) {
  std::vector<float> times;
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    times.push_back(static_cast<float>(static_cast<double>(k) / clip.fps));
  }
  const std::size_t input = glb.add(times, "SCALAR", GlbTarget::none);

  Json animation = {{"name", clip.name}, {"samplers", Json::array()}, {"channels", Json::array()}};
  const auto add_track = [&](const Track& track, std::size_t joint, const char* property, const char* type) {
    add_channel(input, glb.add(track.values, type, GlbTarget::none), joint, property, animation);
  };
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const JointTransform& rest = skeleton.joints[j].default_local;
    const Track translation = track_of(clip, rest, j, &JointTransform::translation);
    const Track rotation = track_of(clip, rest, j, &JointTransform::rotation);
    const Track scale = track_of(clip, rest, j, &JointTransform::scale);
    const bool is_last_chance = j + 1 == skeleton.size() && animation["channels"].empty();
    if (translation.varies) add_track(translation, j, "translation", "VEC3");
    if (rotation.varies || (is_last_chance && !translation.varies && !scale.varies)) {
      add_track(rotation, j, "rotation", "VEC4");
    }
    if (scale.varies) add_track(scale, j, "scale", "VEC3");
  }
  return animation;
}

}  // namespace bodyopt
