// bodyopt eval: a basis and a clip to a point cache.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "assets/controls.h"
#include "assets/frame_range.h"
#include "assets/pc2.h"
#include "base/progress.h"
#include "cli/arguments/common.h"
#include "cli/arguments/jiggle_arguments.h"
#include "cli/results/attachments.h"
#include "cli/results/fade_log.h"
#include "runtime/core/error.h"
#include "runtime/host/carry_skin.h"
#include "runtime/threads/tbb_executor.h"
#include "trainer/dynamics/measure_jiggle.h"
#include "trainer/train/coverage/coverage.h"

namespace bodyopt::cli {
namespace {

struct EvalArguments {
  std::string basis, out, attached;
  double unit = 0;
  std::size_t level = 0;
  bool full_skin = false;
  ClipArguments clip;
  DeviceArguments device;
  JiggleArguments jiggle;
  JsonOption json;
};

// What the basis knows of the poses, per frame; and a line on it.
struct Expectation {
  std::vector<double> rms_mm;  // none where the basis has no coverage
  std::string line;
};

Expectation expectation(const Basis& basis, const std::vector<Pose>& poses, const std::vector<int>& frames) {
  Expectation result;
  if (!has_coverage(basis) || poses.empty()) return result;
  for (const ExpectedError& error : expected_errors(basis, read_coverage(basis), poses)) {
    result.rms_mm.push_back(error.rms_mm);
  }
  const auto worst = std::max_element(result.rms_mm.begin(), result.rms_mm.end());
  result.line = format("expected error: %.3f mm RMS, most in frame %d: %.3f mm\n", root_mean_square(result.rms_mm),
                       frames[static_cast<std::size_t>(worst - result.rms_mm.begin())], *worst);
  return result;
}

// What the jiggle did: of every frame in its JSON, of all in a line or two.
class JiggleLog {
 public:
  void add(const Deformer& deformer, int frame, Json& entry) {
    const JiggleMeasure measure = measure_jiggle(*deformer.dynamics(), deformer.state().motion);
    entry["jiggle_rms_mm"] = measure.rms_mm;
    entry["jiggle_max_mm"] = measure.max_mm;
    entry["inverted_tets"] = measure.inverted_tets;
    if (measure.inverted_tets > 0) inverted_frames_.push_back(frame);
    most_inverted_ = std::max(most_inverted_, measure.inverted_tets);
    if (measure.max_mm > max_mm_) max_frame_ = frame;
    max_mm_ = std::max(max_mm_, measure.max_mm);
    tets_ = deformer.dynamics()->tets.tet_count();
  }

  std::string text() const {
    std::string text = max_mm_ > 0
                           ? format("the jiggle moves the skin by %.2f mm at most, in frame %d\n", max_mm_, max_frame_)
                           : std::string();
    if (inverted_frames_.empty()) return text;
    return text +
           format("%zu frames have tetrahedra that are inside out before they jiggle, %u of %u at most: ",
                  inverted_frames_.size(), most_inverted_, tets_) +
           format_frame_range(inverted_frames_) + "\n";
  }

