// bodyopt improve: what shots lack is simulated and learned, as long as it helps.

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "base/frame_range.h"
#include "cli/arguments/dataset_arguments.h"
#include "cli/results/attachments.h"
#include "cli/results/measure.h"
#include "runtime/core/error.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/provenance.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kRound = 25;         // frames between two trainings
constexpr int kTested = 5;         // every fifth of them is held out, and tells what was gained
constexpr double kWorthIt = 0.02;  // of the error on these: less than that is no gain

struct ImproveArguments {
  std::string dataset, basis;
  std::vector<std::string> clips;
  int frames = 50;
  ClipOptions options;
  JsonOption json;
};

// A clip and what of it is not simulated yet.
struct ImprovedClip {
  TakeArguments take;
  std::vector<int> frames;
  std::vector<Pose> poses;
};

// A chosen frame.
struct Chosen {
  std::size_t shot;
  int frame;
  bool heldout;
};

TakeArguments take_of(const ImproveArguments& arguments, const std::string& source) {
  TakeArguments take;
  take.clip.source = source;
  take.clip.options = arguments.options;
  return take;
}

// The frames of the take of that name that are there already.
std::set<int> known_frames(const Dataset& dataset, const std::string& name) {
  for (const DatasetTake& take : dataset.takes) {
    if (take.name == name) return {take.frames.begin(), take.frames.end()};
  }
  return {};
}

std::vector<ImprovedClip> read_shots(const ImproveArguments& arguments, const Dataset& dataset,
                                     const Skeleton& skeleton) {
  std::vector<ImprovedClip> shots;
  for (const std::string& source : arguments.clips) {
    ImprovedClip& shot = shots.emplace_back(ImprovedClip{take_of(arguments, source), {}, {}});
    std::vector<int> frames;
    const Clip clip = shot.take.clip.read(skeleton, dataset.unit, frames);
    const std::set<int> known = known_frames(dataset, shot.take.take_name());
    std::erase_if(frames, [&](int frame) { return known.contains(frame); });
    shot.frames = frames;
    shot.poses = shots::poses_of(clip, frames);
  }
  return shots;
}

// Expected errors of all shots, one after the other, mm.
std::vector<double> expected_of(const Basis& basis, const std::vector<ImprovedClip>& shots) {
  std::vector<double> expected;
  for (const ImprovedClip& shot : shots) {
    for (const ExpectedError& error : trainer::expected_errors(basis, shot.poses)) expected.push_back(error.rms_mm);
  }
  return expected;
}

// Takes the worst frames, no two of them neighbours, out of the shots.
std::vector<Chosen> choose(std::vector<ImprovedClip>& shots, const std::vector<double>& expected, std::size_t count) {
  std::vector<Chosen> chosen;
  const std::vector<std::size_t> worst =
      trainer::worth_simulating(expected, count, trainer::spreading_gap(expected.size(), count));
  for (const std::size_t at : worst) {
    std::size_t shot = 0, first = 0;
    while (at >= first + shots[shot].frames.size()) first += shots[shot++].frames.size();
    const bool heldout = chosen.size() % kTested == kTested / 2;
    chosen.push_back({shot, shots[shot].frames[at - first], heldout});
  }
  for (const Chosen& c : chosen) {
    ImprovedClip& shot = shots[c.shot];
    const auto place = std::ranges::find(shot.frames, c.frame) - shot.frames.begin();
    shot.frames.erase(shot.frames.begin() + place);
    shot.poses.erase(shot.poses.begin() + place);
  }
  return chosen;
}

bool is_draft(const Dataset& dataset) {
  return !dataset.takes.empty() && fs::path(dataset.takes.front().shapes).extension() == ".nodes";
}

void simulate_chosen(const Dataset& dataset, const std::vector<ImprovedClip>& shots,
                     const std::vector<Chosen>& chosen) {
  const auto in_folder = [&](const std::string& file) { return file.empty() ? "" : (dataset.folder / file).string(); };
  std::optional<PreparedBody> prepared;
  for (std::size_t s = 0; s < shots.size(); ++s) {
    std::vector<int> frames, heldout;
    for (const Chosen& c : chosen) {
      if (c.shot != s) continue;
      frames.push_back(c.frame);
      if (c.heldout) heldout.push_back(c.frame);
    }
    if (frames.empty()) continue;
    std::ranges::sort(frames);
    std::ranges::sort(heldout);
    SimulationArguments simulation;
    simulation.character = in_folder(dataset.character);
    simulation.muscles = in_folder(dataset.muscles);
    simulation.materials = in_folder(dataset.materials);
    simulation.anatomy = {dataset.body_fat, dataset.kind, in_folder(dataset.corrections)};
    simulation.out = dataset.folder.string();
    simulation.instead = "improve another dataset";
    simulation.unit = dataset.unit;
    simulation.take = shots[s].take;
    simulation.take.clip.frames = format_frame_range(frames);
    if (!heldout.empty()) simulation.take.heldout = format_frame_range(heldout);
    simulation.options.draft = is_draft(dataset);
    if (simulation.options.draft) simulation.options.give_up_after = trainer::kMostIterationsOfDraft;
    simulate_take(simulation, prepared);
  }
}

// Errors on these frames of the set, all takes together.
trainer::MethodErrors errors_on(const Basis& basis, const trainer::SampleSet& set,
                                const std::vector<trainer::Sample>& samples) {
  double ddm = 0, full = 0, expected = 0, frames = 0;
  for (const trainer::TakeErrors& take : trainer::test_errors(basis, set, samples)) {
    const auto count = static_cast<double>(take.frames.size());
    ddm += count * take.errors.ddm * take.errors.ddm;
    full += count * take.errors.full * take.errors.full;
    expected += count * take.errors.expected * take.errors.expected;
    frames += count;
  }
  const double each = std::max(1.0, frames);
  return {std::sqrt(ddm / each), std::sqrt(full / each), std::sqrt(expected / each)};
}

