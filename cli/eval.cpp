// bodyopt eval: a basis and a clip to a cache of shapes.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/frame_range.h"
#include "assets/gltf_guard.h"
#include "assets/json_file.h"
#include "base/progress.h"
#include "cli/arguments/common.h"
#include "cli/arguments/shot_arguments.h"
#include "cli/arguments/task_arguments.h"
#include "cli/results/attachments.h"
#include "cli/results/modifier_effects.h"
#include "cli/results/shot_caches.h"
#include "cli/run_steps.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "shots/open_character.h"
#include "shots/session/posed_clip.h"
#include "shots/session/session_file.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct EvalArguments {
  ShotCacheOptions cache;
  ClipArguments clip;
  DeviceArguments device;
  JiggleArguments jiggle;
  ModifierArguments modifiers;
  TaskArguments task;
  JsonOption json;
  std::string session;  // of the viewport: in place of the basis and the clip
  std::string list;     // of shots, in place of all else
  SessionCharacter posed{};
  std::optional<int> in, out;  // ends of the range that a session plays; otherwise the clip's
};

// All files that decide the result.
std::vector<fs::path> inputs_of(const EvalArguments& arguments) {
  std::vector<fs::path> inputs{arguments.cache.basis};
  const std::string& source = arguments.clip.source;
  const fs::path clip = fs::exists(source) ? source : source.substr(0, source.rfind('#'));
  if (!clip.empty()) {
    for (const fs::path& file : gltf_files(clip)) inputs.push_back(file);
  }
  for (const std::string& file :
       {arguments.clip.options.controls, arguments.clip.options.joint_map, arguments.jiggle.file(arguments.cache.basis),
        arguments.jiggle.state_in, arguments.modifiers.file, arguments.session, arguments.posed.files.limits}) {
    if (!file.empty()) inputs.push_back(file);
  }
  const fs::path beside = attachments_beside(arguments.cache.basis);
  if (!arguments.cache.attached.empty()) {
    inputs.push_back(arguments.cache.attached);
  } else if (arguments.cache.level == 0 && fs::exists(beside)) {
    inputs.push_back(beside);
  }
  return inputs;
}

// The level of detail that the options ask for.
Level chosen_level(const EvalArguments& arguments) {
  std::vector<Level> levels = load_levels(arguments.cache.basis);
  if (arguments.cache.level >= levels.size()) {
    throw Error(ErrorKind::usage, format("--level asks for level {}; {} has levels 0 to {}", arguments.cache.level,
                                         arguments.cache.basis, levels.size() - 1));
  }
  Level level = std::move(levels[arguments.cache.level]);
  if (arguments.cache.full_skin && level.carried.empty()) {
    throw Error(ErrorKind::usage, arguments.cache.basis,
                " is no proxy: --full-skin has nothing to carry; leave it out");
  }
  return level;
}

// The lead of a session, its clip and the range that it plays take the place of the options.
void take_session(EvalArguments& arguments) {
  if (arguments.session.empty()) return;
  if (!arguments.cache.basis.empty() || !arguments.clip.source.empty()) {
    throw Error(ErrorKind::usage, "--session names the basis and the clip itself: leave out BASIS and --clip");
  }
  const SessionFile session = read_session(arguments.session);
  arguments.posed = session.cast.front();
  const ActorFiles& files = arguments.posed.files;
  if (!is_basis(files.basis)) {
    throw Error(ErrorKind::usage, arguments.session, ": its lead is '", files.basis,
                "', expected a trained basis (.safetensors): 'bodyopt train' makes one");
  }
  arguments.cache.basis = files.basis;
  arguments.clip.source = files.clip;
  arguments.clip.options.fps = session.clip.fps;
  arguments.clip.options.joint_map = files.joint_map;
  if (!arguments.clip.frames.empty()) return;
  arguments.in = session.view.playback.in;
  arguments.out = session.view.playback.out;
}

// Frames of a clip that its session does not play are left out.
void keep_range(const EvalArguments& arguments, const Clip& clip, std::vector<int>& frames) {
  std::erase_if(
      frames, [&](int frame) { return frame < arguments.in.value_or(frame) || frame > arguments.out.value_or(frame); });
  if (frames.empty()) {
    throw Error(ErrorKind::usage, arguments.session, ": '",
                arguments.clip.source.empty() ? clip.name : arguments.clip.source,
                "' has no frame of the range that it plays: was the clip replaced? --frames chooses others");
  }
}

Clip as_posed(const SessionCharacter& posed, Clip clip, const Skeleton& skeleton) {
  JointLimits limits;
  if (!posed.files.limits.empty()) limits = read_joint_limits(posed.files.limits, skeleton);
  return posed_clip(std::move(clip), skeleton, limits, posed.pose);
}

