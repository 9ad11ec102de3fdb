#include "cli/range_dataset.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/frame_range.h"
#include "cli/arguments/dataset_arguments.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "runtime/threads/tbb_executor.h"
#include "trainer/curate/mirror_image.h"
#include "trainer/motion/attached_rig.h"
#include "trainer/motion/first_limits.h"
#include "trainer/motion/range_of_motion.h"
#include "trainer/train/data/samples.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kRangeFrames = 1600, kRangeBits = 11;  // of the clip; the drafts are of some of them, spread evenly
constexpr unsigned kLeast = 100;       // of these; they tell what a draft costs: some take many times as long
constexpr std::size_t kTimed = 12;     // frames at most of a clip that tell it, where there is no range of motion
constexpr double kBlends = 0.5;        // of the random poses are blends of the clips', the others within the limits
constexpr double kShareOfClips = 0.5;  // of the minutes, at most
constexpr const char* kRange = "range_of_motion";

// Takes of a character in a dataset.
class RangeDataset {
 public:
  RangeDataset(const std::string& character, double unit, const RangeDatasetArguments& arguments)
      : path_(character), arguments_(arguments), folder_(arguments.folder), character_(read_character(path_, unit)) {
    for (const std::string& name : clip_names(path_)) own_clips_.push_back(name.empty() ? path_ : path_ + "#" + name);
    clips_ = arguments.clips.empty() ? own_clips_ : arguments.clips;
    require_names_apart();
  }

  fs::path make() {
    say(character_.notes);
    if (arguments_.no_range && clips_.empty()) {
      throw Error(ErrorKind::usage, path_, " has no clips of its own: without a range of motion train needs --clip");
    }
    make_folder(folder_);
    if (!arguments_.no_range) make_range();
    simulate_takes();
    show_both_sides();
    return folder_;
  }

 private:
  // Takes have the names of their clips.
  void require_names_apart() const {
    std::map<std::string, std::string> clip_of{{kRange, "the range of motion"}};
    for (const std::string& clip : clips_) {
      TakeArguments take;
      take.clip.source = clip;
      const auto [there, is_new] = clip_of.try_emplace(take.take_name(), clip);
      if (is_new) continue;
      throw Error(ErrorKind::usage, clip, " and ", there->second, " would both be the take '", there->first,
                  "': give one of the clips another name");
    }
  }

  std::string in_folder(const std::string& name) const { return (folder_ / name).string(); }
  std::string range_file() const { return in_folder(std::string(kRange) + ".glb"); }

  // Limits are given, those of an earlier run, which may have been edited, or first ones of all clips there are.
  trainer::JointLimits limits() const {
    const Skeleton& skeleton = character_.skeleton;
    if (!arguments_.limits.empty()) return trainer::read_joint_limits(arguments_.limits, skeleton);
    const std::string own = in_folder("limits.json");
    if (fs::exists(own)) return trainer::read_joint_limits(own, skeleton);
    std::vector<std::string> known = own_clips_;
    std::ranges::copy_if(clips_, std::back_inserter(known), [&](const std::string& clip) {
      return std::ranges::find(own_clips_, clip) == own_clips_.end();
    });
    trainer::JointLimits first =
        trainer::first_limits(character_, read_poses(known, skeleton, character_.unit, arguments_.clip));
    trainer::write_joint_limits(first, skeleton, own);
    return first;
  }

  void make_range() const {
    if (fs::exists(range_file())) return;
    const trainer::JointLimits own = limits();
    const trainer::AttachedRig rig(character_.skeleton, own.detached);
    const Character attached = rig.attached(character_);
    const trainer::JointLimits on_attached = rig.attached(own);
    const std::vector<Pose> shown =
        rig.attached(read_poses(clips_, character_.skeleton, character_.unit, arguments_.clip));
    const trainer::RangeOfMotion motion =
        trainer::range_of_motion(attached, on_attached, {.frames = kRangeFrames, .examples = shown, .blends = kBlends});
    write_clip(rig.detached(trainer::clip_of(motion, on_attached, attached.skeleton)), character_.skeleton,
               character_.unit, range_file());
  }

  SimulationArguments simulation(const std::string& clip, const std::vector<int>& frames) const {
    SimulationArguments simulation;
    simulation.character = path_;
    simulation.muscles = arguments_.muscles;
    simulation.out = folder_.string();
    simulation.instead = "name another --data";
    simulation.unit = character_.unit;
    simulation.take.clip.source = clip;
    if (clip != range_file()) simulation.take.clip.options = arguments_.clip;
    simulation.take.clip.frames = format_frame_range(frames);
    simulation.options.draft = true;
    simulation.options.give_up_after = trainer::kMostIterationsOfDraft;
    return simulation;
  }

  // Wall-clock seconds that a draft took on average.
  double simulate(const std::string& clip, const std::vector<int>& frames) {
    const std::set<int> asked(frames.begin(), frames.end());
    double seconds = 0;
    for (const FrameStatus& frame : simulate_take(simulation(clip, frames), prepared_)) {
      if (asked.contains(frame.frame)) seconds += frame.seconds;
    }
    return seconds / static_cast<double>(frames.size() * thread_count());
  }