// Held-out frames of these shots only.
std::vector<trainer::Sample> tested(const trainer::SampleSet& set, const std::vector<ImprovedClip>& shots) {
  std::set<std::string> names;
  for (const ImprovedClip& shot : shots) names.insert(shot.take.take_name());
  std::vector<trainer::Sample> samples = set.heldout;
  std::erase_if(samples, [&](const trainer::Sample& sample) { return !names.contains(set.take_of(sample)); });
  return samples;
}

// Trains as the basis was trained, with the new shapes.
trainer::TrainOptions options_of(const Basis& basis, const std::string& path) {
  const std::optional<trainer::Provenance> trained = trainer::read_provenance(basis.metadata, path);
  if (!trained || basis.coverage.empty()) {
    throw Error(ErrorKind::mismatch, path, " was not trained on shapes: improve goes on from what train wrote");
  }
  trainer::TrainOptions options = trained->options;
  options.keep_in = fs::path(path).replace_extension(".training");
  options.update = true;
  return options;
}

// What is simulated stays in the dataset: a basis of another character is refused before.
void require_basis_of(const Dataset& dataset, const Basis& basis, const std::string& path) {
  const fs::path file = dataset.folder / dataset.character;
  const Character character = read_character(file, dataset.unit);
  const Character ordered = trainer::in_order(character, trainer::morton_order(character.vertices));
  try {
    trainer::require_same_character(trainer::make_mesh_table(ordered), ordered.skeleton, basis);
  } catch (const Error& error) {
    throw Error(error.kind(), path, ", ", file, ": ", error.what());
  }
}

void run(const ImproveArguments& arguments) {
  arguments.json.require_writable();
  require_writable(arguments.basis);
  const fs::path path = dataset_file(arguments.dataset);
  Basis basis = load_basis(arguments.basis);
  const trainer::TrainOptions options = options_of(basis, arguments.basis);
  const Dataset dataset = read_dataset(path);
  require_basis_of(dataset, basis, arguments.basis);
  std::vector<ImprovedClip> shots = read_shots(arguments, dataset, basis.skeleton);

  Json rounds = Json::array();
  std::string text;
  int left = arguments.frames;
  while (left > 0) {
    const std::vector<double> expected = expected_of(basis, shots);
    const auto count = static_cast<std::size_t>(std::min(left, kRound));
    const std::vector<Chosen> chosen = choose(shots, expected, count);
    if (chosen.empty()) {
      text += "every frame of the shots is simulated\n";
      break;
    }
    left -= static_cast<int>(chosen.size());
    simulate_chosen(dataset, shots, chosen);
    const Dataset grown = read_dataset(path);
    const trainer::SampleSet set = trainer::read_samples(grown);
    const std::vector<trainer::Sample> test = tested(set, shots), &measured = test.empty() ? set.train : test;
    const trainer::MethodErrors before = errors_on(basis, set, measured);
    basis = train_and_measure(set, options, false, set.character.unit, arguments.basis).result.basis;
    attach_own_meshes(grown.folder / grown.character, set.character.unit, set.character.output_count(), basis,
                      arguments.basis);
    const trainer::MethodErrors after = errors_on(basis, set, measured);
    const double rest_before = trainer::root_mean_square(expected),
                 rest_after = trainer::root_mean_square(expected_of(basis, shots));
    rounds.push_back({{"frames", chosen.size()},
                      {"heldout_frames", test.size()},
                      {"ddm_mm", before.ddm},
                      {"before_mm", before.full},
                      {"after_mm", after.full},
                      {"expected_on_the_rest_before_mm", rest_before},
                      {"expected_on_the_rest_after_mm", rest_after}});
    const std::string on = test.empty()
                               ? format("of these shots none is held out; on the {} trained on", set.train.size())
                               : format("on the {} that are held out", test.size());
    text +=
        format("{} frames more: {} {:.3f} -> {:.3f} mm RMS (DDM {:.3f}); expected of the rest {:.3f} -> {:.3f} mm\n",
               chosen.size(), on, before.full, after.full, before.ddm, rest_before, rest_after);
    if (test.empty() || after.full <= (1 - kWorthIt) * before.full) continue;
    text += "more frames of these shots gain nothing\n";
    break;
  }
  arguments.json.emit({{"basis", arguments.basis}, {"dataset", path.string()}, {"rounds", rounds}},
                      text + "wrote " + arguments.basis + "\n");
}

}  // namespace

void add_improve(CLI::App& app) {
  const auto [verb, arguments] = add_verb<ImproveArguments>(
      app, "improve", "Simulate the frames of shots that a basis knows least, and learn them, as long as it helps",
      run);
  add_required(verb, "dataset", arguments.dataset, "DATASET",
               "dataset.json, or its folder: what the basis was trained on");
  add_required(verb, "--basis", arguments.basis, "BASIS", "The basis to improve, in place")
      ->check(must_end_in(".safetensors"));
  add_required(verb, "--clip", arguments.clips, "CLIP",
               "Shots: FILE.glb#name, FILE.glb (its only or first clip) or FILE.bvh");
  add_number(verb, "--frames", arguments.frames, 1, 100000,
             "Frames to simulate at most; every fifth is held out to tell the gain");
  add_number(verb, "--fps", arguments.options.fps, kLeastRate, kMostRate,
             "Frames a second at which the shots are sampled");
  add_retargeting(verb, arguments.options.joint_map, arguments.options.up);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
