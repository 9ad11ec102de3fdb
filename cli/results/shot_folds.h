// What push-out does in a shot.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "cli/arguments/common.h"
#include "trainer/modifiers/measure_push_out.h"

namespace bodyopt::cli {

struct ShotFolds {
  std::size_t frames = 0;  // that were looked at
  FoldMeasure measure;
  int deepest_frame = 0;
};

// Of some frames, spread over the shot, of its quasi-static skin. Nothing where the stack has no push-out, or it is
// switched off. `frames`: the poses' numbers.
std::optional<ShotFolds> measure_shot_folds(const Basis& basis, std::span<const Pose> poses,
                                            std::span<const int> frames);

Json to_json(const ShotFolds& folds);
// Lines for people.
std::string text_of(const ShotFolds& folds);

}  // namespace bodyopt::cli
