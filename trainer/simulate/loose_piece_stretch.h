// How far loose pieces that follow a body are stretched.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "assets/characters/character.h"

namespace bodyopt::trainer {

// The edge of a loose piece that is stretched most in some shapes of the skin.
class LoosePieceStretch {
 public:
  // riding: vertices of the skin.
  LoosePieceStretch(const Character& character, const std::vector<std::uint32_t>& riding);

  void add(int frame, const Positions& skin);  // V x 3, metres

  double most() const { return most_; }  // of the length at rest; 0: there are no loose pieces
  // One sentence with the place and a remedy, where it is more than kMost.
  std::string warning() const;

  static constexpr double kMost = 1.5;

 private:
  const Character& character_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;
  std::vector<double> length_;  // of each at rest, metres
  double most_ = 0;
  std::size_t edge_ = 0;  // that is stretched most
  int frame_ = 0;         // in which
};

}  // namespace bodyopt::trainer
