// The dense products of the block inverse, on the way up (rows of panels) and down (by columns), in lanes (lanes.h).
#if defined(BODYOPT_LANE_PANEL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BODYOPT_LANE_PANEL_H
#undef BODYOPT_LANE_PANEL_H
#else
#define BODYOPT_LANE_PANEL_H
#endif

#include "runtime/basis/dynamics.h"
#include "runtime/cpu/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// kBlockSize numbers.
struct Rows {
  Lanes groups[kBlockSize / kLaneCount];

  HWY_INLINE Rows() {
    for (Lanes& group : groups) group = 0.0f;
  }
  HWY_INLINE Lanes& operator[](std::uint32_t row) { return groups[row / kLaneCount]; }
};

// sums += column * factor.
HWY_INLINE void add_product(const float* column, Lanes factor, Rows& sums) {
  for (std::uint32_t row = 0; row < kBlockSize; row += kLaneCount) sums[row] += load_lanes(column + row) * factor;
}

// Sums of a panel's rows, in the order of kSumParts. inputs: of every column.
HWY_INLINE void panel_product(const InversePanel& panel, const float* values, const float* inputs,
                              float (&sums)[kBlockSize]) {
  static_assert(kSumParts == 4);
  const float* columns = values + panel.first_value;
  Rows parts[kSumParts];
  const std::uint32_t whole = panel.input_count - panel.input_count % kSumParts;
  for (std::uint32_t c = 0; c < whole; c += kSumParts) {
    for (std::uint32_t p = 0; p < kSumParts; ++p) add_product(columns + (c + p) * kBlockSize, inputs[c + p], parts[p]);
  }
  for (std::uint32_t c = whole; c < panel.input_count; ++c) {
    add_product(columns + c * kBlockSize, inputs[c], parts[c - whole]);
  }
  for (std::uint32_t row = 0; row < kBlockSize; row += kLaneCount) {
    store_lanes((parts[0][row] + parts[1][row]) + (parts[2][row] + parts[3][row]), sums + row);
  }
}

// Halves added, as said at kSumParts.
HWY_INLINE float sum_of_halves(Rows& rows) {
  float values[kBlockSize];
  for (std::uint32_t row = 0; row < kBlockSize; row += kLaneCount) store_lanes(rows[row], values + row);
  for (std::uint32_t half = kBlockSize / 2; half > 0; half /= 2) {
    for (std::uint32_t k = 0; k < half; ++k) values[k] += values[k + half];
  }
  return values[0];
}

// RowCount: a number, or a type that is one: the sums of a whole strip then stay in registers.
template <typename RowCount>
HWY_INLINE void strip_product_of(RowCount row_count, const InverseStrip& strip, const float* values,
                                 const float* inputs, float (&sums)[kBlockSize]) {
  Rows parts[kBlockSize];
  for (std::uint32_t k = 0; k < strip.input_count; k += kBlockSize) {
    const float* columns = values + strip.first_value + k / kBlockSize * strip.panel_step;
    for (std::uint32_t lane = 0; lane < kBlockSize; lane += kLaneCount) {
      const Lanes input = load_lanes(inputs + k + lane);
      for (std::uint32_t row = 0; row < row_count; ++row) {
        parts[row][lane] += load_lanes(columns + row * kBlockSize + lane) * input;
      }
    }
  }
  for (std::uint32_t row = 0; row < row_count; ++row) sums[row] = sum_of_halves(parts[row]);
}

// Sums of a strip's rows, in the order said at kSumParts. inputs: at its boundary slots, up to the next multiple of
// kBlockSize (with zeros).
HWY_INLINE void strip_product(const InverseStrip& strip, const float* values, const float* inputs,
                              float (&sums)[kBlockSize]) {
  if (strip.row_count == kBlockSize) {
    strip_product_of(std::integral_constant<std::uint32_t, kBlockSize>(), strip, values, inputs, sums);
  } else {
    strip_product_of(strip.row_count, strip, values, inputs, sums);
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
