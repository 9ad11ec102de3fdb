// bodyopt eval: a basis and a clip to a cache of shapes.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/caches/cache_writer.h"
#include "assets/caches/motion_write.h"
#include "base/frame_range.h"
#include "base/json_file.h"
#include "base/written_over.h"
#include "cli/arguments/common.h"
#include "cli/arguments/shot_arguments.h"
#include "cli/results/evaluation_log.h"
#include "cli/results/modifier_effects.h"
#include "cli/run_command.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "shots/shot.h"
#include "shots/shot_files.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct EvalArguments {
  shots::ShotFiles shot;
  shots::CacheChoice cache;
  ClipArguments clip;
  DeviceArguments device;
  JiggleArguments jiggle;
  TaskArguments task;
  JsonOption json;
  std::string rig;      // where the posed joints go; or empty
  std::string session;  // of the viewport: in place of the basis and the clip
  std::string list;     // of shots, in place of all else
};

// Where the signs of `shot.####.pc2` begin, or npos. Folders may have such names.
std::size_t frame_place(const std::string& pattern) {
  return pattern.find('#', pattern.size() - fs::path(pattern).filename().string().size());
}

// `shot.####.pc2`: the first frame in place of the signs, a digit each at least.
std::string with_first_frame(const std::string& pattern, int frame) {
  const std::size_t begin = frame_place(pattern);
  const std::size_t end = std::min(pattern.find_first_not_of('#', begin), pattern.size());
  return pattern.substr(0, begin) + format("{:0{}}", frame, end - begin) + pattern.substr(end);
}

// A run of a shot: its caches, what it reports of its frames, and the states of the jiggle.
class ShotRun : public shots::SkinSink {
 public:
  // `task`: null, where what an early end leaves is not kept.
  ShotRun(const EvalArguments& arguments, shots::Shot& shot, const farm::TaskRun* task)
      : arguments_(arguments), shot_(shot), task_(task), caches_(arguments.cache, shot), log_(shot.basis()) {}

  // Evaluates and writes what is not done yet.
  void write() {
    try {
      evaluate_frames();
      if (task_ != nullptr) task_->require_same_inputs();
      if (const auto file = arguments_.jiggle.write_last_state(*shot_.deformer)) states_.push_back(*file);
      write_rig();
      is_whole_ = false;
      caches_.close();  // last: where the cache is in place, its state is, too, and none of an earlier run is beside it
    } catch (...) {
      keep_done();
      throw;
    }
  }

  void append(const Evaluation& part, std::span<const Pose> poses, std::size_t begin) override {
    JiggleState state;
    if (shot_.jiggles) state = shot_.deformer->state();
    is_whole_ = false;
    const Stopwatch watch;
    caches_.append(part, poses, begin);
    log_.add_writing(watch.seconds());
    const auto frames = std::span(shot_.frames).subspan(begin, poses.size());
    log_.add(*shot_.deformer, part, frames, state.motion);
    state_ = std::move(state);
    is_whole_ = true;
    if (const auto file = arguments_.jiggle.write_state_after(*shot_.deformer, begin + poses.size())) {
      states_.push_back(*file);
    }
  }

  const shots::ShotCaches& caches() const { return caches_; }
  const EvaluationLog& log() const { return log_; }
  const std::vector<std::string>& states() const { return states_; }  // that were written

  std::vector<fs::path> outputs() const {
    std::vector<fs::path> outputs{arguments_.cache.out};
    for (const std::string& cache : caches_.attached_paths()) outputs.emplace_back(cache);
    for (const std::string& state : states_) outputs.emplace_back(state);
    if (!arguments_.rig.empty()) outputs.emplace_back(arguments_.rig);
    return outputs;
  }

 private:
  // Writes the motion from the first frame to the last, in the unit of the skin's cache.
  void write_rig() const {
    if (arguments_.rig.empty() || shot_.frames.empty()) return;
    write_motion(shot_.played_clip(), shot_.basis().skeleton, arguments_.cache.space.unit, arguments_.rig);
  }

  static fs::path state_in(const fs::path& folder) { return folder / "jiggle.state"; }

