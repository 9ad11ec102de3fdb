#include <algorithm>

#include "runtime/core/half.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {
namespace {

using Sums = float[3][kBlockSize];

void add_entry(const BlendEntry& entry, float coefficient, Sums& sums) {
  const float weight = coefficient * (half_low(entry.scale_coefficient) * kBlendFraction);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t lane = 0; lane < kBlockSize; ++lane) {
      const std::uint32_t word = entry.numbers[i * kLaneWords + lane / 4];
      sums[i][lane] += weight * static_cast<float>(static_cast<std::int8_t>(word >> 8 * (lane % 4)));
    }
  }
}

}  // namespace

void residual_blend(const ResidualTable& residual, std::span<const float> coefficients, std::uint32_t frame_count,
                    float weight, std::span<float> displacements) {
  const std::size_t count = residual.coefficient_count(), blocks = residual.blend_begin.size() - 1;
  const std::size_t vertices = frame_count == 0 ? 0 : displacements.size() / (std::size_t{3} * frame_count);
  for (std::size_t f = 0; f < frame_count; ++f) {
    for (std::size_t block = 0; block < blocks; ++block) {
      Sums sums = {};
      for (std::uint32_t e = residual.blend_begin[block]; e < residual.blend_begin[block + 1]; ++e) {
        const BlendEntry& entry = residual.blend[e];
        add_entry(entry, coefficients[f * count + (entry.scale_coefficient >> 16)], sums);
      }
      const std::size_t first = block * kBlockSize, lanes = std::min<std::size_t>(kBlockSize, vertices - first);
      float* to = displacements.data() + 3 * (f * vertices + first);
      for (std::size_t k = 0; k < 3 * lanes; ++k) to[k] = weight * sums[k % 3][k / 3];
    }
  }
}

}  // namespace bodyopt::cpu
