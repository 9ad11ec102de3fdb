#include "trainer/train/pack/blend_entry.h"

#include <algorithm>
#include <cmath>

#include "runtime/core/half.h"

namespace bodyopt {
namespace {

// Half whose numbers reach 127 at the largest component. Not a subnormal one, which a device may read as 0.
std::uint32_t blend_scale(double largest) {
  const double scale = largest / (127 * double{kBlendFraction});
  return std::max(kSmallestNormalHalf, half_from_float(static_cast<float>(scale)));
}

}  // namespace

// Numbers are rounded with the scale as it is stored. Its own rounding, 2^-11 at most, cannot lift them to 127.5.
PackedEntry pack_entry(const BlockVectors& vectors, std::uint32_t coefficient) {
  const std::uint32_t scale = blend_scale(vectors.cwiseAbs().maxCoeff());
  const double step = double{float_from_half(scale)} * double{kBlendFraction};
  PackedEntry packed{{scale | coefficient << 16, {}}, vectors};
  for (std::uint32_t k = 0; k < 3 * kBlockSize; ++k) {
    const std::uint32_t row = k / kBlockSize, lane = k % kBlockSize;
    const double number = std::nearbyint(vectors(row, lane) / step);
    packed.entry.numbers[k / 4] |= (static_cast<std::uint32_t>(static_cast<int>(number)) & 0xffu) << 8 * (k % 4);
    packed.left(row, lane) -= number * step;
  }
  return packed;
}

}  // namespace bodyopt
