// A character that breathes.
#pragma once

#include <algorithm>

#include "runtime/basis/basis.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {

// Gives the basis a breath over the modifiers that it has: its skin is moved at random, up to a centimetre or so, its
// second joint turned, litre for litre.
inline SkinModifier& add_breathing(Basis& basis) {
  SkinModifiers all = basis.modifiers;
  const std::uint32_t first_component = all.component_count();
  all.stack.push_back({.name = "breath",
                       .type = "breathing",
                       .constants = {},
                       .first_component = first_component,
                       .component_count = 2,
                       .turns = {{1, 0, 0.1f, 0, 0}},
                       .joints = {},
                       .numbers = {1}});
  all.blend.clear();
  all.blend_begin = {0};
  Random random(3);
  const std::vector<std::uint32_t>& begin = basis.modifiers.blend_begin;
  for (std::uint32_t first = 0; first < basis.mesh.vertex_count(); first += kBlockSize) {
    const std::size_t block = first / kBlockSize;
    if (block + 1 < begin.size()) {
      const auto from = basis.modifiers.blend.begin();
      all.blend.insert(all.blend.end(), from + begin[block], from + begin[block + 1]);
    }
    const std::uint32_t lanes = std::min(kBlockSize, basis.mesh.vertex_count() - first);
    for (std::uint32_t k = 0; k < 2; ++k) {
      all.blend.push_back(random_blend_entry(random, 0.01, first_component + k, lanes));
    }
    all.blend_begin.push_back(static_cast<std::uint32_t>(all.blend.size()));
  }
  basis.modifiers = all;
  return basis.modifiers.stack.back();
}

}  // namespace bodyopt::testing
