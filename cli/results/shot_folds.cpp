#include "cli/results/shot_folds.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/json_file.h"
#include "runtime/basis/skin_modifiers.h"

namespace bodyopt::cli {
namespace {

constexpr std::size_t kMostFoldFrames = 8;  // a fold takes a tenth of a second to measure

bool may_close(const Pose& pose, const SkinModifier& push_out) {
  const auto weights = std::span(pose.modifiers).subspan(push_out.first_component, push_out.component_count);
  return std::ranges::any_of(weights, [](float weight) { return weight != 0; });
}

Json to_json(const FoldMeasure& measure) {
  return {{"deepest_mm", 1e3 * measure.deepest},
          {"left_mm", 1e3 * measure.deepest_left},
          {"removed_share", measure.removed()},
          {"elsewhere_mm", 1e3 * measure.elsewhere}};
}

}  // namespace

std::optional<ShotFolds> measure_shot_folds(const Basis& basis, std::span<const Pose> poses,
                                            std::span<const int> frames) {
  const SkinModifier* push_out = basis.modifiers.of_type(kPushOut.name);
  if (push_out == nullptr) return std::nullopt;
  std::vector<std::size_t> closing;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (may_close(poses[k], *push_out)) closing.push_back(k);
  }
  if (closing.empty()) return std::nullopt;
  ShotFolds folds;
  folds.frames = std::min(kMostFoldFrames, closing.size());
  std::vector<Pose> chosen;
  std::vector<int> numbers;
  for (std::size_t k = 0; k < folds.frames; ++k) {
    const std::size_t at = closing[(2 * k + 1) * closing.size() / (2 * folds.frames)];
    chosen.push_back(poses[at]);
    numbers.push_back(frames[at]);
  }
  const std::vector<FoldMeasure> measures = FoldJudge(basis)(chosen);
  for (std::size_t k = 0; k < folds.frames; ++k) {
    if (k == 0 || measures[k].deepest > folds.measure.deepest) folds.deepest_frame = numbers[k];
    folds.measure.add(measures[k]);
  }
  return folds;
}

Json to_json(const ShotFolds& folds) {
  Json json = to_json(folds.measure);
  json["frames"] = folds.frames;
  json["deepest_frame"] = folds.deepest_frame;
  return json;
}

std::string text_of(const ShotFolds& folds) {
  const FoldMeasure& measure = folds.measure;
  if (!(measure.sum > 0)) return format("push-out: no skin in skin in the {} frames looked at\n", folds.frames);
  return format(
      "push-out, {} frames looked at: skin in skin up to {:.1f} mm deep, in frame {}; {:.1f} mm left, {:.1f} % of all "
      "depth taken out; other skin moves by {:.4f} mm at most\n",
      folds.frames, 1e3 * measure.deepest, folds.deepest_frame, 1e3 * measure.deepest_left, 100 * measure.removed(),
      1e3 * measure.elsewhere);
}

Json to_json(const std::vector<BentJoint>& folds) {
  Json list = Json::array();
  for (const BentJoint& fold : folds) {
    list.push_back(to_json(fold.measure));
    list.back()["joint"] = fold.joint;
  }
  return list;
}

std::string text_of(const std::vector<BentJoint>& folds, const std::string& how_far) {
  if (folds.empty()) return "no skin crosses skin where a joint is bent " + how_far + "\n";
  std::string text =
      format("{:30} {:>9} {:>9} {:>10} {:>13}\n", "bent " + how_far, "deep mm", "left mm", "taken out", "elsewhere mm");
  for (const BentJoint& fold : folds) {
    text += format("{:30} {:9.1f} {:9.1f} {:8.1f} % {:13.4f}\n", fold.joint, 1e3 * fold.measure.deepest,
                   1e3 * fold.measure.deepest_left, 100 * fold.measure.removed(), 1e3 * fold.measure.elsewhere);
  }
  return text;
}

}  // namespace bodyopt::cli
