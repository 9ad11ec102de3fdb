// What of a character never changes: shared by all that evaluate it.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "runtime/basis/basis.h"
#include "runtime/basis/dynamics.h"
#include "runtime/host/fold_tables.h"

namespace bodyopt {

struct CharacterModel {
  CharacterModel(Basis of, std::optional<Dynamics> jiggling)
      : basis(std::move(of)), dynamics(std::move(jiggling)), folds(fold_tables(basis)) {}

  Basis basis;
  std::optional<Dynamics> dynamics;  // of the basis; none: nothing jiggles
  FoldTables folds;                  // of the basis
};

// Validates both. Throws Error(file).
std::shared_ptr<const CharacterModel> make_character_model(Basis basis,
                                                           std::optional<Dynamics> dynamics = std::nullopt);

}  // namespace bodyopt