  // Van der Corput order, by the reversed bits of the frames' numbers, spreads the first frames evenly. A larger count
  // contains every smaller one.
  static std::vector<int> range_frames(std::size_t count) {
    std::vector<int> frames;
    for (unsigned k = 0; frames.size() < count; ++k) {
      unsigned reversed = 0;
      for (unsigned bit = 0; bit < kRangeBits; ++bit) reversed |= (k >> bit & 1u) << (kRangeBits - 1 - bit);
      if (reversed < kRangeFrames) frames.push_back(static_cast<int>(reversed) + 1);
    }
    std::ranges::sort(frames);
    return frames;
  }

  std::size_t frames_of(const std::string& clip) const {
    ClipArguments choice;
    choice.source = clip;
    choice.options = arguments_.clip;
    std::vector<int> frames;
    return choice.read(character_.skeleton, character_.unit, frames).poses.size();
  }

  // Every Nth frame of every clip is taken. N is a power of two, so that a longer run takes all drafts of a shorter
  // one.
  static std::size_t step_of_clips(const std::vector<std::size_t>& counts, double most) {
    for (std::size_t step = 1;; step *= 2) {
      std::size_t frames = 0;
      bool are_more = false;
      for (const std::size_t count : counts) {
        frames += (count + step - 1) / step;
        are_more = are_more || count > step;
      }
      if (static_cast<double>(frames) <= most || !are_more) return step;
    }
  }

  std::vector<int> clip_frames(std::size_t count, std::size_t step) const {
    std::vector<int> frames;
    for (std::size_t frame = 0; frame < count; frame += step) {
      frames.push_back(arguments_.clip.first_frame + static_cast<int>(frame));
    }
    return frames;
  }

  void simulate_takes() {
    std::vector<std::size_t> counts;
    for (const std::string& clip : clips_) counts.push_back(frames_of(clip));
    const bool range = !arguments_.no_range;
    const double each =
        std::max(range ? simulate(range_file(), range_frames(kLeast))
                       : simulate(clips_[0], clip_frames(counts[0], step_of_clips({counts[0]}, kTimed))),
                 1e-6);
    double seconds = 60 * arguments_.minutes;
    const std::size_t step = step_of_clips(counts, (range ? kShareOfClips : 1) * seconds / each);
    std::size_t simulated = 0;
    for (std::size_t k = 0; k < clips_.size(); ++k) {
      const std::vector<int> frames = clip_frames(counts[k], step);
      simulated += frames.size();
      seconds -= static_cast<double>(frames.size()) * simulate(clips_[k], frames);
    }
    if (!range) return;
    const double left = std::clamp(seconds / each, double{kLeast}, double{kRangeFrames});
    spdlog::info("a draft takes {:.2f} s: {} frames of clips, {:.0f} of the range of motion", each, simulated, left);
    simulate(range_file(), range_frames(static_cast<std::size_t>(left)));
  }

  // Few drafts tell as much again in the mirror: with their images they are few, still. Muscles may be of one side, and
  // the stack may be edited, or takes be there that this did not make.
  void show_both_sides() const {
    if (!arguments_.muscles.empty() || !trainer::is_own_mirror_image(character_)) return;
    edit_modifiers(folder_ / "dataset.json", [&](const Dataset& dataset, std::vector<Modifier>& modifiers) {
      std::size_t frames = 0;
      for (const DatasetTake& take : dataset.takes) frames += take.frames.size();
      const std::size_t made = clips_.size() + (arguments_.no_range ? 0 : 1);
      if (2 * frames > trainer::kFewFrames || dataset.takes.size() > made || is_edited(dataset)) return;
      Modifier& symmetry = modifiers.emplace_back();
      symmetry.name = symmetry.type = "symmetry";
      spdlog::info("the body is its own mirror image: drafts are learned for both sides (the modifier symmetry)");
    });
  }

  std::string path_;
  const RangeDatasetArguments& arguments_;
  fs::path folder_;
  Character character_;
  std::vector<std::string> own_clips_, clips_;  // those in the character's file, those to learn
  std::optional<PreparedBody> prepared_;
};

}  // namespace

void RangeDatasetArguments::add(CLI::App& verb) {
  add_option(verb, "--data", folder, "DIR",
             "Of a character: folder of the dataset to make, or to go on with (default: beside --out)");
  add_option(verb, "--clip", clips, "Of a character: clips to learn beside the range of motion (default: its own)")
      ->type_name("CLIP");
  add_option(verb, "--limits", limits, "FILE",
             "Of a character: joint limits of its range of motion (default: limits.json of the dataset's folder, where "
             "first ones are written)");
  add_option(verb, "--muscles", muscles, "FILE", "Of a character: muscles.json (default: passive tissue only)");
  add_number(verb, "--minutes", minutes, 0.1, 1e5,
             "Of a character: how long it is simulated; the range of motion gets as many frames as fit, a hundred at "
             "least");
  add_flag(verb, "--no-range", no_range, "Of a character: learn its clips alone, without a range of motion");
  add_number(verb, "--fps", clip.fps, kLeastRate, kMostRate, "Of a character: frames a second of its clips");
  add_retargeting(verb, clip.joint_map, clip.up);
}

bool RangeDatasetArguments::any() const {
  const ClipOptions plain;
  return !folder.empty() || !clips.empty() || !limits.empty() || !muscles.empty() || minutes != kMinutes || no_range ||
         clip.fps != plain.fps || !clip.joint_map.empty() || !clip.up.empty();
}

std::filesystem::path make_range_dataset(const std::string& character, double unit,
                                         const RangeDatasetArguments& arguments) {
  return RangeDataset(character, unit, arguments).make();
}

}  // namespace bodyopt::cli
