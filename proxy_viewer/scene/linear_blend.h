// Linear blend skinning of the character that a basis was trained on, to compare with: its weights are in the
// character's file alone.
#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "assets/character.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

class LinearBlend {
 public:
  // `unit`: metres per unit of the file, 0 for metres. Throws as read_character, and Error(mismatch) for another
  // character.
  LinearBlend(const std::filesystem::path& path, const Basis& basis, double unit);
  explicit LinearBlend(Character character) : character_(std::move(character)) {}

  const Character& character() const { return character_; }
  // O x 3, the output vertices, metres, world.
  std::vector<float> skin(const Pose& pose) const;

 private:
  Character character_;
};

}  // namespace bodyopt
