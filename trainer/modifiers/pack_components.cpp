#include "trainer/modifiers/pack_components.h"

#include <algorithm>

#include "trainer/train/pack/blend_entry.h"

namespace bodyopt {
namespace {

constexpr double kNegligible = 1e-6;  // metres

BlockVectors block_of(const Positions& component, Eigen::Index first) {
  const Eigen::Index lanes = std::min<Eigen::Index>(kBlockSize, component.rows() - first);
  BlockVectors vectors = BlockVectors::Zero();
  vectors.leftCols(lanes) = component.middleRows(first, lanes).transpose();
  return vectors;
}

}  // namespace

void pack_components(const std::vector<Positions>& components, std::uint32_t vertex_count, SkinModifiers& modifiers) {
  modifiers.blend.clear();
  modifiers.blend_begin = {0};
  for (Eigen::Index first = 0; first < vertex_count; first += kBlockSize) {
    for (std::uint32_t k = 0; k < components.size(); ++k) {
      BlockVectors left = block_of(components[k], first);
      for (int entry = 0; entry < 2 && left.cwiseAbs().maxCoeff() > kNegligible; ++entry) {
        const PackedEntry packed = pack_entry(left, k);
        modifiers.blend.push_back(packed.entry);
        left = packed.left;
      }
    }
    modifiers.blend_begin.push_back(static_cast<std::uint32_t>(modifiers.blend.size()));
  }
}

}  // namespace bodyopt
