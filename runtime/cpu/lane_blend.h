// The sums of a block's entries, in lanes: shared by residual_blend and modify_blend.
#if defined(BODYOPT_LANE_BLEND_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BODYOPT_LANE_BLEND_H
#undef BODYOPT_LANE_BLEND_H
#else
#define BODYOPT_LANE_BLEND_H
#endif

#include <span>

#include "runtime/core/half.h"
#include "runtime/cpu/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// A signed byte of each lane.
HWY_INLINE Lanes lanes_from_bytes(const std::int8_t* bytes) {
  const hn::Rebind<std::int8_t, LaneTag> narrow;
  const hn::RebindToSigned<LaneTag> wide;
  return Lanes(hn::ConvertTo(LaneTag(), hn::PromoteTo(wide, hn::LoadU(narrow, bytes))));
}

// Sums for the group of lanes that begins at `lane`. coefficients: of the frame.
HWY_INLINE void blend_entries(std::span<const BlendEntry> entries, std::uint32_t lane, const float* coefficients,
                              Lanes (&sums)[3]) {
  for (Lanes& sum : sums) sum = 0.0f;
  for (const BlendEntry& entry : entries) {
    const auto* bytes = reinterpret_cast<const std::int8_t*>(entry.numbers) + lane;
    const Lanes amount =
        coefficients[entry.scale_coefficient >> 16] * (half_low(entry.scale_coefficient) * kBlendFraction);
    for (std::uint32_t i = 0; i < 3; ++i) sums[i] += amount * lanes_from_bytes(bytes + i * kBlockSize);
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
