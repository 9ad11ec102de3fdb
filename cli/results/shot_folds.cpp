#include "cli/results/shot_folds.h"

#include <algorithm>

namespace bodyopt::cli {
namespace {

constexpr std::size_t kMostFrames = 12;  // a fold takes tenths of a second to measure

}  // namespace

std::optional<ShotFolds> measure_shot_folds(const Basis& basis, std::span<const Pose> poses,
                                            std::span<const int> frames) {
  const SkinModifier* modifier = basis.modifiers.of_type(kPushOut);
  if (modifier == nullptr || !modifier->on || poses.empty()) return std::nullopt;
  std::vector<Pose> chosen;
  std::vector<int> numbers;
  const std::size_t count = std::min(kMostFrames, poses.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = (2 * k + 1) * poses.size() / (2 * count);
    chosen.push_back(poses[at]);
    numbers.push_back(frames[at]);
  }
  ShotFolds folds;
  folds.frames = count;
  const std::vector<FoldMeasure> measures = FoldJudge(basis)(chosen);
  for (std::size_t k = 0; k < count; ++k) {
    if (k == 0 || measures[k].deepest > folds.measure.deepest) folds.deepest_frame = numbers[k];
    folds.measure.add(measures[k]);
  }
  return folds;
}

Json to_json(const ShotFolds& folds) {
  return {{"frames", folds.frames},
          {"deepest_mm", 1e3 * folds.measure.deepest},
          {"deepest_frame", folds.deepest_frame},
          {"left_mm", 1e3 * folds.measure.deepest_left},
          {"removed_share", folds.measure.removed()},
          {"elsewhere_mm", 1e3 * folds.measure.elsewhere}};
}

std::string text_of(const ShotFolds& folds) {
  if (!(folds.measure.sum > 0)) return format("push-out: no skin in skin in %zu frames looked at\n", folds.frames);
  return format(
      "push-out, %zu frames looked at: skin in skin %.1f mm deep at most, in frame %d; %.1f mm left, %.1f %% of all "
      "depth removed; other skin moves by %.4f mm at most\n",
      folds.frames, 1e3 * folds.measure.deepest, folds.deepest_frame, 1e3 * folds.measure.deepest_left,
      100 * folds.measure.removed(), 1e3 * folds.measure.elsewhere);
}

}  // namespace bodyopt::cli
