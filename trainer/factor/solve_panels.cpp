#include "trainer/factor/factor_panels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trainer/factor/solve_panels.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::trainer::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// kSides neighbours of the kStride right sides, or part of them where registers are shorter.
template <int kStride, int kSides>
struct Sides {
  using Tag = hn::CappedTag<double, kSides>;
  using Side = hn::Vec<Tag>;
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(Tag()));

  static HWY_INLINE Side load(const double* values, int row) {
    return hn::LoadU(Tag(), values + kStride * std::ptrdiff_t{row});
  }
  static HWY_INLINE void store(Side side, double* values, int row) {
    hn::StoreU(side, Tag(), values + kStride * std::ptrdiff_t{row});
  }
  static HWY_INLINE Side scaled(Side side, double factor) { return hn::Mul(side, hn::Set(Tag(), factor)); }
  // A multiplication and a subtraction, each rounded: fused they would be others with other instructions.
  static HWY_INLINE Side without(Side from, double factor, Side side) { return hn::Sub(from, scaled(side, factor)); }

  template <int kWidth, typename Number>
  static HWY_INLINE void forward(const FactorPanels<Number>& factor, const FactorPanel& panel, double* values) {
    const Number* number = factor.values.data() + panel.first_value;
    Side own[kWidth];
    for (int k = 0; k < kWidth; ++k) {
      own[k] = load(values, panel.first + k);
      for (int i = 0; i < k; ++i) own[k] = without(own[k], static_cast<double>(*number++), own[i]);
      own[k] = scaled(own[k], factor.inverse_diagonal[static_cast<std::size_t>(panel.first + k)]);
      store(own[k], values, panel.first + k);
    }
    for (int r = panel.row_begin; r < panel.row_end; ++r, number += kWidth) {
      const int row = factor.rows[static_cast<std::size_t>(r)];
      Side other = load(values, row);
      for (int k = 0; k < kWidth; ++k) other = without(other, static_cast<double>(number[k]), own[k]);
      store(other, values, row);
    }
  }

  template <int kWidth, typename Number>
  static HWY_INLINE void backward(const FactorPanels<Number>& factor, const FactorPanel& panel, double* values) {
    const Number* const triangle = factor.values.data() + panel.first_value;
    const Number* number = triangle + kWidth * (kWidth - 1) / 2;
    Side own[kWidth];
    for (int k = 0; k < kWidth; ++k) own[k] = load(values, panel.first + k);
    for (int r = panel.row_begin; r < panel.row_end; ++r, number += kWidth) {
      const Side other = load(values, factor.rows[static_cast<std::size_t>(r)]);
      for (int k = 0; k < kWidth; ++k) own[k] = without(own[k], static_cast<double>(number[k]), other);
    }
    for (int k = kWidth; k-- > 0;) {
      for (int i = k + 1; i < kWidth; ++i) {
        own[k] = without(own[k], static_cast<double>(triangle[i * (i - 1) / 2 + k]), own[i]);
      }
      own[k] = scaled(own[k], factor.inverse_diagonal[static_cast<std::size_t>(panel.first + k)]);
      store(own[k], values, panel.first + k);
    }
  }
};

// Calls `solve` with the panel's width as a constant, for its columns to stay in registers.
template <int kWidth = 1, typename Solve>
HWY_INLINE void with_width(int width, const Solve& solve) {
  if constexpr (kWidth < FactorPanels<float>::kWidest) {
    if (width > kWidth) return with_width<kWidth + 1>(width, solve);
  }
  solve.template operator()<kWidth>();
}

template <int kStride, int kSides, typename Number>
HWY_INLINE void panel_forward(const FactorPanels<Number>& factor, const FactorPanel& panel, double* values) {
  using Some = Sides<kStride, kSides>;
  for (int side = 0; side < kSides; side += Some::kLanes) {
    with_width(panel.width,
               [&]<int kWidth>() HWY_ATTR { Some::template forward<kWidth>(factor, panel, values + side); });
  }
}

template <int kStride, int kSides, typename Number>
HWY_INLINE void panel_backward(const FactorPanels<Number>& factor, const FactorPanel& panel, double* values) {
  using Some = Sides<kStride, kSides>;
  for (int side = 0; side < kSides; side += Some::kLanes) {
    with_width(panel.width,
               [&]<int kWidth>() HWY_ATTR { Some::template backward<kWidth>(factor, panel, values + side); });
  }
}

void forward_all(const FactorPanels<float>& factor, double* values) {
  for (const FactorPanel& panel : factor.panels) panel_forward<4, 4>(factor, panel, values);
}

void backward_all(const FactorPanels<float>& factor, double* values) {
  for (std::size_t p = factor.panels.size(); p-- > 0;) panel_backward<4, 4>(factor, factor.panels[p], values);
}

void ten_in(const FactorPanels<double>& factor, const std::vector<int>& panels, double* values) {
  for (const int p : panels) {
    const FactorPanel& panel = factor.panels[static_cast<std::size_t>(p)];
    panel_forward<10, 8>(factor, panel, values);
    panel_forward<10, 2>(factor, panel, values + 8);
  }
  for (std::size_t k = panels.size(); k-- > 0;) {
    const FactorPanel& panel = factor.panels[static_cast<std::size_t>(panels[k])];
    panel_backward<10, 8>(factor, panel, values);
    panel_backward<10, 2>(factor, panel, values + 8);
  }
}

}  // namespace bodyopt::trainer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::trainer {

HWY_EXPORT(forward_all);
HWY_EXPORT(backward_all);
HWY_EXPORT(ten_in);

void solve_forward(const FactorPanels<float>& factor, double* values) {
  HWY_DYNAMIC_DISPATCH(forward_all)(factor, values);
}
void solve_backward(const FactorPanels<float>& factor, double* values) {
  HWY_DYNAMIC_DISPATCH(backward_all)(factor, values);
}
void solve_ten_in(const FactorPanels<double>& factor, const std::vector<int>& panels, double* values) {
  HWY_DYNAMIC_DISPATCH(ten_in)(factor, panels, values);
}

}  // namespace bodyopt::trainer
#endif
