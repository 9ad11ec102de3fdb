#include "runtime/host/character_model.h"

namespace bodyopt {

std::shared_ptr<const CharacterModel> make_character_model(Basis basis, std::optional<Dynamics> dynamics,
                                                           std::span<const float> texture) {
  validate(basis, "the basis");
  if (dynamics) validate(*dynamics, basis, "the dynamics");
  return std::make_shared<const CharacterModel>(std::move(basis), std::move(dynamics), texture);
}

}  // namespace bodyopt
