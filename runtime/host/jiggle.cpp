#include "runtime/host/jiggle.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <utility>

#include "runtime/basis/dynamics.h"
#include "runtime/basis/table_file.h"
#include "runtime/core/error.h"
#include "runtime/core/extent.h"

namespace bodyopt {
namespace {

// Root of the mean squared change of the joints' velocity.
double change_of_velocity(std::span<const double> joints, double interval, const JiggleState& state) {
  double sum = 0;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const double change = (joints[k] - state.joints[k]) / interval - state.joint_velocity[k];
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

struct Coefficients {
  double d, b;

  // Right side of a stage that starts at u, v: count (m / d (v + d g) + inertia u / b). The trapezoidal rule has the
  // force at both its ends: count 2; BDF2 at its end alone: 1.
  void set_right_side(double count, JiggleStepPush& push) const {
    push.velocity_weight = static_cast<float>(count / d);
    push.displacement_weight = static_cast<float>(count / b);
  }
};

void set_result(double u_from_u, double u_from_z, double v_from_u, double v_from_z, double v_from_v,
                JiggleStepPush& push) {
  push.u_from_u = static_cast<float>(u_from_u);
  push.u_from_z = static_cast<float>(u_from_z);
  push.v_from_u = static_cast<float>(v_from_u);
  push.v_from_z = static_cast<float>(v_from_z);
  push.v_from_v = static_cast<float>(v_from_v);
}

constexpr const char* kSchema = "bodyopt-jiggle-state-1";

// Bounds in sizes of the character; of velocities, in sizes a frame. What jiggles is nowhere near, and further away
// single precision may run out of numbers.
constexpr double kMostJiggle = 1e3;  // off its quasi-static place
constexpr double kMostPlace = 1e6;   // in the world
constexpr int kMostFrame = 2000000000;

// Applies `visit(name, array)` to every array of a state.
template <typename State, typename Visit>
void for_each_array(State& state, Visit visit) {
  visit("joints", state.joints);
  visit("joint_velocity", state.joint_velocity);
  visit("displacement", state.motion.displacement);
  visit("velocity", state.motion.velocity);
  visit("nodes", state.motion.nodes);
  visit("node_velocity", state.motion.node_velocity);
}

// Throws Error(file) where a number is beyond what a character of these dynamics does, or none at all.
void require_bounded(const JiggleState& state, const Dynamics& dynamics, const std::filesystem::path& path) {
  const double size = box_diagonal(dynamics.tets.nodes),
               rate = static_cast<double>(dynamics.jiggle.step.frames_per_second);
  const auto check = [&](const char* name, const auto& values, double most) {
    for (const auto value : values) {
      if (std::abs(static_cast<double>(value)) <= most) continue;
      std::ostringstream text;
      text << path.string() << ": '" << name << "' has the number " << value << ", expected " << most
           << " at most for a character of " << size << " m: the jiggle blew up, or the file is damaged";
      throw Error(ErrorKind::file, text.str());
    }
  };
  check("displacement", state.motion.displacement, kMostJiggle * size);
  check("velocity", state.motion.velocity, kMostJiggle * size * rate);
  check("nodes", state.motion.nodes, kMostPlace * size);
  check("node_velocity", state.motion.node_velocity, kMostPlace * size * rate);
  check("joints", state.joints, kMostPlace * size);
  check("joint_velocity", state.joint_velocity, kMostPlace * size * rate);
  check("origin", state.origin, kMostPlace * size);
}

class StateReader {
 public:
  explicit StateReader(const std::filesystem::path& path) : path_(path), file_(read_safetensors(path)) {
    metadata("checksum");
    if (metadata("schema") != kSchema) {
      refuse("it is not a state of the jiggle (schema '", metadata("schema"), "', expected '", kSchema, "')");
    }
  }

  const std::string& metadata(const std::string& key) const {
    const auto found = file_.metadata.find(key);
    if (found == file_.metadata.end()) refuse("its metadata lacks '", key, "'");
    return found->second;
  }

  int integer(const std::string& key) const {
    try {
      std::size_t end = 0;
      const int value = std::stoi(metadata(key), &end);
      if (end == metadata(key).size()) return value;
    } catch (const std::exception&) {
    }
    refuse("its '", key, "' is not a whole number: '", metadata(key), "'");
  }

  template <typename T>
  void read(const std::string& name, std::vector<T>& values) const {
    const auto found = file_.tensors.find(name);
    if (found == file_.tensors.end()) refuse("tensor '", name, "' is missing");
    const Tensor& tensor = found->second;
    if (tensor.dtype != dtype_of<T>() || tensor.shape.size() != 2 || tensor.shape[1] != 3) {
      refuse("tensor '", name, "' is not rows of three numbers");
    }
    values.resize(tensor.bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), tensor.bytes.data(), tensor.bytes.size());
    for (const T value : values) {
      if (!std::isfinite(value)) refuse("tensor '", name, "' has a number that is not finite");
    }
  }

  [[noreturn]] void refuse(const auto&... what) const { throw Error(ErrorKind::file, path_, ": ", what...); }

 private:
  const std::filesystem::path& path_;
  Safetensors file_;
};

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
  bool jumps = false;
  const double interval = (static_cast<double>(frame) - state.frame) / static_cast<double>(step.frames_per_second);
  if (state.known > 1 && frame > state.frame) {  // before, no velocity is known that could change
    jumps = change_of_velocity(joints, interval, state) > 2 * std::sqrt(9.81 * size);
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
    for (std::size_t k = 0; k < joints.size(); ++k) {
      state.joint_velocity[k] = (joints[k] - state.joints[k]) / interval;
    }
  } else {
    state.known = 1;
    state.joint_velocity.assign(joints.size(), 0.0);
  }
  state.frame = frame;
  std::copy_n(origin, 3, state.origin);
  state.joints.assign(joints.begin(), joints.end());
  return plan;
}

JiggleStepPush jiggle_frame(const Dynamics& dynamics, std::uint32_t fibre_count, std::uint32_t control_count,
                            std::uint32_t frame, const Vec3& gravity_change) {
  JiggleStepPush push{};
  push.node_count = dynamics.tets.node_count();
  push.frame = frame;
  push.fibre_count = fibre_count;
  push.control_count = control_count;
  push.gravity_x = static_cast<float>(gravity_change[0]);
  push.gravity_y = static_cast<float>(gravity_change[1]);
  push.gravity_z = static_cast<float>(gravity_change[2]);
  return push;
}

JiggleStages jiggle_stages(const JiggleStep& step, const JiggleStepPush& frame) {
  const double d = step.stage();
  const Coefficients stage{d, 1 + step.stiffness_damping / d};
  JiggleStepPush push = frame;
  push.duration = step.length();
  push.stage = step.stage();
  set_result(0, 0, 0, 0, 0, push);

  JiggleStages stages{push, std::nullopt, push};
  set_result(1 - 1 / stage.b, 1, -1 / (stage.b * d), 1 / d, 0, stages.end);
  if (step.implicit_euler) {
    stage.set_right_side(1, stages.begin);
    return stages;
  }
  stage.set_right_side(2, stages.begin);
  // The trapezoidal rule ends at u_g = (1 - 2 / b) u + z, v_g = (u_g - u) / d - v. BDF2 starts from c1 u_g - c0 u and
  // c1 v_g - c0 v. Here c1 = 1 / (gamma (2 - gamma)) and c0 = c1 - 1. As c1 is rounded first, 1 - 2 c1 is a float, too,
  // and an undamped mode does not grow by roundings.
  const double c1 = static_cast<float>((1 + std::sqrt(2.0)) / 2), c0 = c1 - 1;
  stages.advance = push;
  set_result(1 - 2 * c1 / stage.b, c1, -2 * c1 / (stage.b * d), c1 / d, -c1 - c0, *stages.advance);
  stage.set_right_side(1, *stages.advance);
  return stages;
}

void save_state(const JiggleState& state, const Dynamics& dynamics, const std::filesystem::path& path) {
  require_bounded(state, dynamics, path);
  Safetensors file;
  for_each_array(state, [&](const char* name, const auto& values) { file.tensors[name] = tensor_from(values, 3); });
  file.tensors["origin"] = tensor_from(std::vector<double>(state.origin, state.origin + 3), 3);
  file.metadata = {{"schema", kSchema},
                   {"dynamics", checksum(dynamics)},
                   {"frame", std::to_string(state.frame)},
                   {"known", std::to_string(state.known)}};
  file.metadata["checksum"] = content_checksum(file);
  write_safetensors(file, path);
}

StateFile read_state(const std::filesystem::path& path) {
  const StateReader reader(path);
  StateFile file{{}, reader.metadata("dynamics")};
  JiggleState& state = file.state;
  for_each_array(state, [&](const char* name, auto& values) { reader.read(name, values); });
  std::vector<double> origin;
  reader.read("origin", origin);
  const int known = reader.integer("known");
  if (known < 0 || known > 2 || origin.size() != 3) reader.refuse("its numbers of frames or its origin are not sound");
  std::copy(origin.begin(), origin.end(), state.origin);
  state.frame = reader.integer("frame");
  if (std::abs(static_cast<double>(state.frame)) > kMostFrame) reader.refuse("its frame is out of range");
  state.known = static_cast<std::uint32_t>(known);
  return file;
}

JiggleState load_state(const std::filesystem::path& path, const Dynamics& dynamics) {
  StateFile file = read_state(path);
  if (file.dynamics != checksum(dynamics)) {
    throw Error(ErrorKind::mismatch, path, ": it is a state of other dynamics (checksum ", file.dynamics,
                ", these have ", checksum(dynamics), "): made again since, or of another character");
  }
  require_bounded(file.state, dynamics, path);
  return std::move(file.state);
}

}  // namespace bodyopt
