#include "cli/arguments/shot_arguments.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "assets/frame_range.h"
#include "assets/shot_modifiers.h"
#include "base/progress.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/modifiers/drive_modifiers.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kMostFrames = 1000000;

// `shot.state` and 1050: `shot.1050.state`.
std::string with_frame(const std::string& path, int frame) {
  const fs::path whole(path);
  return (whole.parent_path() / (whole.stem().string() + "." + std::to_string(frame) + whole.extension().string()))
      .string();
}

// Of three numbers, or none.
Vec3 gravity_of(const JiggleArguments& arguments) {
  Vec3 change{};
  std::ranges::copy(arguments.gravity_change, change.begin());
  return change;
}

}  // namespace

void JiggleArguments::add(CLI::App& verb) {
  const std::string group = "Jiggle";
  add_flag(verb, "--jiggle", jiggle, "Step the dynamics that 'bodyopt dynamics' made: flesh that moves by inertia")
      ->group(group);
  add_option(verb, "--dynamics", dynamics, "FILE", "Dynamics (default: BASIS.dynamics.safetensors beside the basis)")
      ->group(group);
  add_option(verb, "--state-in", state_in, "FILE", "Go on from a state that an earlier part of the shot left")
      ->group(group);
  add_option(verb, "--state-out", state_out, "FILE.state", "Leave the state after the last frame")->group(group);
  add_option(verb, "--state-every", state_every, "And after every so many frames, as FILE.<frame>.state")
      ->check(CLI::Range(1, kMostFrames))
      ->group(group);
  add_option(verb, "--preroll", preroll, "Step so many frames of the clip before the first without writing them")
      ->check(CLI::Range(1, kMostFrames))
      ->group(group);
  add_option(verb, "--cuts", cuts, "R", "Frames at which a new shot begins (jumps are found without)")->group(group);
  add_option(verb, "--gravity-change", gravity_change,
             "Change of gravity against that of the shapes, m/s^2, world (0 9.81 0: weightless)")
      ->expected(3)
      ->type_name("X Y Z")
      ->group(group);
  add_former_option(verb, "--iterations", "the jiggle has one way to solve");
}

void JiggleArguments::check() const {
  const bool any = !dynamics.empty() || !state_in.empty() || !state_out.empty() || state_every > 0 || preroll > 0 ||
                   !cuts.empty() || !gravity_change.empty();
  if (!jiggle && any) throw Error(ErrorKind::usage, "options of the jiggle need --jiggle");
  if (state_every > 0 && state_out.empty()) throw Error(ErrorKind::usage, "--state-every needs --state-out");
  if (preroll > 0 && !state_in.empty()) {
    throw Error(ErrorKind::usage,
                "--preroll and --state-in exclude each other: the state is what a pre-roll would find");
  }
  if (!state_out.empty()) {
    std::error_code ignored;
    if (!state_in.empty() && fs::equivalent(state_in, state_out, ignored)) {
      throw Error(ErrorKind::usage, "--state-out ", state_out, " would write over --state-in");
    }
    require_writable(state_out);
  }
  if (const std::string problem = problem_of_gravity_change(gravity_of(*this)); !problem.empty()) {
    throw Error(ErrorKind::usage, "--gravity-change ", problem);
  }
}

std::string JiggleArguments::file(const std::string& basis) const {
  if (!jiggle) return "";
  return dynamics.empty() ? dynamics_beside(basis).string() : dynamics;
}

std::unique_ptr<Deformer> JiggleArguments::deformer(Basis loaded, const std::string& basis,
                                                    const DeviceChoice& device) const {
  if (!jiggle) return std::make_unique<Deformer>(std::move(loaded), device);
  const std::string file = this->file(basis);
  if (dynamics.empty() && !fs::exists(file)) {
    throw Error(ErrorKind::file, file,
                ": not there; --jiggle needs the dynamics of the basis: make them with 'bodyopt "
                "dynamics', or name them with --dynamics");
  }
  JiggleOptions chosen;
  chosen.gravity_change = gravity_of(*this);
  if (!cuts.empty()) chosen.cuts = parse_frame_range(cuts);
  std::ranges::sort(chosen.cuts);
  Dynamics tables = load_dynamics(file, loaded);
  auto result = std::make_unique<Deformer>(std::move(loaded), std::move(tables), chosen, device);
  if (!state_in.empty()) result->set_state(load_state(state_in, *result->dynamics()));
  return result;
}

