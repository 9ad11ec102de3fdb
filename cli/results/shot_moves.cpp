#include "cli/results/shot_moves.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/json_file.h"

namespace bodyopt::cli {
namespace {

constexpr std::size_t kMostMoveFrames = 16;

}  // namespace

ShotMoves measure_shot_moves(const Basis& basis, std::span<const Pose> poses, std::span<const int> frames) {
  ShotMoves shot;
  if (std::ranges::none_of(basis.modifiers.stack, &SkinModifier::on) || poses.empty()) return shot;
  shot.frames = std::min(kMostMoveFrames, poses.size());
  std::vector<Pose> chosen;
  std::vector<int> numbers;
  for (std::size_t k = 0; k < shot.frames; ++k) {
    const std::size_t at = (2 * k + 1) * poses.size() / (2 * shot.frames);
    chosen.push_back(poses[at]);
    numbers.push_back(frames[at]);
  }
  shot.moves = measure_moves(basis, chosen);
  for (const ModifierMove& move : shot.moves) shot.numbers.push_back(numbers[move.pose]);
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
    const ModifierMove& move = shot.moves[k];
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