  void evaluate_frames() {
    kept_ = take_up();
    if (kept_ > 0) spdlog::info("goes on after frame {}", shot_.frames[kept_ - 1]);
    shots::evaluate(shot_, *this, "eval", kept_,
                    task_ != nullptr ? "the same command goes on from what is kept of it" : "nothing of it is kept");
  }

  // How many frames the checkpoint holds; 0: there is none.
  std::size_t take_up() {
    const std::optional<farm::Checkpoint> checkpoint = task_ != nullptr ? task_->read_checkpoint() : std::nullopt;
    if (!checkpoint || checkpoint->frames > shot_.frames.size()) return 0;
    const fs::path folder = task_->checkpoint_folder();
    if (shot_.jiggles) {
      state_ = load_state(state_in(folder), *shot_.deformer->dynamics());
      shot_.deformer->set_state(state_);
    }
    caches_.take_up(folder, checkpoint->frames);
    log_.take_up(checkpoint->log);
    return checkpoint->frames;
  }

  // After an error or an interrupt: leaves a checkpoint, where frames are new and all caches have them. That it cannot
  // does not hide why the run ended.
  void keep_done() {
    if (task_ == nullptr) return;
    try {
      task_->require_same_inputs();
      const std::size_t done = caches_.frames();
      if (!is_whole_ || done == kept_) return;
      const fs::path folder = task_->checkpoint_folder();
      make_folder(folder);
      std::vector<fs::path> files = caches_.put_aside(folder);
      if (shot_.jiggles) {
        files.push_back(state_in(folder));
        save_state(state_, *shot_.deformer->dynamics(), files.back());
      }
      task_->write_checkpoint({done, log_.kept()}, files);
      spdlog::info("what is done is kept: the same command goes on after frame {}", shot_.frames[done - 1]);
    } catch (const std::exception& error) {
      spdlog::warn("what is done cannot be kept: {}", error.what());
    }
  }

  const EvalArguments& arguments_;
  shots::Shot& shot_;
  const farm::TaskRun* task_;
  shots::ShotCaches caches_;
  EvaluationLog log_;
  std::vector<std::string> states_;
  JiggleState state_;     // after the frames that all have, for when the device is lost
  std::size_t kept_ = 0;  // frames of the checkpoint
  bool is_whole_ = true;  // caches and log have the same frames, and can take more
};

Json attached_of(const shots::Shot& shot, const shots::ShotCaches& caches) {
  Json list = Json::array();
  const std::vector<AttachedMesh>& meshes = shot.following.attached().meshes;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const AttachedMesh& mesh = meshes[k];
    list.push_back({{"name", mesh.name}, {"points", mesh.vertex_count()}, {"cache", caches.attached_paths()[k]}});
  }
  return list;
}

// Reports that the character's own file has nothing that a cache could show.
std::string surface_text(const EvalArguments& arguments, const shots::Shot& shot) {
  if (arguments.shot.character.empty() || !holds_triangles(arguments.cache.out) || !shot.surface.empty()) return "";
  return "of " + arguments.shot.character + " no texture coordinates or materials are read, and none are written\n";
}

// Reports that a cache in metres does not lie on the mesh that it is of.
std::string unit_text(const shots::CacheChoice& cache, const Basis& basis) {
  const double unit = kept_unit(basis);
  if (holds_triangles(cache.out) || cache.space.unit != 1 || unit == 0 || unit == 1) return "";
  return format("the cache is in metres; --unit-out {} lays it on the mesh of the character's own file\n",
                Json(unit).dump());
}

// The rig must lie in the skin, and take the place of no other file: `others` are what the shot reads.
void check_rig(const EvalArguments& arguments, std::vector<fs::path> others) {
  const std::string& rig = arguments.rig;
  if (rig.empty()) return;
  const CacheSpace& space = arguments.cache.space;
  if (!rig.ends_with(".glb") && (space.unit != 1 || space.z_up)) {
    throw Error(ErrorKind::usage, "--rig ", rig,
                " is in metres with Y up, and would not lie in a skin of another --unit-out or --axis: leave these "
                "out, or name a .glb");
  }
  for (const std::string& file : {arguments.cache.out, arguments.jiggle.state_out, arguments.json.path}) {
    if (!file.empty() && file != "-") others.emplace_back(file);
  }
  refuse_over("--rig", rig, others);
}

