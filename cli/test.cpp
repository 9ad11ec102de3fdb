// bodyopt test: how well a basis does on shapes that it did not learn from.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/frame_range.h"
#include "cli/arguments/common.h"
#include "cli/results/evaluation_log.h"
#include "dataset/dataset.h"
#include "runtime/core/transformed.h"
#include "trainer/train/data/learned_poses.h"
#include "trainer/train/judge/test_errors.h"

namespace bodyopt::cli {
namespace {

constexpr double kHarm = 0.02;  // a part that is worse by less than this share is as good

struct TestArguments {
  std::string basis, dataset;
  JsonOption json;
};

Json numbers_of(const trainer::MethodErrors& errors) {
  return {{"ddm_mm", errors.ddm},
          {"full_mm", errors.full},
          {"ratio", errors.ddm > 0 ? errors.full / errors.ddm : 0},
          {"expected_mm", errors.expected}};
}

// Ascending.
std::vector<int> learned_frames(const trainer::TakeErrors& take) {
  std::vector<int> numbers;
  for (const trainer::FrameErrors& frame : take.frames) {
    if (frame.learned) numbers.push_back(frame.frame);
  }
  std::ranges::sort(numbers);
  return numbers;
}

// Takes that begin at rest have one frame or another like one that was learned.
void warn_of_learned(const trainer::TakeErrors& take) {
  constexpr std::size_t kMany = 10;  // one frame of so many
  const std::vector<int> learned = learned_frames(take);
  if (learned.empty() || kMany * learned.size() < take.frames.size()) return;
  spdlog::warn(
      "take '{}': the basis learned from {} of the {} frames tested ({}): their errors tell how well it repeats them, "
      "not what it makes of others",
      take.take, learned.size(), take.frames.size(), format_frame_range(learned));
}

// `told`: the basis names the poses it learned from.
Json details_of(const trainer::TakeErrors& take, bool told) {
  Json parts = Json::array(), frames = Json::array();
  const std::vector<int> learned = learned_frames(take);
  for (const trainer::PartErrors& part : take.parts) {
    Json entry = {{"part", part.part}, {"area_m2", part.area}};
    entry.update(numbers_of(part.errors));
    parts.push_back(entry);
  }
  for (const trainer::FrameErrors& frame : take.frames) {
    Json entry = {{"frame", frame.frame}};
    entry.update(numbers_of(frame.errors));
    entry["fade"] = frame.fade;
    entry["fading_joint"] = frame.fading_joint;
    frames.push_back(entry);
  }
  Json result = {{"take", take.take}, {"frames", take.frames.size()}};
  result.update(numbers_of(take.errors));
  result["learned_frames"] = nullptr;
  if (told) result["learned_frames"] = learned.empty() ? "" : format_frame_range(learned);
  result["rank_correlation"] = take.rank_correlation;
  result["parts"] = parts;
  result["per_frame"] = frames;
  return result;
}

std::string columns_of(const trainer::MethodErrors& errors) {
  return format("{:9.3f} {:9.3f} {:7.3f} {:9.3f}", errors.ddm, errors.full,
                errors.ddm > 0 ? errors.full / errors.ddm : 0.0, errors.expected);
}

std::string lines_of(const trainer::TakeErrors& take) {
  std::string text =
      format("{:20} {:6} {} {:6.2f}\n", take.take, take.frames.size(), columns_of(take.errors), take.rank_correlation);
  std::vector<trainer::PartErrors> parts = take.parts;
  std::ranges::sort(parts, [](const trainer::PartErrors& a, const trainer::PartErrors& b) {
    return a.errors.full * b.errors.ddm > b.errors.full * a.errors.ddm;
  });
  parts.resize(std::min<std::size_t>(3, parts.size()));
  for (const trainer::PartErrors& part : parts) {
    text += format("  {:18} {:>6} {}\n", part.part, "", columns_of(part.errors));
  }
  const std::size_t harmed = trainer::harmed_parts(take, kHarm).size();
  text += harmed == 0 ? "  no part is worse than untrained\n"
                      : format("  {} of {} parts are worse than untrained\n", harmed, take.parts.size());
  FadeLog fades;
  for (const trainer::FrameErrors& frame : take.frames) fades.add(frame.frame, frame.fade, frame.fading_joint);
  return text + (fades.text().empty() ? "" : "  " + fades.text());
}

void run(const TestArguments& arguments) {
  arguments.json.require_writable();
  const Basis basis = load_basis(arguments.basis);
  const std::filesystem::path path = dataset_file(arguments.dataset);
  const trainer::SampleSet set = trainer::read_samples(read_dataset(path));
  say(set.notes);
  const bool told = trainer::tells_learned_poses(basis);
  if (!told && basis.residual.coefficient_count() > 0) {
    say(
        {"the basis does not tell which poses it learned from (one of an older version, or a carried one): whether "
         "frames tested are among them is not known"});
  }
  Json takes = Json::array();
  std::string text = format(
      "RMS by area, mm; of the parts of the body, by joint, those that gained least\n{:20} {:>6} {:>9} {:>9} {:>7} "
      "{:>9} {:>6}\n",
      "take", "frames", "DDM", "full", "ratio", "expected", "rho");
  for (const trainer::TakeErrors& take : trainer::test_errors(basis, set)) {
    warn_of_learned(take);
    Json entry = details_of(take, told);
    const Json harmed = transformed(trainer::harmed_parts(take, kHarm), &trainer::PartErrors::part);
    entry["harmed_parts"] = harmed;
    takes.push_back(entry);
    text += lines_of(take);
  }
  arguments.json.emit({{"basis", arguments.basis}, {"takes", takes}}, text);
}

}  // namespace

void add_test(CLI::App& app) {
  const auto [verb, arguments] = add_verb<TestArguments>(
      app, "test", "Measure a basis on shapes that it did not learn from, by area and by part of the body", run);
  add_required(verb, "basis", arguments.basis, "BASIS", "Basis (.safetensors)");
  add_required(verb, "dataset", arguments.dataset, "DATASET",
               "dataset.json or its folder: its held-out frames are tested, or all of them where none is held out");
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
