#include "trainer/simulate/factor_panels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trainer/simulate/solve_panels.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kSides = 4;  // right sides
using SideTag = hn::CappedTag<double, kSides>;
constexpr int kSideLanes = static_cast<int>(hn::MaxLanes(SideTag()));

// A row of right sides, or part of it where registers are shorter.
using Side = hn::Vec<SideTag>;

HWY_INLINE Side load(const double* values, int row) {
  return hn::LoadU(SideTag(), values + kSides * std::ptrdiff_t{row});
}
HWY_INLINE void store(Side side, double* values, int row) {
  hn::StoreU(side, SideTag(), values + kSides * std::ptrdiff_t{row});
}
// A multiplication and a subtraction, each rounded: fused they would be others with other instructions.
HWY_INLINE Side without(Side from, float factor, Side side) {
  return hn::Sub(from, hn::Mul(hn::Set(SideTag(), static_cast<double>(factor)), side));
}

template <int kWidth>
HWY_INLINE void forward(const FactorPanels& factor, const FactorPanel& panel, double* values) {
  const float* number = factor.values.data() + panel.first_value;
  Side own[kWidth];
  for (int k = 0; k < kWidth; ++k) {
    own[k] = load(values, panel.first + k);
    for (int i = 0; i < k; ++i) own[k] = without(own[k], *number++, own[i]);
    own[k] = hn::Mul(own[k], hn::Set(SideTag(), factor.inverse_diagonal[static_cast<std::size_t>(panel.first + k)]));
    store(own[k], values, panel.first + k);
  }
  for (int r = panel.row_begin; r < panel.row_end; ++r, number += kWidth) {
    const int row = factor.rows[static_cast<std::size_t>(r)];
    Side other = load(values, row);
    for (int k = 0; k < kWidth; ++k) other = without(other, number[k], own[k]);
    store(other, values, row);
  }
}

template <int kWidth>
HWY_INLINE void backward(const FactorPanels& factor, const FactorPanel& panel, double* values) {
  const float* const triangle = factor.values.data() + panel.first_value;
  const float* number = triangle + kWidth * (kWidth - 1) / 2;
  Side own[kWidth];
  for (int k = 0; k < kWidth; ++k) own[k] = load(values, panel.first + k);
  for (int r = panel.row_begin; r < panel.row_end; ++r, number += kWidth) {
    const Side other = load(values, factor.rows[static_cast<std::size_t>(r)]);
    for (int k = 0; k < kWidth; ++k) own[k] = without(own[k], number[k], other);
  }
  for (int k = kWidth; k-- > 0;) {
    for (int i = k + 1; i < kWidth; ++i) own[k] = without(own[k], triangle[i * (i - 1) / 2 + k], own[i]);
    own[k] = hn::Mul(own[k], hn::Set(SideTag(), factor.inverse_diagonal[static_cast<std::size_t>(panel.first + k)]));
    store(own[k], values, panel.first + k);
  }
}

// Calls `solve` with the panel's width as a constant, for its columns to stay in registers.
template <int kWidth = 1, typename Solve>
HWY_INLINE void with_width(int width, const Solve& solve) {
  if constexpr (kWidth < FactorPanels::kWidest) {
    if (width > kWidth) return with_width<kWidth + 1>(width, solve);
  }
  solve.template operator()<kWidth>();
}

void forward_all(const FactorPanels& factor, double* values) {
  for (const FactorPanel& panel : factor.panels) {
    for (int side = 0; side < kSides; side += kSideLanes) {
      with_width(panel.width, [&]<int kWidth>() HWY_ATTR { forward<kWidth>(factor, panel, values + side); });
    }
  }
}

void backward_all(const FactorPanels& factor, double* values) {
  for (std::size_t p = factor.panels.size(); p-- > 0;) {
    const FactorPanel& panel = factor.panels[p];
    for (int side = 0; side < kSides; side += kSideLanes) {
      with_width(panel.width, [&]<int kWidth>() HWY_ATTR { backward<kWidth>(factor, panel, values + side); });
    }
  }
}

}  // namespace bodyopt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt {

HWY_EXPORT(forward_all);
HWY_EXPORT(backward_all);

void solve_forward(const FactorPanels& factor, double* values) { HWY_DYNAMIC_DISPATCH(forward_all)(factor, values); }
void solve_backward(const FactorPanels& factor, double* values) { HWY_DYNAMIC_DISPATCH(backward_all)(factor, values); }

}  // namespace bodyopt
#endif
