// Effects of modifiers in a shot: how far each moves the skin, and folds that push-out leaves, also of joints bent far.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "trainer/modifiers/measure_modifiers.h"

namespace bodyopt::cli {

// How deep skin lies in skin.
struct ShotFolds {
  std::size_t frames = 0;  // that were looked at
  trainer::FoldMeasure measure;
  int deepest_frame = 0;
};

// Measures the quasi-static skin of some of the frames in which a fold may close, spread over them. Nothing where the
// stack has no push-out, or it is switched off, or no fold closes. `frames`: the poses' numbers.
std::optional<ShotFolds> measure_shot_folds(const Basis& basis, std::span<const Pose> poses,
                                            std::span<const int> frames);

Json to_json(const ShotFolds& folds);
// A line for people.
std::string text_of(const ShotFolds& folds);

Json to_json(const std::vector<trainer::BentJoint>& folds);
// A table for people.
std::string text_of(const std::vector<trainer::BentJoint>& folds, const std::string& how_far);

// How far each modifier moves the skin.
struct ShotMoves {
  std::size_t frames = 0;  // looked at, spread over the shot
  std::vector<trainer::ModifierMove> moves;
  std::vector<int> numbers;  // of each move: the frame in which it is
};

// Empty where the basis has no modifiers that are switched on. `frames`: the poses' numbers.
ShotMoves measure_shot_moves(const Basis& basis, std::span<const Pose> poses, std::span<const int> frames);

Json to_json(const ShotMoves& moves);
std::string text_of(const ShotMoves& moves);

}  // namespace bodyopt::cli