void JiggleArguments::check_frames(const Deformer& deformer, const Clip& clip, const std::vector<int>& frames) const {
  if (!jiggle) return;
  const double rate = static_cast<double>(deformer.dynamics()->jiggle.step.frames_per_second);
  if (std::abs(clip.fps - rate) > 1e-3 * rate) {
    throw Error(
        ErrorKind::mismatch,
        format("the dynamics step {:g} frames a second, the clip has {:g}: sample it with --fps {:g}, or make the "
               "dynamics anew with 'bodyopt dynamics --fps {:g}'",
               rate, clip.fps, rate, clip.fps));
  }
  if (!std::ranges::is_sorted(frames)) throw Error(ErrorKind::usage, "--jiggle needs frames in rising order");
  const JiggleState state = deformer.state();
  if (state.known > 0 && !frames.empty() && frames.front() <= state.frame) {
    throw Error(ErrorKind::usage, format("{} is the state after frame {}; the frames begin at {}, expected {}",
                                         state_in, state.frame, frames.front(), state.frame + 1));
  }
  if (state.known > 0 && !frames.empty() && frames.front() > state.frame + 1) {
    spdlog::warn(
        "{} is the state after frame {}, the frames begin at {}: those between are stepped over in a straight "
        "line",
        state_in, state.frame, frames.front());
  }
  if (frames.empty()) return;
  for (const int cut : deformer.jiggle_options().cuts) {
    if (cut < frames.front() || cut > frames.back()) {
      spdlog::warn("the cut at frame {} is not among the frames {} to {}", cut, frames.front(), frames.back());
    }
  }
}

void JiggleArguments::preroll_to(const Clip& clip, const std::vector<int>& frames, Deformer& deformer) const {
  if (preroll == 0 || frames.empty()) return;
  const int begin = std::max(clip.first_frame, frames.front() - preroll);
  if (frames.front() - begin < preroll) {
    spdlog::warn("the clip has {} frames before frame {}: the pre-roll is that short", frames.front() - begin,
                 frames.front());
  }
  Progress progress("pre-roll", static_cast<std::size_t>(frames.front() - begin));
  for (int frame = begin; frame < frames.front(); ++frame) {
    deformer.jiggle(poses_of(clip, {frame}), {&frame, 1});
    progress.advance();
  }
}

std::optional<std::string> JiggleArguments::write_state_after(const Deformer& deformer, std::size_t done) const {
  if (state_every == 0 || done % static_cast<std::size_t>(state_every) != 0) return std::nullopt;
  const JiggleState state = deformer.state();
  const std::string file = with_frame(state_out, state.frame);
  save_state(state, *deformer.dynamics(), file);
  return file;
}

std::optional<std::string> JiggleArguments::write_last_state(const Deformer& deformer) const {
  if (state_out.empty()) return std::nullopt;
  save_state(deformer.state(), *deformer.dynamics(), state_out);
  return state_out;
}

void ModifierArguments::add(CLI::App& verb) {
  const std::string group = "Modifiers";
  add_option(verb, "--modifiers", file, "FILE",
             "Order, switches, strengths and constants for this shot (modifiers.json)")
      ->group(group);
  add_option(verb, "--control", settings, "A control at one value over the clip: 'breath=0.5', 'breath.rate=20'")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(group);
}

void ModifierArguments::choose(Basis& basis) const {
  if (file.empty()) return;
  if (basis.modifiers.empty()) {
    throw Error(ErrorKind::mismatch, "the basis has no modifiers that ", file,
                " could choose of: give it some with 'bodyopt modifiers'");
  }
  choose_modifiers(file, basis.modifiers);
}

void ModifierArguments::apply(const Basis& basis, Clip& clip) const {
  std::vector<std::string> known = basis.residual.controls;
  for (const std::string& name : modifier_channels(basis.modifiers)) known.push_back(name);
  set_channels(settings, known, clip);
  say(apply_channels(basis, clip));
}

}  // namespace bodyopt::cli
