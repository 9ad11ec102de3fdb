#include <algorithm>

#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void output_bound(std::span<const std::uint32_t> triangles, const OutputBoundPush& push,
                  std::span<const float> positions, std::span<float> boxes) {
  const std::size_t numbers = std::size_t{3} * push.vertex_count;
  for (std::size_t at = 0; at < boxes.size(); at += 6) {
    const std::size_t frame = at / 6 / push.box_count, box = at / 6 % push.box_count;
    const std::size_t begin = 3 * kBoxTriangles * box, end = std::min(begin + 3 * kBoxTriangles, triangles.size());
    const float* x = &positions[numbers * frame];
    for (std::size_t i = 0; i < 3; ++i) {
      float low = x[3 * std::size_t{triangles[begin]} + i], high = low;
      for (std::size_t k = begin + 1; k < end; ++k) {
        const float value = x[3 * std::size_t{triangles[k]} + i];
        low = std::min(low, value);
        high = std::max(high, value);
      }
      boxes[at + i] = low;
      boxes[at + 3 + i] = high;
    }
  }
}

}  // namespace bodyopt::cpu