// Of a session whose lead plays no clip, that which the viewport poses in its place.
Clip read_shot_clip(const EvalArguments& arguments, const Basis& basis, std::vector<int>& frames) {
  if (arguments.clip.source.empty()) {
    return arguments.clip.choose_frames(still_clip(basis.skeleton, arguments.clip.options), frames);
  }
  return arguments.clip.read(basis, kept_unit(basis), frames);
}

EvaluatedShot read_shot(const EvalArguments& arguments) {
  EvaluatedShot shot;
  Level level = chosen_level(arguments);
  if (holds_triangles(arguments.cache.out) && !(arguments.cache.space == CacheSpace())) {
    throw Error(ErrorKind::usage,
                "--unit-out and --axis are for .pc2: a .usda or .glb says itself that it is in metres, Y up");
  }
  if (arguments.cache.full_skin && holds_triangles(arguments.cache.out)) {
    throw Error(ErrorKind::usage,
                "--full-skin writes .pc2: the topology of the full skin, which .usda and .glb hold, is not in a proxy");
  }
  shot.carried = std::move(level.carried);
  arguments.modifiers.choose(level.basis);
  shot.deformer = arguments.jiggle.deformer(std::move(level.basis), arguments.cache.basis, arguments.device.choice);
  const Basis& basis = shot.deformer->basis();
  shot.clip = read_shot_clip(arguments, basis, shot.frames);
  keep_range(arguments, shot.clip, shot.frames);
  if (!arguments.session.empty()) shot.clip = as_posed(arguments.posed, std::move(shot.clip), basis.skeleton);
  arguments.modifiers.apply(basis, shot.clip);
  shot.poses = poses_of(shot.clip, shot.frames);
  arguments.jiggle.check_frames(*shot.deformer, shot.clip, shot.frames);
  return shot;
}

// `shot.####.pc2`: the first frame in place of the signs, a digit each at least.
std::string with_first_frame(const std::string& pattern, int frame) {
  const std::size_t begin = pattern.find('#');
  if (begin == std::string::npos) return pattern;
  const std::size_t end = std::min(pattern.find_first_not_of('#', begin), pattern.size());
  return pattern.substr(0, begin) + format("{:0{}}", frame, end - begin) + pattern.substr(end);
}

Evaluation evaluate_part(const EvalArguments& arguments, Deformer& deformer, std::span<const Pose> poses,
                         std::span<const int> frames) {
  try {
    return arguments.jiggle.jiggle ? deformer.jiggle(poses, frames) : deformer.evaluate(poses);
  } catch (const Error& error) {
    if (!arguments.device.choice.check) throw;
    throw Error(error.kind(), format("frame {}: ", frames.front()), error.what());
  }
}

// Evaluates what is not done yet. Returns the states of the jiggle that were written between.
std::vector<std::string> evaluate_frames(const EvalArguments& arguments, EvaluatedShot& shot, ShotCaches& caches,
                                         const TaskRun* task) {
  const std::size_t done = task != nullptr ? caches.take_up(*task) : 0;
  if (done == 0) arguments.jiggle.preroll_to(shot.clip, shot.frames, *shot.deformer);
  if (done > 0) spdlog::info("goes on after frame {}", shot.frames[done - 1]);
  Progress progress("eval", shot.frames.size() - done,
                    task != nullptr ? "the same command goes on from what is kept of it" : "nothing of it is kept");
  std::vector<std::string> states;
  // Frames held in memory at once. Of the jiggle each is measured, and it may be slow; a check names the one it stops
  // at.
  const std::size_t step = arguments.jiggle.jiggle || arguments.device.choice.check ? 1 : 64;
  for (std::size_t begin = done; begin < shot.poses.size(); begin += step) {
    const std::size_t count = std::min(step, shot.poses.size() - begin);
    const auto poses = std::span(shot.poses).subspan(begin, count);
    const Evaluation part =
        evaluate_part(arguments, *shot.deformer, poses, std::span(shot.frames).subspan(begin, count));
    caches.append(part, begin);
    if (const auto file = arguments.jiggle.write_state_after(*shot.deformer, begin + count)) states.push_back(*file);
    progress.advance(count);
  }
  return states;
}

std::vector<fs::path> outputs_of(const EvalArguments& arguments, const ShotCaches& caches,
                                 const std::vector<std::string>& states) {
  std::vector<fs::path> outputs{arguments.cache.out};
  for (const std::string& cache : caches.attached_paths()) outputs.emplace_back(cache);
  for (const std::string& state : states) outputs.emplace_back(state);
  return outputs;
}

