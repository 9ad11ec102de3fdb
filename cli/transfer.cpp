// bodyopt transfer: what was simulated or learned of one character, transferred to others.
#include <spdlog/spdlog.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "base/frame_range.h"
#include "cli/arguments/common.h"
#include "cli/results/pages.h"
#include "dataset/modifier.h"
#include "report/page.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "trainer/check/check.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/transfer/markers_file.h"
#include "trainer/transfer/skin_transfer.h"
#include "trainer/transfer/transfer_basis.h"
#include "trainer/transfer/transfer_levels.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::cli {
namespace {

struct TransferArguments {
  std::string source, markers, picture, report, clip, frames, proxy, muscles;
  std::vector<std::string> targets, outs;
  double unit = 0;
  bool force = false, source_size = false, alone = false;
  trainer::TransferOptions options;
  ClipOptions clip_options;
  JsonOption json;
};

trainer::TransferOptions options_of(const TransferArguments& arguments) {
  trainer::TransferOptions options = arguments.options;
  if (!arguments.markers.empty()) options.markers = trainer::read_markers(arguments.markers);
  if (arguments.source_size) options.size = trainer::TransferSize::source;
  return options;
}

// Writing must not fail after the long work.
void check_outputs(const TransferArguments& arguments) {
  arguments.json.require_writable();
  for (const std::string& path : {arguments.picture, arguments.report}) {
    if (!path.empty()) require_writable(path);
  }
  if (!arguments.picture.empty() || !arguments.report.empty()) const draw::Renderer device;
}

void say_of(const std::string& target, std::vector<std::string> notes) {
  for (std::string& note : notes) note = format("{}: {}", target, note);
  say(notes);
}

// Draws the correspondence where it is asked for, and says what is not sure of it. Returns the likeness. Throws
// Error(mismatch) for unlike bodies, unless --force.
double judge(const trainer::TransferPair& pair, const TransferArguments& arguments, const std::string& target) {
  say_of(target, pair.match.notes);
  say_of(target, pair.correspondence.notes);
  if (!arguments.picture.empty()) draw::write_png(transfer_picture(pair), arguments.picture);
  const double alike = trainer::likeness(pair);
  if (alike >= trainer::kLeastLikeness) return alike;
  const std::string what = format(
      "{}: is like the source's body by {:.2f} only (1: the same skin on the same joints; below {:.2f} is refused): "
      "an unlike body, joints of other meaning, or a rest pose far off{}",
      target, alike, trainer::kLeastLikeness, arguments.picture.empty() ? "; --picture FILE.png shows where" : "");
  if (!arguments.force) throw Error(ErrorKind::mismatch, what, "; --force goes on all the same");
  spdlog::warn(what);
  return alike;
}

std::string describe(const trainer::TransferPair& pair) {
  const trainer::Correspondence& correspondence = pair.correspondence;
  if (correspondence.same_topology) {
    return format("the same triangles, confidence {:.2f}", correspondence.mean_confidence());
  }
  return format("confidence {:.2f}, {} of {} vertices filled in", correspondence.mean_confidence(), pair.skin.unsure(),
                correspondence.target.rows());
}

// The motion in which the report shows the bodies.
struct ReportMotion {
  Clip clip;
  std::vector<int> frames;
};

std::optional<ReportMotion> motion_for_report(const TransferArguments& arguments, const Basis& source) {
  if (arguments.clip.empty()) return std::nullopt;
  ClipOptions options = arguments.clip_options;
  options.unit = clip_unit(arguments.clip, kept_unit(source));
  ReportMotion motion{read_clip(arguments.clip, source.skeleton, options), {}};
  say(motion.clip.notes);
  const int first = motion.clip.first_frame, last = motion.clip.last_frame();
  const std::string all = std::to_string(first) + "-" + std::to_string(last);
  motion.frames = parse_frame_range(arguments.frames.empty() ? all : arguments.frames);
  const auto [least, most] = std::ranges::minmax(motion.frames);
  if (least < first || most > last) {
    throw Error(ErrorKind::usage, "--frames ", arguments.frames, ": '", arguments.clip, "' has frames ", all);
  }
  return motion;
}

// Files beside the source's basis that are transferred with it.
struct SideFiles {
  std::optional<Dynamics> dynamics;
  std::vector<Muscle> muscles;
  std::vector<Level> levels;
};

SideFiles read_side_files(const TransferArguments& arguments, const Basis& source) {
  SideFiles side_files;
  if (arguments.alone) return side_files;
  const std::filesystem::path dynamics = dynamics_beside(arguments.source),
                              proxy = arguments.proxy.empty() ? proxy_beside(arguments.source)
                                                              : std::filesystem::path(arguments.proxy);
  if (std::filesystem::exists(dynamics)) side_files.dynamics = load_dynamics(dynamics, source);
  if (!arguments.muscles.empty() && !side_files.dynamics) {
    throw Error(ErrorKind::usage, "--muscles is for the dynamics beside the source, and there are none: no file ",
                dynamics);
  }
  if (!arguments.muscles.empty()) side_files.muscles = read_muscles(arguments.muscles, source.skeleton);
  if (!arguments.proxy.empty() || std::filesystem::exists(proxy)) {
    side_files.levels = load_levels(proxy);
    trainer::require_proxy_of(source, side_files.levels);
  }
  return side_files;
}

// An ordinary basis gives one level, without `carried`; a proxy gives all of them.
std::vector<Level> carried_levels(const trainer::TransferPair& pair, const Character& target,
                                  const std::vector<Level>& source, const trainer::TransferOptions& options,
                                  double unit, std::vector<std::string>& notes) {
  std::vector<Level> levels;
  if (source.front().carried.empty()) {
    levels.push_back({trainer::transfer_basis(pair, options, notes), {}});
  } else {
    levels = trainer::transfer_levels(pair, target, source, options, notes);
    if (levels.empty()) throw Error(ErrorKind::mismatch, target.name, ": ", notes.back());
  }
  for (Level& level : levels) keep_unit(level.basis, unit);
  return levels;
}

// Transfers the proxy and dynamics beside the source's basis, too. Returns what was written.
std::vector<std::string> transfer_side_files(const SideFiles& side_files, const trainer::TransferPair& pair,
                                             const Character& target, const Basis& carried, const std::string& out,
                                             double unit, const trainer::TransferOptions& options,
                                             std::vector<std::string>& notes) {
  std::vector<std::string> written;
  if (!side_files.levels.empty()) {
    std::vector<Level> levels = trainer::transfer_levels(pair, target, side_files.levels, options, notes);
    for (Level& level : levels) keep_unit(level.basis, unit);
    if (!levels.empty()) save_levels(levels, written.emplace_back(proxy_beside(out)));
  }
  if (side_files.dynamics) {
    const Dynamics dynamics =
        trainer::transfer_dynamics(pair, target, carried, *side_files.dynamics, side_files.muscles, notes);
    save_dynamics(dynamics, written.emplace_back(dynamics_beside(out)));
  }
  return written;
}

void check_basis_arguments(const TransferArguments& arguments) {
  const std::filesystem::path dataset = dataset_file(arguments.source);
  if (dataset.extension() == ".json" && std::filesystem::exists(dataset)) {
    throw Error(ErrorKind::file, arguments.source,
                ": is a dataset, expected a trained basis (.safetensors): 'bodyopt transfer dataset' carries datasets");
  }
  if (arguments.outs.size() != arguments.targets.size()) {
    throw Error(ErrorKind::usage, format("{} targets and {} --out: every target needs a basis to write",
                                         arguments.targets.size(), arguments.outs.size()));
  }
  std::set<std::filesystem::path> places;
  for (const std::string& out : arguments.outs) {
    if (!places.insert(std::filesystem::weakly_canonical(out)).second) {
      throw Error(ErrorKind::usage, "--out names ", out, " twice: every target needs a basis of its own");
    }
    refuse_overwriting(out, arguments.source);
    require_writable(out);
  }
  if (arguments.report.empty() && !arguments.clip.empty()) {
    throw Error(ErrorKind::usage, "--clip is what --report shows: there is no --report");
  }
  if (arguments.clip.empty() && !arguments.frames.empty()) {
    throw Error(ErrorKind::usage, "--frames are those of --clip, and there is none");
  }
}

// One source, and target after target.
class BasisTransfer {
 public:
  explicit BasisTransfer(const TransferArguments& arguments)
      : arguments_(arguments),
        options_(options_of(arguments)),
        source_(load_levels(arguments.source)),
        side_files_(read_side_files(arguments, source_.front().basis)),
        motion_(motion_for_report(arguments, source_.front().basis)) {}

