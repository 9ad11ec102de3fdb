// Half-precision words as GLSL's unpackHalf2x16 reads them.
#pragma once

#include <bit>
#include <cstdint>

namespace bodyopt {

// Exact for every half, also subnormal, infinite and NaN.
inline float float_from_half(std::uint32_t half) {
  const std::uint32_t sign = (half & 0x8000u) << 16, exponent = (half >> 10) & 31u, mantissa = half & 1023u;
  if (exponent == 0) {
    const float magnitude = static_cast<float>(mantissa) * 0x1p-24f;
    return sign ? -magnitude : magnitude;
  }
  if (exponent == 31) return std::bit_cast<float>(sign | 0x7f800000u | (mantissa << 13));
  return std::bit_cast<float>(sign | ((exponent + 112u) << 23) | (mantissa << 13));
}

// Round to nearest even; overflow gives infinity.
inline std::uint32_t half_from_float(float value) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = (bits >> 16) & 0x8000u, magnitude = bits & 0x7fffffffu;
  if (magnitude > 0x7f800000u) return sign | 0x7e00u;
  if (magnitude >= 0x477ff000u) return sign | 0x7c00u;
  if (magnitude < 0x38800000u) {  // subnormal: adding 0.5 lets the float adder round to multiples of 2^-24
    const float shifted = std::bit_cast<float>(magnitude) + 0.5f;
    return sign | (std::bit_cast<std::uint32_t>(shifted) - 0x3f000000u);
  }
  return sign | ((magnitude - 0x38000000u + 0xfffu + ((magnitude >> 13) & 1u)) >> 13);
}

// Smallest above 0 that no device reads as 0, and the largest.
inline constexpr std::uint32_t kSmallestNormalHalf = 0x0400, kLargestHalf = 0x7bff;

inline float half_low(std::uint32_t word) { return float_from_half(word & 0xffffu); }
inline float half_high(std::uint32_t word) { return float_from_half(word >> 16); }

}  // namespace bodyopt