// After an error or an interrupt: puts aside what is done, for the same command to go on there. That it cannot does not
// hide why the run ended.
void keep_done(ShotCaches& caches, const TaskRun& task, const std::vector<int>& frames) {
  try {
    task.require_same_inputs();
    const std::size_t done = caches.put_aside(task);
    if (done > 0) spdlog::info("what is done is kept: the same command goes on after frame {}", frames[done - 1]);
  } catch (const std::exception& error) {
    spdlog::warn("what is done cannot be kept: {}", error.what());
  }
}

// Evaluates and writes what is not done yet. Returns the states of the jiggle that were written.
std::vector<std::string> write_shot(const EvalArguments& arguments, EvaluatedShot& shot, ShotCaches& caches,
                                    const TaskRun* task) {
  try {
    std::vector<std::string> states = evaluate_frames(arguments, shot, caches, task);
    if (task != nullptr) task->require_same_inputs();
    if (const auto file = arguments.jiggle.write_last_state(*shot.deformer)) states.push_back(*file);
    caches.close();  // last: where the cache is in place, its state is, too, and none of an earlier run is beside it
    return states;
  } catch (...) {
    if (task != nullptr) keep_done(caches, *task, shot.frames);
    throw;
  }
}

// Where a cache in metres does not lie on the mesh that it is of.
std::string unit_text(const ShotCacheOptions& cache, const Basis& basis) {
  const double unit = kept_unit(basis);
  if (holds_triangles(cache.out) || cache.space.unit != 1 || unit == 0 || unit == 1) return "";
  return format("the cache is in metres; --unit-out {} lays it on the mesh of the character's own file\n",
                Json(unit).dump());
}

void evaluate(const EvalArguments& arguments, EvaluatedShot& shot, const TaskRun* task) {
  const Stopwatch watch;
  const std::string about_unit = unit_text(arguments.cache, shot.deformer->basis());  // first: it may be damaged
  ShotCaches caches(arguments.cache, shot);
  shot.deformer->set_normals(holds_normals(arguments.cache.out) || arguments.cache.full_skin ||
                             arguments.device.choice.check);
  const std::vector<std::string> states = write_shot(arguments, shot, caches, task);
  const double seconds = watch.seconds();

  const std::vector<fs::path> outputs = outputs_of(arguments, caches, states);
  Json summary = caches.log().summary();
  summary["seconds"] = seconds;
  summary["device"] = shot.deformer->device_name();
  if (task != nullptr) task->finish(outputs, summary);
  std::string text = format("{} frames of {} points on {} in {:.2f} s\n", shot.frames.size(), caches.points(),
                            shot.deformer->device_name(), seconds) +
                     caches.log().text();
  const std::optional<ShotFolds> folds = measure_shot_folds(shot.deformer->basis(), shot.poses, shot.frames);
  if (folds) text += text_of(*folds);
  const ShotMoves moves = measure_shot_moves(shot.deformer->basis(), shot.poses, shot.frames);
  text += text_of(moves);
  for (const fs::path& file : outputs) text += "wrote " + file.string() + "\n";
  text += about_unit;
  Json result = caches.log().result();
  if (folds) result["push_out"] = to_json(*folds);
  if (!moves.moves.empty()) result["modifiers"] = to_json(moves);
  result["cache"] = arguments.cache.out;
  result["points"] = caches.points();
  result["device"] = shot.deformer->device_name();
  result["seconds"] = seconds;
  result["jiggle"] = arguments.jiggle.jiggle;
  result["states"] = states;
  result["attached"] = caches.attached();
  arguments.json.emit(result, text);
}

// Says what would be done, without doing it.
void pretend(const EvalArguments& arguments, const EvaluatedShot& shot, const TaskRun* task) {
  std::string doing = "would evaluate";
  std::size_t kept = 0;
  if (task != nullptr) {
    if (task->done({arguments.cache.out})) doing = "is done already:";
    if (const auto checkpoint = task->read_checkpoint()) kept = checkpoint->frames;
  }
  std::string text = format("{} frames {} of '{}' on {}, to {}\n", doing, format_frame_range(shot.frames),
                            arguments.clip.source.empty() ? shot.clip.name : arguments.clip.source,
                            shot.deformer->device_name(), arguments.cache.out);
  if (kept > 0) text += format("an interrupted run left {} of them\n", kept);
  arguments.json.emit({{"pretended", true},
                       {"done", doing == "is done already:"},
                       {"frames", format_frame_range(shot.frames)},
                       {"kept_frames", kept},
                       {"device", shot.deformer->device_name()},
                       {"cache", arguments.cache.out}},
                      text);
}