  // Returns the result for one target, as --json has it. It prints what is for people, and adds the report's pictures.
  Json carry(const std::string& target, const std::string& out, Json& pictures) {
    const Stopwatch watch;
    const Character character = read_character(target, arguments_.unit);
    say_of(target, character.notes);
    const trainer::TransferPair pair(source_.front().basis, character, options_);
    const double alike = judge(pair, arguments_, target);
    std::vector<std::string> notes;
    const std::vector<Level> carried = carried_levels(pair, character, source_, options_, character.unit, notes);
    save_levels(carried, out);
    const Basis& basis = carried.front().basis;
    Json facts = to_json(pair, alike);
    facts["target"] = target;
    facts["basis"] = out;
    facts["vertices"] = basis.mesh.vertex_count();
    facts["levels"] = carried.size();
    facts["bytes_per_vertex"] = static_cast<double>(total_bytes(basis)) / basis.mesh.vertex_count();
    const double seconds = watch.seconds();
    facts["seconds"] = seconds;
    const std::vector<std::string> beside =
        transfer_side_files(side_files_, pair, character, basis, out, character.unit, options_, notes);
    facts["beside"] = beside;
    facts["seconds_with_what_is_beside"] = watch.seconds();
    say_of(target, notes);
    if (!arguments_.report.empty()) report(pair, basis, facts, pictures);
    std::string text =
        format("wrote {}: {} vertices, {}, {:.1f} s\n", out, basis.mesh.vertex_count(), describe(pair), seconds);
    for (const std::string& file : beside) text += "wrote " + file + "\n";
    arguments_.json.print(text);
    return facts;
  }

