// The jiggle over the frames of a shot: what it knows of the frames before, and how each frame is to be stepped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/core/transform.h"
#include "shaders/include/layout.h"

namespace bodyopt {

struct Dynamics;
struct JiggleStep;

inline constexpr double kMostGravityChange = 1000;  // m/s^2 along an axis: a hundred times the earth's

struct JiggleOptions {
  // Change of gravity against that of the shapes, m/s^2, world: the shapes have gravity in them already. Of
  // kMostGravityChange at most.
  Vec3 gravity_change{};
  // Frames at which a new shot begins, ascending. Jumps that no body makes are found without.
  std::vector<int> cuts{};
};

// Says what is wrong with it, as the end of a sentence that begins with its name; empty: nothing.
std::string problem_of_gravity_change(const Vec3& change);

// Places and motion of the nodes, world axes, N x 3 each: see cpu::JiggleMotion.
struct NodeMotion {
  std::vector<float> displacement, velocity;  // from the quasi-static nodes, metres; its rate, m/s
  std::vector<float> nodes, node_velocity;    // quasi-static, relative to the frame's origin, metres; m/s
};

// Memory of the frames before. Empty vectors, and `known` 0: there is none.
struct JiggleState {
  int frame = 0;                               // the last one
  std::uint32_t known = 0;                     // frames that are known: 0, 1 (no velocity yet), 2 (all that is needed)
  double origin[3] = {};                       // of the last frame, metres, world
  std::vector<double> joints, joint_velocity;  // J x 3, world: metres, m/s
  NodeMotion motion;
};

enum class JiggleStart {
  goes_on,  // from the frame before
  first,    // nothing is known
  cut,      // declared
  jump,     // the joints jump as no body does
  gap,      // more than a second after the frame before
  back,     // before the frame before
};
// "frame 12: ..." for the user; nothing of `goes_on` and `first`.
std::optional<std::string> describe(JiggleStart start, int frame);

// How one frame is stepped.
struct JiggleFrame {
  JiggleStart start = JiggleStart::first;
  bool repeats = false;     // the frame before again: nothing moves
  std::uint32_t steps = 0;  // of JiggleStep::length()
  JiggleKickPush kick{};    // without the counts
};

// Decides by frame number, declared cuts and joints (J x 3, world, metres) alone, so that every device does the same.
// Brings `state` (all but its motion) to the frame. A frame that starts anew has displacement 0. In a jump the joints'
// velocity, known from the second frame on, changes by more than 2 sqrt(9.81 m/s^2 x size), root mean square. `size`:
// the diagonal of the rest skin. That is 8 m/s for a person, where landing from a leap is 3 or 4.
JiggleFrame plan_frame(int frame, std::span<const double> joints, const double (&origin)[3], double size,
                       const JiggleStep& step, const JiggleOptions& options, JiggleState& state);

struct StateFile {
  JiggleState state;
  std::string dynamics;  // checksum of those it belongs to
};

// Safetensors with a checksum and the hash of the dynamics it belongs to. Written to a temporary name, then renamed.
// Throws Error(file), also at numbers far beyond the character's size; load_state: Error(mismatch) where it is of other
// dynamics. Whether a state fits the character is looked at by Deformer::set_state.
void save_state(const JiggleState& state, const Dynamics& dynamics, const std::filesystem::path& path);
StateFile read_state(const std::filesystem::path& path);
JiggleState load_state(const std::filesystem::path& path, const Dynamics& dynamics);

// How one step of the jiggle is taken: the numbers that jiggle_begin, jiggle_advance and jiggle_end work with.

struct Dynamics;
struct JiggleStep;

// A step is: begin, solve; where there is advance: advance, solve; end.
struct JiggleStages {
  JiggleStepPush begin;
  std::optional<JiggleStepPush> advance;  // of TR-BDF2; implicit Euler has one stage
  JiggleStepPush end;
};

// Gives jiggle_stages what is the frame's: its number in the arrays of the batch, their counts, and the change of
// gravity, m/s^2.
JiggleStepPush jiggle_frame(const Dynamics& dynamics, std::uint32_t fibre_count, std::uint32_t control_count,
                            std::uint32_t frame, const Vec3& gravity_change);

// TR-BDF2 (Bank et al. 1985) is the trapezoidal rule to gamma h, then BDF2 to h. Both stages share one system A =
// inertia + b K with b = 1 + beta / d. So K u = (A - inertia) u / b, and no product with K is needed. `frame` has the
// counts, the frame's number and gravity; the rest of it is ignored.
JiggleStages jiggle_stages(const JiggleStep& step, const JiggleStepPush& frame);

}  // namespace bodyopt