 private:
  std::vector<int> inverted_frames_;
  std::uint32_t most_inverted_ = 0, tets_ = 0;
  double max_mm_ = 0;
  int max_frame_ = 0;
};

// The level of detail that the options ask for.
Level chosen_level(const EvalArguments& arguments) {
  std::vector<Level> levels = load_levels(arguments.basis);
  if (arguments.level >= levels.size()) {
    throw Error(ErrorKind::usage, format("--level asks for level %zu; %s has levels 0 to %zu", arguments.level,
                                         arguments.basis.c_str(), levels.size() - 1));
  }
  Level level = std::move(levels[arguments.level]);
  if (arguments.full_skin && level.carried.empty()) {
    throw Error(ErrorKind::usage, arguments.basis + " is no proxy: --full-skin has nothing to carry; leave it out");
  }
  return level;
}

void run(const EvalArguments& arguments) {
  arguments.json.require_writable();
  arguments.jiggle.check();
  Level level = chosen_level(arguments);
  const std::unique_ptr<Deformer> owned =
      arguments.jiggle.deformer(std::move(level.basis), arguments.basis, arguments.device.choice);
  Deformer& deformer = *owned;
  AttachedCaches attached(arguments.attached, arguments.level == 0 ? arguments.basis : "", deformer.basis());
  std::vector<int> frames;
  const double unit = arguments.unit > 0 ? arguments.unit : kept_unit(deformer.basis());
  Clip clip = arguments.clip.read(deformer.basis().skeleton, unit, frames);
  for (const std::string& name : arrange_controls(deformer.basis().residual.controls, clip)) {
    spdlog::warn("control '{}' is none that the basis was trained with: it has no effect", name);
  }
  const std::vector<Pose> poses = poses_of(clip, frames);
  arguments.jiggle.check_frames(deformer, clip, frames);
  arguments.jiggle.preroll_to(clip, frames, deformer);

  const MeshTable& mesh = deformer.basis().mesh;
  const auto points = arguments.full_skin ? static_cast<std::uint32_t>(level.carried.size()) : mesh.output_count();
  const std::size_t own = 3 * std::size_t{mesh.output_count()};  // numbers of a frame, without carrying
  Pc2Writer writer(arguments.out, points, static_cast<std::uint32_t>(frames.size()),
                   frames.empty() ? 1.0f : static_cast<float>(frames.front()), frame_spacing(frames));
  attached.open(arguments.out, frames);
  Progress progress("eval", frames.size());
  std::map<std::string, double> stage_seconds;
  std::vector<int> outside_frames;
  double worst_outside = 0;
  Json per_frame = Json::array();
  std::vector<std::string> notes, states;
  std::uint32_t worst_feature = 0;
  const auto start = std::chrono::steady_clock::now();
  JiggleLog jiggle;
  FadeLog fades;
  // Frames held in memory at once. Of the jiggle each is measured, and it may be slow.
  const std::size_t step = arguments.jiggle.jiggle ? 1 : 64;
  const std::unique_ptr<Executor> threads = make_tbb_executor();
  for (std::size_t begin = 0; begin < poses.size(); begin += step) {
    const std::size_t count = std::min(step, poses.size() - begin);
    const Evaluation part = arguments.jiggle.jiggle ? deformer.jiggle(std::span(poses).subspan(begin, count),
                                                                      std::span(frames).subspan(begin, count))
                                                    : deformer.evaluate(std::span(poses).subspan(begin, count));
    for (std::size_t k = 0; k < part.starts.size(); ++k) {
      if (const auto note = describe(part.starts[k], frames[begin + k])) notes.push_back(*note);
    }
    std::vector<float> carried;
    if (arguments.full_skin) carried = carry_skin(mesh, level.carried, part.positions, part.normals, *threads);
    const std::span<const float> skin = arguments.full_skin ? carried : part.positions;
    for (std::size_t k = 0; k < count; ++k) {
      writer.append(skin.subspan(3 * k * points, 3 * std::size_t{points}));
      attached.append(std::span(part.positions).subspan(k * own, own), poses[begin + k]);
      per_frame.push_back({{"frame", frames[begin + k]}, {"outside", part.outside[k]}});
      fades.add(deformer.basis().skeleton, part, k, frames[begin + k], per_frame.back());
      if (arguments.jiggle.jiggle) jiggle.add(deformer, frames[begin + k], per_frame.back());
      if (part.outside[k] > 0) outside_frames.push_back(frames[begin + k]);
      if (static_cast<double>(part.outside[k]) > worst_outside) {
        worst_outside = static_cast<double>(part.outside[k]);
        worst_feature = part.outside_feature[k];
      }
    }
    for (const auto& [stage, seconds] : part.stage_seconds) stage_seconds[stage] += seconds;
    if (const auto file = arguments.jiggle.write_state_after(deformer, begin + count)) states.push_back(*file);
    progress.advance(count);
  }
  attached.close();
  writer.close();
  if (const auto file = arguments.jiggle.write_last_state(deformer)) states.push_back(*file);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const Expectation expected = expectation(deformer.basis(), poses, frames);
  for (std::size_t k = 0; k < expected.rms_mm.size(); ++k) per_frame[k]["expected_rms_mm"] = expected.rms_mm[k];

  const double frame_count = std::max<double>(1, static_cast<double>(frames.size()));
  Json milliseconds = Json::object();
  std::string text = format("%zu frames of %u points on %s in %.2f s\n", frames.size(), points,
                            deformer.device_name().c_str(), seconds);
  for (const char* stage : {"rig", "strain", "residual", "pose", "diffuse", "jiggle", "output"}) {
    if (!stage_seconds.contains(stage)) continue;
    milliseconds[stage] = 1e3 * stage_seconds[stage] / frame_count;
    text += format("  %-8s %8.3f ms a frame\n", stage, 1e3 * stage_seconds[stage] / frame_count);
  }
  std::string worst_name;
  if (!outside_frames.empty()) {
    worst_name = feature_name(deformer.basis(), worst_feature);
    text +=
        format("%zu frames leave the trained range (most of all %s, by %.1f standard deviations) and were clamped: ",
               outside_frames.size(), worst_name.c_str(), worst_outside) +
        format_frame_range(outside_frames) + "\n";
  }
  text += fades.text() + expected.line + jiggle.text();
  for (const std::string& note : notes) text += note + "\n";
  text += "wrote " + arguments.out + "\n";
  const Json caches = attached.written();
  for (const Json& cache : caches) text += "wrote " + cache.at("cache").get<std::string>() + "\n";
  for (const std::string& file : states) text += "wrote " + file + "\n";
  arguments.json.emit({{"cache", arguments.out},
                       {"frames", frames.size()},
                       {"points", points},
                       {"device", deformer.device_name()},
                       {"seconds", seconds},
                       {"milliseconds_per_frame", milliseconds},
                       {"outside_frames", format_frame_range(outside_frames)},
                       {"worst_outside", worst_outside},
                       {"worst_outside_feature", worst_name},
                       {"jiggle", arguments.jiggle.jiggle},
                       {"notes", notes},
                       {"states", states},
                       {"attached", caches},
                       {"per_frame", per_frame}},
                      text);
}

}  // namespace

void add_eval(CLI::App& app) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App& verb = *app.add_subcommand("eval", "Deform a character through a clip");
  verb.add_option("basis", arguments->basis, "Basis (.safetensors)")->required()->type_name("BASIS");
  verb.add_option("--level", arguments->level, "Level of detail of a proxy: 0 is the finest")
      ->capture_default_str()
      ->type_name("N");
  verb.add_flag("--full-skin", arguments->full_skin,
                "Write the skin of the full character, carried by that of the proxy");
  arguments->clip.add(verb);
  arguments->device.add(verb);
  verb.add_option("--unit", arguments->unit,
                  "Metres per unit of the clip's file (default: as the character was read for training)")
      ->check(above_zero);
  add_output(verb, arguments->out, ".pc2", "Point cache to write");
  verb.add_option("--attached", arguments->attached,
                  "Geometry that rides on the skin (default: BASIS.attached.safetensors beside the basis, where it is "
                  "there); each mesh is written as FILE.<mesh>.pc2")
      ->type_name("FILE")
      ->check(refuse_empty);
  arguments->jiggle.add(verb);
  arguments->json.add(verb);
  verb.callback([arguments] { run(*arguments); });
}

}  // namespace bodyopt::cli