 private:
  void report(const trainer::TransferPair& pair, const Basis& basis, Json& facts, Json& pictures) const {
    std::vector<ComparedPose> poses;
    if (motion_) poses = compare_poses(pair, basis, motion_->clip, motion_->frames);
    const auto parts = trainer::transfer_parts(pair.source, pair.target, pair.match, pair.correspondence);
    facts.update(to_json(parts, poses));
    pictures.push_back(transfer_pictures(pair, basis.mesh, poses));
  }

  const TransferArguments& arguments_;
  const trainer::TransferOptions options_;
  const std::vector<Level> source_;
  const SideFiles side_files_;
  const std::optional<ReportMotion> motion_;
};

// A target that fails leaves the others alone: they, the report and --json are finished first.
void run_basis(const TransferArguments& arguments) {
  check_basis_arguments(arguments);
  check_outputs(arguments);
  BasisTransfer transfer(arguments);
  Json list = Json::array(), pictures = Json::array();
  std::optional<Error> failure;
  for (std::size_t k = 0; k < arguments.targets.size(); ++k) {
    try {
      list.push_back(transfer.carry(arguments.targets[k], arguments.outs[k], pictures));
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) throw;
      list.push_back({{"target", arguments.targets[k]}, {"error", error.what()}});
      pictures.push_back(Json::object());
      if (failure) {
        spdlog::error(error.what());
      } else {
        failure = error;
      }
    }
  }
  std::string text;
  if (!arguments.report.empty()) {
    const Json figures = {{"title", "Transfer"},
                          {"subtitle", "What was learned in " + arguments.source + ", on other bodies"},
                          {"targets", list}};
    const std::string page = report::page_text("transfer", figures, pictures);
    write_file_atomically(arguments.report, std::as_bytes(std::span(page)));
    text = "wrote " + arguments.report + "\n";
  }
  arguments.json.emit({{"targets", list}, {"peak_memory_mib", peak_memory_mib()}}, text);
  if (failure) throw *failure;
}

