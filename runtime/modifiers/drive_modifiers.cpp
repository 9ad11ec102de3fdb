#include "runtime/modifiers/drive_modifiers.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/core/transformed.h"
#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {
namespace {

const SkinModifierType& type_of(const SkinModifier& modifier) {
  if (const SkinModifierType* type = find_skin_modifier_type(modifier.type)) return *type;
  throw Error(ErrorKind::mismatch, "the modifier '", modifier.name, "' is of the type '", modifier.type,
              "', which this version does not know: made by a newer one?");
}

std::string channel_name(const SkinModifier& modifier, const SkinModifierControl& control) {
  return &control == &kModifierStrength ? modifier.name : modifier.name + "." + control.name;
}

float constant_of(const SkinModifier& modifier, const SkinModifierControl& control) {
  const auto found = modifier.constants.find(control.name);
  return found == modifier.constants.end() ? control.usual : found->second;
}

// Reads the channels of one modifier over a clip.
class ChannelReader {
 public:
  ChannelReader(const SkinModifier& modifier, std::span<const std::string> channels, std::span<const Pose> poses,
                std::vector<std::string>& notes)
      : modifier_(modifier), channels_(channels), poses_(poses), notes_(notes) {}

  // F, within the control's range.
  std::vector<float> values(const SkinModifierControl& control) const {
    const std::string name = channel_name(modifier_, control);
    std::vector<float> values(poses_.size(), constant_of(modifier_, control));
    const auto at = static_cast<std::size_t>(std::ranges::find(channels_, name) - channels_.begin());
    if (at < channels_.size()) {
      for (std::size_t f = 0; f < poses_.size(); ++f) values[f] = poses_[f].controls.at(at);
    }
    clamp(name, control, values);
    return values;
  }

 private:
  void clamp(const std::string& name, const SkinModifierControl& control, std::vector<float>& values) const {
    std::size_t clamped = 0;
    for (float& value : values) {
      const float within = std::isfinite(value) ? std::clamp(value, control.low, control.high) : control.usual;
      if (within != value) ++clamped;
      value = within;
    }
    if (clamped == 0) return;
    const std::string range =
        formatted("%g to %g", static_cast<double>(control.low), static_cast<double>(control.high));
    notes_.push_back("the control '" + name + "' leaves its range, " + range + ", in " + std::to_string(clamped) +
                     " of the clip's " + std::to_string(values.size()) + " frames: clamped there");
  }

  const SkinModifier& modifier_;
  std::span<const std::string> channels_;
  std::span<const Pose> poses_;
  std::vector<std::string>& notes_;
};

void turn_joints(const SkinModifier& modifier, std::span<const float> weights, std::span<Pose> poses) {
  for (std::size_t f = 0; f < poses.size(); ++f) {
    for (const ModifierTurn& turn : modifier.turns) {
      const double weight = static_cast<double>(weights[f * modifier.component_count + turn.component]);
      const Vec3 axis{static_cast<double>(turn.x), static_cast<double>(turn.y), static_cast<double>(turn.z)};
      const double angle = weight * length(axis);
      if (angle == 0) continue;  // not a bit of the pose changes
      if (poses[f].unmodified.empty()) poses[f].unmodified = poses[f].joints;
      Quat& rotation = poses[f].joints.at(turn.joint).rotation;
      rotation = axis_angle((1 / length(axis)) * axis, angle) * rotation;
    }
  }
}

void apply_modifier(const Basis& basis, const SkinModifier& modifier, std::span<const std::string> channels,
                    double rate, std::span<Pose> poses, std::optional<double>& phase, std::vector<std::string>& notes) {
  const SkinModifierType& type = type_of(modifier);
  const auto refuse = [&](const auto&... what) {
    throw Error(ErrorKind::mismatch, "the modifier '", modifier.name, "' ", what..., " that its type '", modifier.type,
                "' needs: damaged, or of another version");
  };
  if (type.components != kAsBaked && modifier.component_count != type.components) {
    refuse("has ", modifier.component_count, " components, not the ", type.components);
  }
  const ChannelReader reader(modifier, channels, poses, notes);
  const std::vector<float> strength = reader.values(kModifierStrength);
  ModifierFrames frames{basis, modifier, rate, poses, phase, {}};
  for (const SkinModifierControl& control : type.controls) frames.controls.push_back(reader.values(control));
  const std::size_t components = modifier.component_count;
  std::vector<float> weights(components * poses.size());
  try {
    type.drive(frames, weights);
  } catch (const std::out_of_range&) {
    refuse("lacks numbers");
  }
  for (std::size_t f = 0; f < poses.size(); ++f) {
    for (std::size_t k = 0; k < components; ++k) {
      weights[f * components + k] *= strength[f];
      poses[f].modifiers[modifier.first_component + k] = weights[f * components + k];
    }
  }
  turn_joints(modifier, weights, poses);
}

}  // namespace

std::vector<ModifierChannel> describe_channels(const SkinModifiers& modifiers) {
  std::vector<ModifierChannel> channels;
  for (const SkinModifier& modifier : modifiers.stack) {
    const auto add = [&](const SkinModifierControl& control) {
      channels.push_back({channel_name(modifier, control), &control, constant_of(modifier, control)});
    };
    add(kModifierStrength);
    for (const SkinModifierControl& control : type_of(modifier).controls) add(control);
  }
  return channels;
}

std::vector<std::string> modifier_channels(const SkinModifiers& modifiers) {
  return transformed(describe_channels(modifiers), &ModifierChannel::name);
}

std::vector<std::string> drive_modifiers(const Basis& basis, std::span<const std::string> channels,
                                         double frames_per_second, std::span<Pose> poses, ModifierState* state) {
  std::vector<std::string> notes;
  if (basis.modifiers.empty()) return notes;
  for (Pose& pose : poses) {
    pose.modifiers.assign(basis.modifiers.component_count(), 0.0f);
    pose.unmodified.clear();
  }
  ModifierState after;  // where one modifier cannot be driven, `state` is as it was
  if (state != nullptr) after = *state;
  after.phases.resize(basis.modifiers.stack.size());
  for (std::size_t k = 0; k < after.phases.size(); ++k) {
    const SkinModifier& modifier = basis.modifiers.stack[k];
    if (modifier.on) apply_modifier(basis, modifier, channels, frames_per_second, poses, after.phases[k], notes);
  }
  if (state != nullptr) *state = std::move(after);
  return notes;
}

std::vector<Quat> world_rotations(const Skeleton& skeleton, const Pose& pose) {
  std::vector<Quat> world;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const Quat own = normalized(pose.joints[j].rotation);
    world.push_back(parent < 0 ? own : world[static_cast<std::size_t>(parent)] * own);
  }
  return world;
}

}  // namespace bodyopt
