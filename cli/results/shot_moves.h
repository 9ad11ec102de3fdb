// How far each modifier moves the skin in a shot.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "trainer/modifiers/measure_moves.h"

namespace bodyopt::cli {

struct ShotMoves {
  std::size_t frames = 0;  // looked at, spread over the shot
  std::vector<ModifierMove> moves;
  std::vector<int> numbers;  // of each move: the frame in which it is
};

// Empty where the basis has no modifiers that are switched on. `frames`: the poses' numbers.
ShotMoves measure_shot_moves(const Basis& basis, std::span<const Pose> poses, std::span<const int> frames);

Json to_json(const ShotMoves& moves);
std::string text_of(const ShotMoves& moves);

}  // namespace bodyopt::cli