void run_dataset(const TransferArguments& arguments) {
  check_outputs(arguments);
  const Stopwatch watch;
  const trainer::TransferOptions options = options_of(arguments);
  const std::filesystem::path path = dataset_file(arguments.source);
  const Dataset dataset = read_dataset(path);
  if (std::filesystem::exists(arguments.outs.front())) {
    require_writable(std::filesystem::path(arguments.outs.front()) / "dataset.json");
  }
  trainer::require_no_own_takes(dataset, arguments.outs.front());
  const std::string mismatch = trainer::first_problem(trainer::check_dataset(dataset), path);
  if (!mismatch.empty()) throw Error(ErrorKind::mismatch, mismatch);
  const Character source_character = read_character(dataset.folder / dataset.character, dataset.unit);
  const std::filesystem::path& out = arguments.outs.front();
  if (std::filesystem::weakly_canonical(out) == std::filesystem::weakly_canonical(path.parent_path())) {
    throw Error(ErrorKind::usage, "--out is the source's own folder: its shapes would be overwritten");
  }
  const trainer::TransferTarget target{read_character(arguments.targets.front(), arguments.unit),
                                       arguments.targets.front(), arguments.unit};
  say_of(arguments.targets.front(), target.character.notes);
  const Basis source = trainer::build_ddm_basis(source_character, {});
  const trainer::TransferPair pair(source, target.character, options);
  const double alike = judge(pair, arguments, arguments.targets.front());
  const trainer::TransferredDataset told = trainer::transfer_dataset(dataset, source_character, pair, target, out);
  say_of(out.string(), told.notes);
  Json facts = to_json(pair, alike);
  facts["dataset"] = (out / "dataset.json").string();
  facts["takes"] = told.takes;
  facts["frames"] = told.frames;
  facts["seconds"] = watch.seconds();
  facts["peak_memory_mib"] = peak_memory_mib();
  arguments.json.emit(facts, format("wrote {}: {} takes, {} frames, {}, {:.1f} s\n", (out / "dataset.json").string(),
                                    told.takes, told.frames, describe(pair), watch.seconds()));
}

struct RefineArguments {
  std::string dataset;
  std::vector<std::string> carried;
  trainer::TrainOptions options;
  JsonOption json;
};

// Transferred takes are read as they are below an earlier refinement, and without mirror images, which follow from what
// is refined.
trainer::SampleSet unrefined_samples(Dataset dataset, const std::set<std::string>& carried) {
  std::erase_if(dataset.modifiers, [&](const Modifier& modifier) {
    return modifier.type == "symmetry" || std::ranges::any_of(carried, [&](const std::string& take) {
             return modifier.name == trainer::refinement_of(take);
           });
  });
  return trainer::read_samples(dataset);
}

// Frames held out of transferred takes stay as they were transferred.
std::size_t say_carried_judge(const trainer::SampleSet& set, const std::set<std::string>& carried) {
  const auto count = static_cast<std::size_t>(std::ranges::count_if(
      set.heldout, [&](const trainer::Sample& sample) { return carried.contains(set.take_of(sample)); }));
  if (count > 0) {
    say({format(
        "{} of the {} frames held out are carried from the source: errors that 'train' and 'test' measure on "
        "them tell how near to the source's shapes the basis is, not to this body's; hold out frames of its own "
        "(simulate --heldout)",
        count, set.heldout.size())});
  }
  return count;
}

struct CarriedTake {
  std::string name;
  std::vector<int> frames;
  std::vector<Pose> poses;
};

// Transferred takes with frames to train on.
std::vector<CarriedTake> carried_takes(const trainer::SampleSet& set, const std::set<std::string>& carried) {
  std::vector<CarriedTake> takes;
  for (const std::string& name : carried) {
    CarriedTake take{name, {}, {}};
    for (const trainer::Sample& sample : set.train) {
      if (set.take_of(sample) != name) continue;
      take.frames.push_back(sample.frame);
      take.poses.push_back(sample.pose);
    }
    if (!take.frames.empty()) takes.push_back(std::move(take));
  }
  return takes;
}

void run_refine(const RefineArguments& arguments) {
  arguments.json.require_writable();
  const Stopwatch watch;
  const std::filesystem::path path = dataset_file(arguments.dataset);
  const Dataset dataset = read_dataset(path);
  const std::string mismatch = trainer::first_problem(trainer::check_dataset(dataset), path);
  if (!mismatch.empty()) throw Error(ErrorKind::mismatch, mismatch);
  const std::set<std::string> carried(arguments.carried.begin(), arguments.carried.end());
  trainer::SampleSet set = unrefined_samples(dataset, carried);
  say(set.notes);
  const std::size_t carried_judge = say_carried_judge(set, carried);
  const std::vector<CarriedTake> takes = carried_takes(set, carried);
  const std::size_t all = set.train.size();
  trainer::RefinedShapes refined(std::move(set), carried, arguments.options);
  std::size_t count = 0;
  for (const CarriedTake& take : takes) {
    trainer::put_shapes_over(path, trainer::refinement_of(take.name), take.name, take.frames,
                             [&](std::size_t k) { return refined(take.poses[k]); });
    count += take.frames.size();
  }
  arguments.json.emit(
      {{"dataset", path.string()},
       {"carried_frames", count},
       {"own_frames", all - count},
       {"carried_heldout_frames", carried_judge},
       {"difference_mm", refined.difference_mm()},
       {"seconds", watch.seconds()}},
      format("{} carried frames moved to what {} own frames show, which were {:.2f} mm RMS off them, in "
             "{:.1f} s: modifiers '{}' and the like of the dataset's stack\n",
             count, all - count, refined.difference_mm(), watch.seconds(), trainer::refinement_of(*carried.begin())));
}

