// The small basis with one modifier of a type, whose components are random; and clips for it.
#pragma once

#include "runtime/modifiers/drive_modifiers.h"
#include "tests/support/random_tables.h"
#include "tests/support/small_basis.h"

namespace bodyopt::testing {

inline Basis with_modifier(const std::string& type, std::uint32_t components, std::vector<float> numbers) {
  Basis basis = small_basis();
  Random random(3);
  SkinModifier& modifier = basis.modifiers.stack.emplace_back();
  modifier.name = "shown";
  modifier.type = type;
  modifier.component_count = components;
  modifier.numbers = std::move(numbers);
  basis.modifiers.blend_begin.push_back(0);
  for (std::uint32_t first = 0; first < basis.mesh.vertex_count(); first += kBlockSize) {
    const std::uint32_t lanes = std::min(kBlockSize, basis.mesh.vertex_count() - first);
    for (std::uint32_t k = 0; k < components; ++k) {
      basis.modifiers.blend.push_back(random_blend_entry(random, 0.01, k, lanes));
    }
    basis.modifiers.blend_begin.push_back(static_cast<std::uint32_t>(basis.modifiers.blend.size()));
  }
  return basis;
}

// The small basis breathes litre for litre, and its upper joint turns by a tenth of a radian per litre of the chest.
inline Basis breathing_basis() {
  Basis basis = with_modifier("breathing", 2, {1});
  basis.modifiers.stack[0].turns = {{1, 0, 0.1f, 0, 0}};
  return basis;
}

inline std::vector<Pose> bind_poses(const Basis& basis, std::size_t count) {
  return std::vector<Pose>(count, bind_pose(basis.skeleton));
}

// Gives each pose one more control.
inline void add_channel(std::vector<Pose>& poses, const std::vector<float>& values) {
  for (std::size_t f = 0; f < poses.size(); ++f) poses[f].controls.push_back(values[f]);
}

inline double litres(const Pose& pose) {
  return static_cast<double>(pose.modifiers[0]) + static_cast<double>(pose.modifiers[1]);
}

}  // namespace bodyopt::testing
