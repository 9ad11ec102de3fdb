// A basis of random tables, and batches of frames for it.
#pragma once

#include <cstdint>
#include <memory>

#include "runtime/basis/skin_modifiers.h"
#include "runtime/host/backend.h"
#include "runtime/host/character_model.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {

inline constexpr std::uint32_t kBasisJoints = 6, kBasisVertices = 501;

// A basis of random tables. The backends read tables only, so that its parts need not belong to one shape.
Basis random_basis(std::uint32_t fibres, std::uint32_t coefficients);

// The basis with a stack of as many components, two to a modifier.
Basis with_random_modifiers(Basis basis, std::uint32_t components);

// With kRelax or kPushOut on top, whose folds hold all skin.
Basis with_on_top(Basis basis, const PosedSkinType& type);

// The basis need not be sound.
std::shared_ptr<const CharacterModel> model_of(const Basis& basis);

Batch random_batch(const Basis& basis, std::uint32_t frames);

}  // namespace bodyopt::testing