void add_refine(CLI::App& transfer) {
  const auto [verb, arguments] = add_verb<RefineArguments>(
      transfer, "refine", "Carried frames of a dataset, moved to what frames of the body's own in it show", run_refine);
  add_required(verb, "dataset", arguments.dataset, "DATASET", "Dataset (folder or dataset.json)");
  add_required(verb, "--carried", arguments.carried, "TAKE",
               "Takes that 'transfer dataset' wrote; the others are its own");
  add_option(verb, "--seed", arguments.options.seed, "Seed of every random choice")->capture_default_str();
  arguments.json.add(verb);
}

void add_shared(CLI::App& verb, TransferArguments& arguments) {
  add_option(verb, "--map", arguments.options.joint_map, "FILE",
             "Which joint of the source is which of the target, where names do not tell (joint_map.json)");
  add_option(verb, "--markers", arguments.markers, "FILE", "Vertices of both skins that are the same (markers.json)");
  add_flag(verb, "--source-size", arguments.source_size,
           "Displacements in metres as on the source, and not by the target's local size");
  add_flag(verb, "--force", arguments.force, "Go on with bodies that are unlike");
  add_unit(verb, arguments.unit);
  arguments.json.add(verb);
}

}  // namespace

void add_transfer(CLI::App& app) {
  CLI::App& verb = add_verb(app, "transfer", "Transfer what was simulated or learned to other characters");
  verb.require_subcommand(1);

  const auto [dataset, of_dataset] = add_verb<TransferArguments>(
      verb, "dataset", "A dataset of another character: clips, shapes, muscles, regions", run_dataset);
  add_required(dataset, "source", of_dataset.source, "DATASET", "Dataset (folder or dataset.json)");
  add_required(dataset, "target", of_dataset.targets, "CHARACTER", "The other character (.glb, .gltf, .fbx)")
      ->expected(1);
  add_option(dataset, "--out", of_dataset.outs, "DATASET", "Folder of the dataset to write")->required()->expected(1);
  add_option(dataset, "--picture", of_dataset.picture, "FILE.png",
             "Picture of the match (.png): by colour, and how sure it is");
  add_shared(dataset, of_dataset);

  const auto [basis, of_basis] = add_verb<TransferArguments>(
      verb, "basis", "A trained basis for other characters, at no cost at run time", run_basis);
  add_required(basis, "source", of_basis.source, "BASIS",
               "Trained basis, or a proxy with all of its levels (.safetensors)");
  add_required(basis, "targets", of_basis.targets, "CHARACTER", "The other characters (.glb, .gltf, .fbx)");
  add_required(basis, "--out", of_basis.outs, "BASIS", "Bases to write (.safetensors), one per target")
      ->check(must_end_in(".safetensors"));
  add_option(basis, "--picture", of_basis.picture, "FILE.png",
             "Picture of the match with the last target (.png): by colour, and how sure it is");
  add_option(basis, "--report", of_basis.report, "FILE.html",
             "Page on how well the bodies match, part by part, and what to simulate next (.html)");
  CLI::Option* clip = add_option(basis, "--clip", of_basis.clip, "CLIP", "Poses for the report: motion of the source");
  add_retargeting(basis, of_basis.clip_options.joint_map, of_basis.clip_options.up);
  for (const char* of_clip : {"--joint-map", "--up"}) basis.get_option(of_clip)->needs(clip);
  add_option(basis, "--proxy", of_basis.proxy, "BASIS",
             "Proxy of the source (default: BASIS.proxy.safetensors beside it), whose levels go with it, to "
             "OUT.proxy.safetensors");
  add_option(basis, "--muscles", of_basis.muscles, "FILE",
             "The source's muscles (muscles.json), for the dynamics that stand beside it: those are made for the "
             "targets, too");
  add_flag(basis, "--alone", of_basis.alone, "Without the dynamics and the proxy that stand beside the source")
      ->excludes(basis.get_option("--proxy"))
      ->excludes(basis.get_option("--muscles"));
  add_option(basis, "--frames", of_basis.frames, "R", "Frames of it (default: all)");
  add_shared(basis, of_basis);
  add_refine(verb);
}

}  // namespace bodyopt::cli
