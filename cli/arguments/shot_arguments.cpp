#include "cli/arguments/shot_arguments.h"

#include <algorithm>
#include <map>

#include "base/progress.h"
#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"

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

const std::map<std::string, ProgressStyle> kStyles = {{"auto", ProgressStyle::automatic},
                                                      {"bar", ProgressStyle::bar},
                                                      {"lines", ProgressStyle::lines},
                                                      {"json", ProgressStyle::json},
                                                      {"openjd", ProgressStyle::openjd}};

}  // namespace

void JiggleArguments::add(CLI::App& verb, shots::JiggleChoice& choice) {
  const std::string group = "Jiggle";
  add_flag(verb, "--jiggle", choice.jiggle,
           "Step the dynamics that 'bodyopt dynamics' made: flesh that moves by inertia")
      ->group(group);
  add_option(verb, "--dynamics", choice.dynamics, "FILE",
             "Dynamics (default: BASIS.dynamics.safetensors beside the basis)")
      ->group(group);
  add_option(verb, "--state-in", choice.state_in, "FILE", "Go on from a state that an earlier part of the shot left")
      ->group(group);
  add_option(verb, "--state-out", state_out, "FILE.state", "Leave the state after the last frame")->group(group);
  add_option(verb, "--state-every", state_every, "And after every so many frames, as FILE.<frame>.state")
      ->check(CLI::Range(1, kMostFrames))
      ->group(group);
  add_option(verb, "--preroll", choice.preroll, "Step so many frames of the clip before the first without writing them")
      ->check(CLI::Range(1, kMostFrames))
      ->group(group);
  add_option(verb, "--cuts", choice.cuts, "R", "Frames at which a new shot begins (jumps are found without)")
      ->group(group);
  add_option(verb, "--gravity-change", choice.gravity_change,
             "Change of gravity against that of the shapes, m/s^2, world (0 9.81 0: weightless)")
      ->expected(3)
      ->type_name("X Y Z")
      ->group(group);
  add_former_option(verb, "--iterations", "the jiggle has one way to solve");
}

void JiggleArguments::check(const shots::JiggleChoice& choice) const {
  const bool any = !choice.dynamics.empty() || !choice.state_in.empty() || !state_out.empty() || state_every > 0 ||
                   choice.preroll > 0 || !choice.cuts.empty() || !choice.gravity_change.empty();
  if (!choice.jiggle && any) throw Error(ErrorKind::usage, "options of the jiggle need --jiggle");
  if (state_every > 0 && state_out.empty()) throw Error(ErrorKind::usage, "--state-every needs --state-out");
  if (choice.preroll > 0 && !choice.state_in.empty()) {
    throw Error(ErrorKind::usage,
                "--preroll and --state-in exclude each other: the state is what a pre-roll would find");
  }
  if (!state_out.empty()) {
    std::error_code ignored;
    if (!choice.state_in.empty() && fs::equivalent(choice.state_in, state_out, ignored)) {
      throw Error(ErrorKind::usage, "--state-out ", state_out, " would write over --state-in");
    }
    require_writable(state_out);
  }
  Vec3 gravity{};
  std::ranges::copy(choice.gravity_change, gravity.begin());
  if (const std::string problem = problem_of_gravity_change(gravity); !problem.empty()) {
    throw Error(ErrorKind::usage, "--gravity-change ", problem);
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

void add_shot(CLI::App& verb, std::string& basis, ClipArguments& clip, std::string& session) {
  CLI::Option& of_basis = *add_required(verb, "basis", basis, "BASIS", "Basis (.safetensors)");
  clip.add(verb);
  CLI::Option& of_clip = *verb.get_option("--clip");
  add_option(
      verb, "--session", session, "FILE",
      "A session of the viewport: its first character, in place of BASIS, with its clip as it was posed and keyed")
      ->each([&of_basis, &of_clip](const std::string&) {
        of_basis.required(false);
        of_clip.required(false);
      });
}

void add_modifier_options(CLI::App& verb, shots::ShotFiles& files) {
  const std::string group = "Modifiers";
  add_option(verb, "--modifiers", files.modifiers, "FILE",
             "Order, switches, strengths and constants for this shot (modifiers.json)")
      ->group(group);
  add_option(verb, "--control", files.controls, "A control at one value over the clip: 'breath=0.5', 'breath.rate=20'")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(group);
}

void TaskArguments::add(CLI::App& verb) {
  given = verb_arguments();
  const std::string group = "On a farm";
  add_flag(verb, "--resume", resume,
           "Do only what is not done: skip an output whose FILE.done.json says that it was made of these inputs by "
           "these options, go on where a run was interrupted")
      ->group(group);
  add_flag(verb, "--pretend", pretend, "Check everything, say what would be done, and write nothing")->group(group);
  add_option(verb, "--progress", progress, "auto, bar, lines, json or openjd (Open Job Description)")
      ->capture_default_str()
      ->type_name("STYLE")
      ->check(CLI::IsMember(kStyles))
      ->group(group);
}

void TaskArguments::begin() const { set_progress_style(kStyles.at(progress)); }

void parse_step(CLI::App& verb, const farm::FarmStep& step, const std::string& progress) {
  std::vector<std::string> words{step.arguments.begin() + 1, step.arguments.end()};
  words.insert(words.end(), {"--progress", progress});
  std::ranges::reverse(words);  // as CLI11 takes them
  try {
    verb.parse(words);
  } catch (const CLI::ParseError& error) {
    throw Error(ErrorKind::usage, step.out, ": its command cannot be read: ", error.what());
  }
}

}  // namespace bodyopt::cli
