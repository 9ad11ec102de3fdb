#include "assets/fbx/fbx_motion.h"

#include <algorithm>
#include <cmath>

namespace bodyopt {
namespace {

constexpr const char* kAnimated[] = {"Lcl Translation", "Lcl Rotation", "Lcl Scaling"};
constexpr double kShortestSpan = 1e-3;  // seconds: what jumps takes so long
constexpr int kMostHalvings = 12;

bool is_straight(const JointTransform& from, const JointTransform& to, double share, const JointTransform& there) {
  constexpr double kMetres = 2e-5, kRadians = 4e-5, kScale = 4e-5;
  const auto between = [&](const Vec3& a, const Vec3& b) { return (1 - share) * a + share * b; };
  return length(between(from.translation, to.translation) - there.translation) <= kMetres &&
         length(between(from.scale, to.scale) - there.scale) <= kScale &&
         angle_between(slerp(from.rotation, to.rotation, share), there.rotation) <= kRadians;
}

// Appends keys after the last one, to `end`.
void append_straight(double end, const std::function<JointTransform(double)>& at, int halvings, std::size_t most,
                     FbxKeys& keys) {
  const double begin = keys.times.back();
  const JointTransform from = keys.locals.back(), to = at(end);
  // Waves and whole turns do not return to the line at both places.
  const auto holds = [&](double share) { return is_straight(from, to, share, at(begin + share * (end - begin))); };
  if (halvings < kMostHalvings && keys.times.size() < most && end - begin > kShortestSpan &&
      !(holds(0.309) && holds(0.573))) {
    append_straight((begin + end) / 2, at, halvings + 1, most, keys);
    append_straight(end, at, halvings + 1, most, keys);
    return;
  }
  keys.times.push_back(end);
  keys.locals.push_back(to);
}

void for_each_curve(const auto& tracks, const auto& visit) {
  for (const auto& track : tracks) {
    for (const std::optional<FbxCurve>& curve : track.curves) {
      if (curve) visit(*curve);
    }
  }
}

}  // namespace

FbxMotion::FbxMotion(const FbxScene& scene, const FbxObject& stack) {
  std::string moving;
  for (const FbxObject* layer : scene.into(stack.id, "AnimationLayer")) {
    if (scene.number(*layer, "Mute", 0) != 0 || scene.number(*layer, "Weight", 100) == 0) continue;
    TrackMap tracks = read_layer(scene, *layer);
    if (tracks.empty()) continue;
    if (!tracks_.empty()) {
      scene.fail("the animation '", stack.name, "' has several layers ('", moving, "', '", layer->name,
                 "'); merge them (Maya: Bake Simulation, MotionBuilder: Plot) and export it again");
    }
    tracks_ = std::move(tracks);
    moving = layer->name;
  }
  set_range(scene, stack);
  check_ends(scene, stack);
}

FbxMotion::TrackMap FbxMotion::read_layer(const FbxScene& scene, const FbxObject& layer) {
  TrackMap tracks;
  for (const FbxObject* animated : scene.into(layer.id, "AnimationCurveNode")) {
    for (const auto& [target, name] : scene.targets(animated->id)) {
      moves_shapes_ = moves_shapes_ || target->kind == "Deformer";
      const auto property = static_cast<std::size_t>(std::ranges::find(kAnimated, name) - std::begin(kAnimated));
      if (target->kind == "Model" && property < std::size(kAnimated)) {
        read_track(scene, *animated, *target, property, tracks);
      }
    }
  }
  return tracks;
}

void FbxMotion::read_track(const FbxScene& scene, const FbxObject& animated, const FbxObject& model,
                           std::size_t property, TrackMap& tracks) {
  std::array<std::vector<const FbxObject*>, 3> curves;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    curves[axis] = scene.into(animated.id, "AnimationCurve", std::string("d|") + "XYZ"[axis]);
  }
  if (curves[0].empty() && curves[1].empty() && curves[2].empty()) return;
  const auto [found, is_new] = tracks.try_emplace(model.id);
  if (is_new) {
    const FbxChannels rest = FbxNodeTransform(scene, model).channels();
    found->second[0].held = rest.translation;
    found->second[1].held = rest.degrees;
    found->second[2].held = rest.scale;
  }
  Track& track = found->second[property];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    track.held[axis] = scene.number(animated, std::string("d|") + "XYZ"[axis], track.held[axis]);
    if (!curves[axis].empty()) track.curves[axis].emplace(scene, *curves[axis].front());
  }
}

// The range is the stack's, or that of its keys where they all lie outside.
void FbxMotion::set_range(const FbxScene& scene, const FbxObject& stack) {
  first_ = scene.number(stack, "LocalStart", 0) / scene.ticks();
  last_ = scene.number(stack, "LocalStop", 0) / scene.ticks();
  double first_key = HUGE_VAL, last_key = -HUGE_VAL;
  for (const auto& [id, tracks] : tracks_) {
    for_each_curve(tracks, [&](const FbxCurve& curve) {
      first_key = std::min(first_key, curve.times().front());
      last_key = std::max(last_key, curve.times().back());
    });
  }
  if (!(first_ < last_ && first_ <= last_key && first_key <= last_)) {
    first_ = first_key;
    last_ = last_key;
  }
}

// Cycles and slopes beyond the keys are not read.
void FbxMotion::check_ends(const FbxScene& scene, const FbxObject& stack) const {
  for (const auto& [id, tracks] : tracks_) {
    for_each_curve(tracks, [&](const FbxCurve& curve) {
      if (curve.is_held() || curve.times().size() == 1) return;
      if (curve.times().front() <= first_ && last_ <= curve.times().back()) return;
      scene.fail("the animation '", stack.name,
                 "' goes on beyond its keys (cycles, or slopes: extrapolation); bake it "
                 "and export it again");
    });
  }
}

FbxChannels FbxMotion::at(const FbxObject& model, double seconds) const {
  const auto value = [&](const Track& track) {
    Vec3 numbers = track.held;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (track.curves[axis]) numbers[axis] = track.curves[axis]->at(seconds);
    }
    return numbers;
  };
  const Tracks& tracks = tracks_.at(model.id);
  return {value(tracks[0]), value(tracks[1]), value(tracks[2])};
}

std::vector<double> FbxMotion::times(std::span<const FbxObject* const> models) const {
  std::vector<double> times{first_, last_};
  for (const FbxObject* model : models) {
    const auto found = tracks_.find(model->id);
    if (found == tracks_.end()) continue;
    for_each_curve(found->second, [&](const FbxCurve& curve) {
      std::ranges::copy_if(curve.times(), std::back_inserter(times),
                           [&](double time) { return time > first_ && time < last_; });
    });
  }
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

FbxKeys straight_keys(std::span<const double> times, const std::function<JointTransform(double)>& at,
                      std::size_t most) {
  FbxKeys keys{{times.front()}, {at(times.front())}};
  for (const double time : times.subspan(1)) append_straight(time, at, 0, most, keys);
  for (double& time : keys.times) time -= times.front();
  return keys;
}

}  // namespace bodyopt
