#include "cli/results/modifier_effects.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/json_file.h"
#include "base/spread_evenly.h"
#include "runtime/basis/skin_modifiers.h"
#include "runtime/core/transformed.h"

namespace bodyopt::cli {
namespace {

constexpr std::size_t kMostFoldFrames = 8;  // a fold takes a tenth of a second to measure

bool may_close(const Pose& pose, const SkinModifier& push_out) {
  const auto weights = std::span(pose.modifiers).subspan(push_out.first_component, push_out.component_count);
  return std::ranges::any_of(weights, [](float weight) { return weight != 0; });
}

Json to_json(const trainer::FoldMeasure& measure) {
  return {{"deepest_mm", 1e3 * measure.deepest},
          {"left_mm", 1e3 * measure.deepest_left},
          {"removed_share", measure.removed()},
          {"elsewhere_mm", 1e3 * measure.elsewhere}};
}

constexpr std::size_t kMostMoveFrames = 16;

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
  const std::vector<std::size_t> looked_at =
      transformed(spread_in_middles(closing.size(), kMostFoldFrames), [&](std::size_t k) { return closing[k]; });
  const std::vector<trainer::FoldMeasure> measures =
      trainer::FoldJudge(basis)(transformed(looked_at, [&](std::size_t at) { return poses[at]; }));
  ShotFolds folds;
  folds.frames = looked_at.size();
  for (std::size_t k = 0; k < folds.frames; ++k) {
    if (k == 0 || measures[k].deepest > folds.measure.deepest) folds.deepest_frame = frames[looked_at[k]];
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
  const trainer::FoldMeasure& measure = folds.measure;
  if (!(measure.sum > 0)) return format("push-out: no skin in skin in the {} frames looked at\n", folds.frames);
  return format(
      "push-out, {} frames looked at: skin in skin up to {:.1f} mm deep, in frame {}; {:.1f} mm left, {:.1f} % of all "
      "depth taken out; other skin moves by {:.4f} mm at most\n",
      folds.frames, 1e3 * measure.deepest, folds.deepest_frame, 1e3 * measure.deepest_left, 100 * measure.removed(),
      1e3 * measure.elsewhere);
}

Json to_json(const std::vector<trainer::BentJoint>& folds) {
  return transformed(folds, [](const trainer::BentJoint& fold) {
    Json json = to_json(fold.measure);
    json["joint"] = fold.joint;
    return json;
  });
}

std::string text_of(const std::vector<trainer::BentJoint>& folds, const std::string& how_far) {
  if (folds.empty()) return "no skin crosses skin where a joint is bent " + how_far + "\n";
  std::string text =
      format("{:30} {:>9} {:>9} {:>10} {:>13}\n", "bent " + how_far, "deep mm", "left mm", "taken out", "elsewhere mm");
  for (const trainer::BentJoint& fold : folds) {
    text += format("{:30} {:9.1f} {:9.1f} {:8.1f} % {:13.4f}\n", fold.joint, 1e3 * fold.measure.deepest,
                   1e3 * fold.measure.deepest_left, 100 * fold.measure.removed(), 1e3 * fold.measure.elsewhere);
  }
  return text;
}

ShotMoves measure_shot_moves(const Basis& basis, std::span<const Pose> poses, std::span<const int> frames) {
  ShotMoves shot;
  if (std::ranges::none_of(basis.modifiers.stack, &SkinModifier::on) || poses.empty()) return shot;
  const std::vector<std::size_t> looked_at = spread_in_middles(poses.size(), kMostMoveFrames);
  shot.frames = looked_at.size();
  shot.moves = trainer::measure_moves(basis, transformed(looked_at, [&](std::size_t at) { return poses[at]; }));
  for (const trainer::ModifierMove& move : shot.moves) shot.numbers.push_back(frames[looked_at[move.pose]]);
  return shot;
}

Json to_json(const ShotMoves& shot) {
  Json list = Json::array();
  for (std::size_t k = 0; k < shot.moves.size(); ++k) {
    list.push_back({{"modifier", shot.moves[k].modifier},
                    {"largest_mm", 1e3 * shot.moves[k].largest},
                    {"frame", shot.numbers[k]},
                    {"frames", shot.frames}});
  }
  return list;
}

std::string text_of(const ShotMoves& shot) {
  std::string text;
  for (std::size_t k = 0; k < shot.moves.size(); ++k) {
    const trainer::ModifierMove& move = shot.moves[k];
    if (move.largest == 0) {
      text += format("modifier {}, {} frames looked at: moves nothing\n", move.modifier, shot.frames);
      continue;
    }
    text += format("modifier {}, {} frames looked at: moves the skin by {:.2f} mm at most, in frame {}\n",
                   move.modifier, shot.frames, 1e3 * move.largest, shot.numbers[k]);
  }
  return text;
}

}  // namespace bodyopt::cli