// The report is an output, too: without it, or where it goes to standard output, the work is done again.
bool is_done(const EvalArguments& arguments, const TaskRun& task) {
  std::vector<fs::path> outputs{arguments.cache.out};
  if (!arguments.jiggle.state_out.empty()) outputs.emplace_back(arguments.jiggle.state_out);
  if (!arguments.json.path.empty() && !fs::exists(arguments.json.path)) return false;
  return task.done(outputs).has_value();
}

void run(EvalArguments arguments) {
  if (!arguments.list.empty()) return run_show_list(arguments.list, arguments.task.progress);
  take_session(arguments);
  arguments.task.begin();
  arguments.json.require_writable();
  arguments.jiggle.check();
  if (arguments.cache.out.find('#') != std::string::npos) {
    // The clip alone knows its first frame.
    if (arguments.clip.frames.empty() && !arguments.in) {
      throw Error(ErrorKind::usage, "--out with '#' stands for the first frame and needs --frames");
    }
    const int first = arguments.in ? *arguments.in : parse_frame_range(arguments.clip.frames).front();
    arguments.cache.out = with_first_frame(arguments.cache.out, first);
  }
  std::optional<TaskRun> task;
  if (arguments.task.resume)
    task.emplace(arguments.cache.out, BODYOPT_VERSION, arguments.task.given, inputs_of(arguments));
  if (task && !arguments.task.pretend && is_done(arguments, *task)) {
    std::fputs(("already done: " + arguments.cache.out + "\n").c_str(), arguments.json.path == "-" ? stderr : stdout);
    return;
  }
  try {
    EvaluatedShot shot = read_shot(arguments);
    if (arguments.task.pretend) return pretend(arguments, shot, task ? &*task : nullptr);
    evaluate(arguments, shot, task ? &*task : nullptr);
  } catch (const Error& error) {
    if (task && !arguments.task.pretend) task->fail(error);
    throw;
  }
}

// Says all that other options say, of many; only how progress is shown is left to the command line.
void add_list(CLI::App& verb, std::string& list) {
  const std::vector<CLI::Option*> others = verb.get_options(
      [](const CLI::Option* option) { return !option->check_name("--progress") && !option->check_name("--help"); });
  CLI::Option& option = *add_option(
      verb, "--list", list, "SHOTS",
      "A list of shots (.json, .jsonl, .csv): makes the outputs of all that are not made yet, one after the other");
  for (CLI::Option* other : others) option.excludes(other);
  option.each([&verb](const std::string&) {
    for (CLI::Option* other : verb.get_options()) other->required(false);
  });
}

}  // namespace

void add_eval(CLI::App& app) {
  const auto [verb, arguments] =
      add_verb<EvalArguments, EvalArguments>(app, "eval", "Deform a character through a clip", run);
  CLI::Option& basis = *add_required(verb, "basis", arguments.cache.basis, "BASIS", "Basis (.safetensors)");
  add_option(verb, "--level", arguments.cache.level, "Level of detail of a proxy: 0 is the finest")
      ->capture_default_str()
      ->type_name("N");
  add_flag(verb, "--full-skin", arguments.cache.full_skin,
           "Write the skin of the full character, carried by that of the proxy");
  arguments.clip.add(verb);
  CLI::Option& clip = *verb.get_option("--clip");
  add_option(verb, "--session", arguments.session, "FILE",
             "A session of the viewport: its lead, in place of BASIS, with its clip as it was posed and keyed there")
      ->each([&basis, &clip](const std::string&) {
        basis.required(false);
        clip.required(false);
      });
  arguments.device.add(verb);
  add_flag(verb, "--check", arguments.device.choice.check,
           "Run every stage on the CPU, too, and stop at the first difference");
  arguments.clip.add_unit(verb);
  add_required(
      verb, "--out", arguments.cache.out, "FILE.pc2|.usda|.glb",
      "Cache to write, a PC2 point cache, USD text or glTF with morph targets; '####' in its name is the first frame")
      ->check([](const std::string& name) {
        for (const char* ending : {".pc2", ".usda", ".glb"}) {
          if (must_end_in(ending)(name).empty()) return std::string();
        }
        return "'" + name + "' does not end in .pc2, .usda or .glb";
      });
  add_cache_space(verb, arguments.cache.space);
  add_option(
      verb, "--attached", arguments.cache.attached, "FILE",
      "Geometry that rides on the skin (default: BASIS.attached.safetensors beside the basis, where it is there); "
      "each mesh is written as FILE.<mesh>.pc2, .usda or .glb");
  arguments.jiggle.add(verb);
  arguments.modifiers.add(verb);
  arguments.task.add(verb);
  arguments.json.add(verb);
  add_list(verb, arguments.list);
}

}  // namespace bodyopt::cli