void evaluate(const EvalArguments& arguments, shots::Shot& shot, const farm::TaskRun* task) {
  const Stopwatch watch;
  const std::string about_unit = unit_text(arguments.cache, shot.basis());  // first: it may be damaged
  ShotRun run(arguments, shot, task);
  if (!arguments.rig.empty()) {
    const std::vector<std::string>& attached = run.caches().attached_paths();
    refuse_over("--rig", arguments.rig, {attached.begin(), attached.end()});
  }
  run.write();
  const double seconds = watch.seconds();

  const std::string device = shot.deformer->device_name();
  Json summary = run.log().summary();
  summary["seconds"] = seconds;
  summary["device"] = device;
  if (task != nullptr) task->finish(run.outputs(), summary);
  std::string text =
      format("{} frames of {} points on {} in {:.2f} s\n", shot.frames.size(), run.caches().points(), device, seconds) +
      run.log().text();
  const std::vector<Pose> poses = shots::poses_of(shot.clip, shot.frames);
  const std::optional<ShotFolds> folds = measure_shot_folds(shot.basis(), poses, shot.frames);
  if (folds) text += text_of(*folds);
  const ShotMoves moves = measure_shot_moves(shot.basis(), poses, shot.frames);
  text += text_of(moves);
  for (const fs::path& file : run.outputs()) text += "wrote " + file.string() + "\n";
  text += about_unit + surface_text(arguments, shot);
  Json result = run.log().result();
  if (folds) result["push_out"] = to_json(*folds);
  if (!moves.moves.empty()) result["modifiers"] = to_json(moves);
  result["cache"] = arguments.cache.out;
  result["points"] = run.caches().points();
  result["device"] = device;
  result["seconds"] = seconds;
  result["jiggle"] = shot.jiggles;
  result["states"] = run.states();
  if (!arguments.rig.empty()) result["rig"] = arguments.rig;
  result["attached"] = attached_of(shot, run.caches());
  arguments.json.emit(result, text);
}

// Returns the outputs that are named by the arguments, other than the report.
std::vector<fs::path> named_outputs(const EvalArguments& arguments) {
  std::vector<fs::path> outputs{arguments.cache.out};
  if (!arguments.rig.empty()) outputs.emplace_back(arguments.rig);
  if (!arguments.jiggle.state_out.empty()) outputs.emplace_back(arguments.jiggle.state_out);
  return outputs;
}

