#include "runtime/cpu/panel_product.h"

#include <cstring>

#ifdef __x86_64__
#define BODYOPT_ANY_WIDTH __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define BODYOPT_ANY_WIDTH
#endif

namespace bodyopt::cpu {
namespace {

// A number per row of a panel, which the compiler keeps in vector registers.
using Rows = float __attribute__((vector_size(kBlockSize * sizeof(float))));

// In tables, which are aligned as their numbers are and no more. (Of a vector's type that says so, clang forgets it.)
struct __attribute__((packed, may_alias)) StoredRows {
  Rows rows;
};

}  // namespace

BODYOPT_ANY_WIDTH void panel_product(const InversePanel& panel, const float* values, const float* inputs,
                                     float (&sums)[kBlockSize]) {
  static_assert(kSumParts == 4);
  const auto* columns = reinterpret_cast<const StoredRows*>(values + panel.first_value);
  Rows parts[kSumParts] = {};
  const std::uint32_t whole = panel.input_count - panel.input_count % kSumParts;
  for (std::uint32_t c = 0; c < whole; c += kSumParts) {
    parts[0] += columns[c].rows * inputs[c];
    parts[1] += columns[c + 1].rows * inputs[c + 1];
    parts[2] += columns[c + 2].rows * inputs[c + 2];
    parts[3] += columns[c + 3].rows * inputs[c + 3];
  }
  for (std::uint32_t c = whole; c < panel.input_count; ++c) parts[c - whole] += columns[c].rows * inputs[c];
  const Rows sum = (parts[0] + parts[1]) + (parts[2] + parts[3]);
  std::memcpy(sums, &sum, sizeof sums);
}

BODYOPT_ANY_WIDTH void strip_product(const InverseStrip& strip, const float* values, const float* inputs,
                                     float (&sums)[kBlockSize]) {
  Rows parts[kBlockSize] = {};
  for (std::uint32_t k = 0; k < strip.input_count; k += kBlockSize) {
    const auto* rows =
        reinterpret_cast<const StoredRows*>(values + strip.first_value + k / kBlockSize * strip.panel_step);
    const Rows input = reinterpret_cast<const StoredRows*>(inputs + k)->rows;
    for (std::uint32_t row = 0; row < strip.row_count; ++row) parts[row] += rows[row].rows * input;
  }
  for (std::uint32_t row = 0; row < strip.row_count; ++row) {
    for (std::uint32_t half = kBlockSize / 2; half > 0; half /= 2) {
      for (std::uint32_t lane = 0; lane < half; ++lane) parts[row][lane] += parts[row][lane + half];
    }
    sums[row] = parts[row][0];
  }
}

}  // namespace bodyopt::cpu
