// The lanes of a block, side by side in the registers of whatever instructions the processor has. A kernel in lanes is
// compiled once for each set of them, in a namespace of its own: hwy/foreach_target.h includes its source again.
// Highway chooses when the program runs. All give the same bits: a lane knows nothing of its neighbours, and a multiply
// and an add stay two roundings.
//
// A kernel is written for one group of lanes, kLaneCount of the 16; its caller goes over the groups of a block.
#if defined(BODYOPT_LANES_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BODYOPT_LANES_H
#undef BODYOPT_LANES_H
#else
#define BODYOPT_LANES_H
#endif

#include "hwy/highway.h"
#include "shaders/include/layout.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using LaneTag = hn::CappedTag<float, kBlockSize>;
using LaneWordTag = hn::RebindToUnsigned<LaneTag>;
using LaneWords = hn::Vec<LaneWordTag>;
inline constexpr std::uint32_t kLaneCount = hn::MaxLanes(LaneTag());
static_assert(kBlockSize % kLaneCount == 0);

struct LaneMask {
  hn::Mask<LaneTag> bits;
  friend HWY_INLINE bool any_of(LaneMask mask) { return !hn::AllFalse(LaneTag(), mask.bits); }
};

// A float in each lane, for functions that are written for one (shaders/include/one_source.h).
struct Lanes {
  hn::Vec<LaneTag> values;

  HWY_INLINE Lanes() = default;
  HWY_INLINE Lanes(float value) : values(hn::Set(LaneTag(), value)) {}
  HWY_INLINE explicit Lanes(hn::Vec<LaneTag> of) : values(of) {}

  friend HWY_INLINE Lanes operator+(Lanes a, Lanes b) { return Lanes(hn::Add(a.values, b.values)); }
  friend HWY_INLINE Lanes operator-(Lanes a, Lanes b) { return Lanes(hn::Sub(a.values, b.values)); }
  friend HWY_INLINE Lanes operator*(Lanes a, Lanes b) { return Lanes(hn::Mul(a.values, b.values)); }
  friend HWY_INLINE Lanes operator/(Lanes a, Lanes b) { return Lanes(hn::Div(a.values, b.values)); }
  friend HWY_INLINE Lanes operator-(Lanes a) { return Lanes(hn::Neg(a.values)); }
  HWY_INLINE Lanes& operator+=(Lanes b) { return *this = *this + b; }
  HWY_INLINE Lanes& operator-=(Lanes b) { return *this = *this - b; }
  HWY_INLINE Lanes& operator*=(Lanes b) { return *this = *this * b; }
  friend HWY_INLINE LaneMask operator>(Lanes a, Lanes b) { return {hn::Gt(a.values, b.values)}; }
  friend HWY_INLINE LaneMask operator<(Lanes a, Lanes b) { return {hn::Lt(a.values, b.values)}; }
  friend HWY_INLINE Lanes select(LaneMask mask, Lanes yes, Lanes no) {
    return Lanes(hn::IfThenElse(mask.bits, yes.values, no.values));
  }
  friend HWY_INLINE Lanes abs(Lanes a) { return Lanes(hn::Abs(a.values)); }
  friend HWY_INLINE Lanes sqrt(Lanes a) { return Lanes(hn::Sqrt(a.values)); }
  friend HWY_INLINE Lanes min(Lanes a, Lanes b) { return Lanes(hn::Min(a.values, b.values)); }
  friend HWY_INLINE Lanes max(Lanes a, Lanes b) { return Lanes(hn::Max(a.values, b.values)); }
};

HWY_INLINE Lanes load_lanes(const float* from) { return Lanes(hn::LoadU(LaneTag(), from)); }
HWY_INLINE void store_lanes(Lanes lanes, float* to) { hn::StoreU(lanes.values, LaneTag(), to); }

HWY_INLINE LaneWords load_lane_words(const std::uint32_t* from) { return hn::LoadU(LaneWordTag(), from); }
HWY_INLINE Lanes lanes_from_bits(LaneWords words) { return Lanes(hn::BitCast(LaneTag(), words)); }

// The halves of words (runtime/core/half.h), which are finite. A half's exponent and mantissa at a float's place are
// 2^-112 of its value.
HWY_INLINE Lanes lanes_from_high_halves(LaneWords words) {
  const hn::RebindToSigned<LaneTag> with_sign;
  const auto spread = hn::BitCast(LaneWordTag(), hn::ShiftRight<3>(hn::BitCast(with_sign, words)));
  return lanes_from_bits(hn::And(spread, hn::Set(LaneWordTag(), 0x8fffe000u))) * 0x1p112f;
}
HWY_INLINE Lanes lanes_from_low_halves(LaneWords words) { return lanes_from_high_halves(hn::ShiftLeft<16>(words)); }

// Rows of a table whose words stand row after row, a row to a lane: `count` rows from `first` on, the last repeated.
struct LaneRows {
  hn::Vec<hn::RebindToSigned<LaneTag>> offsets;

  HWY_INLINE LaneRows(std::uint32_t first, std::uint32_t count, std::size_t row_words) {
    const hn::RebindToSigned<LaneTag> tag;
    const auto rows = hn::Iota(tag, static_cast<std::int32_t>(first));
    const auto row = hn::Min(rows, hn::Set(tag, static_cast<std::int32_t>(count) - 1));
    offsets = hn::Mul(row, hn::Set(tag, static_cast<std::int32_t>(row_words)));
  }

  // The word, or float, of each row that stands where `table` points in the first.
  HWY_INLINE LaneWords words(const std::uint32_t* table) const {
    return hn::GatherIndex(LaneWordTag(), table, offsets);
  }
  HWY_INLINE Lanes floats(const float* table) const { return Lanes(hn::GatherIndex(LaneTag(), table, offsets)); }
};

// The first `count` lanes, if there are as many.
HWY_INLINE void store_some_lanes(Lanes lanes, std::size_t count, float* to) {
  float values[kLaneCount];
  store_lanes(lanes, values);
  for (std::size_t k = 0; k < count && k < kLaneCount; ++k) to[k] = values[k];
}

// x, y, z of one after the other.
HWY_INLINE void load_points(const float* from, Lanes (&points)[3]) {
  hn::LoadInterleaved3(LaneTag(), from, points[0].values, points[1].values, points[2].values);
}
HWY_INLINE void store_points(const Lanes (&points)[3], float* to) {
  hn::StoreInterleaved3(points[0].values, points[1].values, points[2].values, LaneTag(), to);
}

// Records of eight floats.
HWY_INLINE void load_octets(const float* from, Lanes (&words)[8]) {
#if HWY_TARGET == HWY_SCALAR
  for (std::uint32_t k = 0; k < 8; ++k) words[k] = from[k];
#else
  for (std::uint32_t half = 0; half < 2; ++half) {
    Lanes w[4];
    hn::LoadInterleaved4(LaneTag(), from + 4 * half * kLaneCount, w[0].values, w[1].values, w[2].values, w[3].values);
    for (std::uint32_t k = 0; k < 4; ++k) words[4 * half + k] = w[k];
  }
  for (std::uint32_t k = 0; k < 4; ++k) {  // words k and k + 4 stand in turn
    const auto low = words[k].values, high = words[4 + k].values;
    words[k].values = hn::ConcatEven(LaneTag(), high, low);
    words[4 + k].values = hn::ConcatOdd(LaneTag(), high, low);
  }
#endif
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
