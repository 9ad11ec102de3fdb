#include <algorithm>
#include <cmath>

#include "runtime/basis/dynamics.h"
#include "runtime/host/jiggle.h"

namespace bodyopt {
namespace {

// Root of the mean squared change of the joints' velocity; their new velocity goes to `velocity`.
double change_of_velocity(std::span<const double> joints, double interval, const JiggleState& state,
                          std::vector<double>& velocity) {
  velocity.resize(joints.size());
  double sum = 0;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    velocity[k] = (joints[k] - state.joints[k]) / interval;
    const double change = velocity[k] - (state.known > 1 ? state.joint_velocity[k] : 0);
    sum += change * change;
  }
  return std::sqrt(3 * sum / std::max<double>(1, static_cast<double>(joints.size())));
}

JiggleStart start_of(int frame, bool jumps, const JiggleStep& step, const JiggleOptions& options,
                     const JiggleState& state) {
  if (state.known == 0) return JiggleStart::first;
  if (frame < state.frame) return JiggleStart::back;
  // A declared cut stands before its frame, also where that frame itself is skipped.
  const auto cut = std::upper_bound(options.cuts.begin(), options.cuts.end(), state.frame);
  if (cut != options.cuts.end() && *cut <= frame) return JiggleStart::cut;
  const double second = std::max(1.0, static_cast<double>(step.frames_per_second));  // in frames, one at least
  if (static_cast<double>(frame) - state.frame > second) return JiggleStart::gap;
  return jumps ? JiggleStart::jump : JiggleStart::goes_on;
}

}  // namespace

std::string problem_of_gravity_change(const Vec3& change) {
  const auto sound = [](double g) { return std::abs(g) <= kMostGravityChange; };  // a NaN is not
  if (std::ranges::all_of(change, sound)) return {};
  return "expects three finite numbers, of " + std::to_string(std::lround(kMostGravityChange)) + " m/s^2 at most";
}

std::optional<std::string> describe(JiggleStart start, int frame) {
  const std::string at = "frame " + std::to_string(frame) + ": ";
  switch (start) {
    case JiggleStart::cut:
      return at + "a cut, as declared: the jiggle starts anew";
    case JiggleStart::jump:
      return at + "the body jumps as at a cut: the jiggle starts anew";
    case JiggleStart::gap:
      return at + "more than a second after the frame before: the jiggle starts anew";
    case JiggleStart::back:
      return at + "before the frame before: the jiggle starts anew";
    case JiggleStart::goes_on:
    case JiggleStart::first:
      break;
  }
  return std::nullopt;
}

JiggleFrame plan_frame(int frame, std::span<const double> joints, const double (&origin)[3], double size,
                       const JiggleStep& step, const JiggleOptions& options, JiggleState& state) {
  JiggleFrame plan;
  if (state.known > 0 && frame == state.frame) {
    plan.start = JiggleStart::goes_on;
    plan.repeats = true;
    return plan;
  }
  std::vector<double> velocity;
  bool jumps = false;
  const double interval = (static_cast<double>(frame) - state.frame) / static_cast<double>(step.frames_per_second);
  if (state.known > 0 && frame > state.frame) {
    jumps = change_of_velocity(joints, interval, state, velocity) > 2 * std::sqrt(9.81 * size);
  }
  plan.start = start_of(frame, jumps, step, options, state);
  if (plan.start == JiggleStart::goes_on) {
    plan.steps = static_cast<std::uint32_t>(frame - state.frame) * step.substeps;
    plan.kick.start = state.known;
    plan.kick.inverse_interval = static_cast<float>(1 / interval);
    plan.kick.origin_step_x = static_cast<float>(origin[0] - state.origin[0]);
    plan.kick.origin_step_y = static_cast<float>(origin[1] - state.origin[1]);
    plan.kick.origin_step_z = static_cast<float>(origin[2] - state.origin[2]);
    state.known = 2;
    state.joint_velocity = velocity;
  } else {
    state.known = 1;
    state.joint_velocity.assign(joints.size(), 0.0);
  }
  state.frame = frame;
  std::copy_n(origin, 3, state.origin);
  state.joints.assign(joints.begin(), joints.end());
  return plan;
}

}  // namespace bodyopt
