// What of a character never changes: shared by all that evaluate it.
#pragma once

#include <memory>
#include <optional>

#include "runtime/basis/basis.h"
#include "runtime/basis/dynamics.h"

namespace bodyopt {

struct CharacterModel {
  Basis basis;
  std::optional<Dynamics> dynamics;  // of the basis; none: nothing jiggles
};

// Validates both. Throws Error(file).
std::shared_ptr<const CharacterModel> make_character_model(Basis basis,
                                                           std::optional<Dynamics> dynamics = std::nullopt);

}  // namespace bodyopt
