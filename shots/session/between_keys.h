// Interpolates keyed poses and cameras between their frames.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>

#include "shots/session/view_settings.h"

namespace bodyopt::shots {

// The two keys around a frame, and those before and after them; null: there is none.
template <typename Key>
struct KeySpan {
  const Key* before = nullptr;
  const Key& a;
  const Key& b;
  const Key* after = nullptr;
  std::array<double, 3> frames{1, 1, 1};  // from each of the four to the next
  double x = 0;                           // the share of the time from a to b
};

// The share of the way to the next key after a share of the time. A spline's depends on the keys around.
inline double eased(KeyEase ease, double x) {
  if (ease == KeyEase::smooth || ease == KeyEase::spline) return x * x * (3 - 2 * x);
  return ease == KeyEase::linear ? x : 0;
}

// Values of a number at the keys of a span, and the eases of the ways to `a` and from `b`.
struct SplineValues {
  std::optional<double> before;  // none: the spline is flat at `a`
  double a, b;
  std::optional<double> after;
  KeyEase ease_before, ease_after;
};

// A cubic from a to b that goes no further than they do. At a key it has one tangent with the way on the other side:
// flat where the numbers turn, or that way is flat.
template <typename Key>
double spline_between(const SplineValues& values, const KeySpan<Key>& span) {
  const double own = (values.b - values.a) / span.frames[1];
  const auto slope = [&](std::optional<double> beyond, KeyEase ease) {
    const double other = beyond.value_or(0);
    if (own * other <= 0 || ease == KeyEase::smooth || ease == KeyEase::step) return 0.0;
    if (ease == KeyEase::spline) return 2 * own * other / (own + other);
    return std::abs(other) < 3 * std::abs(own) ? other : 3 * own;  // steeper, it would go beyond
  };
  std::optional<double> before, after;
  if (values.before) before = (values.a - *values.before) / span.frames[0];
  if (values.after) after = (*values.after - values.b) / span.frames[2];
  const double from = span.frames[1] * slope(before, values.ease_before),
               to = span.frames[1] * slope(after, values.ease_after);
  const double x = span.x, t = x * x * (3 - 2 * x);
  return std::lerp(values.a, values.b, t) + x * (1 - x) * ((1 - x) * from - x * to);
}

// Blends two cameras, `t` from 0 to 1, the short way about. Projection and cutting away are those of the first.
CameraKey blended(const CameraKey& a, const CameraKey& b, double t);
CameraKey eased_between(const KeySpan<CameraKey>& span);

// Interpolates the keys at a frame; frames before the first key and after the last take that key. There must be a key.
// `Key` has a function eased_between(KeySpan).
template <typename Key>
Key between_keys(const std::map<int, Key>& keys, int frame) {
  const auto b = keys.lower_bound(frame);
  if (b == keys.begin() || (b != keys.end() && b->first == frame)) return b->second;
  const auto a = std::prev(b);
  if (b == keys.end()) return a->second;
  const auto frames_between = [](auto from, auto to) { return static_cast<double>(to->first) - from->first; };
  KeySpan<Key> span{.a = a->second, .b = b->second};
  span.frames[1] = frames_between(a, b);
  span.x = (static_cast<double>(frame) - a->first) / span.frames[1];
  if (a != keys.begin()) {
    span.before = &std::prev(a)->second;
    span.frames[0] = frames_between(std::prev(a), a);
  }
  if (const auto after = std::next(b); after != keys.end()) {
    span.after = &after->second;
    span.frames[2] = frames_between(b, after);
  }
  return eased_between(span);
}

}  // namespace bodyopt::shots
