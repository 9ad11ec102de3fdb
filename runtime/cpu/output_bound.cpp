#include <algorithm>

#include "runtime/cpu/kernels.h"
#include "shaders/include/fold.h"

namespace bodyopt::cpu {
namespace {

void bound_corners(const float* x, std::span<const std::uint32_t> corners, float* box) {
  for (std::size_t i = 0; i < 3; ++i) {
    float low = x[3 * std::size_t{corners[0]} + i], high = low;
    for (const std::uint32_t corner : corners.subspan(1)) {
      const float value = x[3 * std::size_t{corner} + i];
      low = std::min(low, value);
      high = std::max(high, value);
    }
    box[i] = low;
    box[3 + i] = high;
  }
}

void bound_boxes(std::span<const float> boxes, float* box) {
  std::copy_n(boxes.data(), 6, box);
  for (std::size_t at = 6; at < boxes.size(); at += 6) {
    for (std::size_t i = 0; i < 3; ++i) {
      box[i] = std::min(box[i], boxes[at + i]);
      box[3 + i] = std::max(box[3 + i], boxes[at + 3 + i]);
    }
  }
}

template <typename Value>
std::span<const Value> part(std::span<const Value> values, std::size_t number, std::size_t size) {
  return values.subspan(number * size, std::min(size, values.size() - number * size));
}

}  // namespace

void output_bound(std::span<const std::uint32_t> triangles, const OutputBoundPush& push,
                  std::span<const float> positions, std::span<float> boxes) {
  const std::size_t numbers = std::size_t{3} * push.vertex_count, all = std::size_t{6} * push.box_count;
  const std::size_t count = small_box_count(push.triangle_count), small = 6 * count;
  for (std::size_t frame = 0; frame * all < boxes.size(); ++frame) {
    const std::span<float> own = boxes.subspan(frame * all, all);
    for (std::size_t box = 0; box < count; ++box) {
      bound_corners(&positions[numbers * frame], part(triangles, box, 3 * kBoxTriangles), &own[6 * box]);
    }
    for (std::size_t at = small; at < all; at += 6) {
      bound_boxes(part(std::span<const float>(own.first(small)), (at - small) / 6, 6 * kLargeBox), &own[at]);
    }
  }
}

}  // namespace bodyopt::cpu