// Says what would be done, without doing it.
void pretend(const EvalArguments& arguments, const shots::Shot& shot, const farm::TaskRun* task) {
  std::string doing = "would evaluate";
  std::size_t kept = 0;
  if (task != nullptr) {
    if (task->done(named_outputs(arguments))) doing = "is done already:";
    if (const auto checkpoint = task->read_checkpoint()) kept = checkpoint->frames;
  }
  std::string text = format("{} frames {} of '{}' on {}, to {}\n", doing, format_frame_range(shot.frames),
                            arguments.shot.clip.source.empty() ? shot.clip.name : arguments.shot.clip.source,
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
bool is_done(const EvalArguments& arguments, const farm::TaskRun& task) {
  if (!arguments.json.path.empty() && !fs::exists(arguments.json.path)) return false;
  return task.done(named_outputs(arguments)).has_value();
}

// Copies arguments that several verbs have, as CLI11 filled them, to the shot.
void gather_shot(EvalArguments& arguments) {
  shots::ShotFiles& shot = arguments.shot;
  shot.clip = arguments.clip;
  shot.device = arguments.device.choice;
  const bool shows_surface = holds_triangles(arguments.cache.out);
  if (!shot.character.empty() && !shows_surface) {
    throw Error(ErrorKind::usage, "--character is for .glb and .usda: point caches hold points alone");
  }
  if (shot.is_rigged && !shows_surface) {
    throw Error(ErrorKind::usage, "--rigged is for .glb and .usda: point caches hold points alone");
  }
  if (arguments.session.empty()) return;
  shots::take_session(arguments.session, shot);
  if (shot.is_rigged && shot.character.empty()) shot.character = shot.session.character;
  if (!shows_surface || !shot.character.empty()) shot.session.character = shot.session.like = "";
}

// The clip alone knows its first frame.
int first_frame_of(const shots::ShotFiles& shot) {
  if (shot.session.in) return *shot.session.in;
  if (shot.clip.frames.empty()) {
    throw Error(ErrorKind::usage, "--out with '#' stands for the first frame and needs --frames");
  }
  return parse_frame_range(shot.clip.frames).front();
}

void run(EvalArguments arguments) {
  if (!arguments.list.empty()) return run_show_list(arguments.list, arguments.task.progress);
  gather_shot(arguments);
  arguments.task.begin();
  arguments.json.require_writable();
  arguments.jiggle.check(arguments.shot.jiggle);
  std::string& out = arguments.cache.out;
  if (frame_place(out) != std::string::npos) out = with_first_frame(out, first_frame_of(arguments.shot));
  const std::vector<fs::path> inputs = arguments.shot.paths();
  refuse_over("--out", out, inputs);
  check_rig(arguments, inputs);
  std::optional<farm::TaskRun> task;
  if (arguments.task.resume) task.emplace(out, BODYOPT_VERSION, arguments.task.given, inputs);
  if (task && !arguments.task.pretend && is_done(arguments, *task)) {
    const std::string text = "already done: " + out + "\n";
    if (arguments.json.path != "-") return print(text);
    std::fputs(text.c_str(), stderr);
    return;
  }
  try {
    shots::require_form(arguments.cache);
    shots::Shot shot = shots::read_shot(arguments.shot, warn);
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

void declare_eval(CLI::App& verb, EvalArguments& arguments) {
  add_shot(verb, arguments.shot.basis, arguments.clip, arguments.session);
  add_option(verb, "--level", arguments.shot.level, "Level of detail of a proxy: 0 is the finest")
      ->capture_default_str()
      ->type_name("N");
  add_flag(verb, "--full-skin", arguments.cache.full_skin,
           "Write the skin of the full character, moved by that of the proxy");
  arguments.device.add(verb);
  add_flag(verb, "--check", arguments.device.choice.check,
           "Run every stage on the CPU, too, and stop at the first difference");
  arguments.clip.add_unit(verb);
  add_required(
      verb, "--out", arguments.cache.out, concat("FILE", kCacheEndings),
      "Cache to write: a PC2 or MDD point cache, USD text or glTF with morph targets; '####' in its name is the first "
      "frame")
      ->check(must_end_in(kCacheEndings));
  add_option(verb, "--character", arguments.shot.character, "FILE",
             "The character's own file: its texture coordinates and materials go into a .glb, the first into a .usda");
  add_flag(
      verb, "--rigged", arguments.shot.is_rigged,
      "Write the .glb or .usda as a rig for other programs: joints, their motion, the skin bound by the weights of "
      "--character, and for each frame the blend shape that makes it the result");
  add_option(verb, "--rig", arguments.rig, "FILE.glb|.usda|.bvh", "Write the posed joints, too, as large as the skin");
  add_cache_space(verb, arguments.cache.space);
  add_option(verb, "--attached", arguments.shot.attached, "FILE",
             "Attached meshes (default: BASIS.attached.safetensors beside the basis, where it is there); "
             "each mesh is written as FILE.<mesh>.pc2, .mdd, .usda or .glb");
  arguments.jiggle.add(verb, arguments.shot.jiggle);
  add_modifier_options(verb, arguments.shot);
  arguments.task.add(verb);
  arguments.json.add(verb);
  add_list(verb, arguments.list);
}

}  // namespace

void add_eval(CLI::App& app) {
  const auto [verb, arguments] =
      add_verb<EvalArguments, EvalArguments>(app, "eval", "Deform a character through a clip", run);
  declare_eval(verb, arguments);
}

void eval_step(const farm::FarmStep& step, const std::string& progress) {
  run(read_step<EvalArguments>(declare_eval, step, progress));
}

}  // namespace bodyopt::cli
