// Interpolates keyed poses and cameras between their frames.
#pragma once

#include <iterator>
#include <map>

#include "shots/session/view_settings.h"

namespace bodyopt {

// The share of the way to the next key after a share of the time.
inline double eased(KeyEase ease, double x) {
  if (ease == KeyEase::smooth) return x * x * (3 - 2 * x);
  return ease == KeyEase::linear ? x : 0;
}

// Blends two cameras, `t` from 0 to 1, the short way about. Projection and cutting away are those of the first.
CameraKey blended(const CameraKey& a, const CameraKey& b, double t);
inline CameraKey eased_between(const CameraKey& a, const CameraKey& b, double x) {
  return blended(a, b, eased(a.ease, x));
}

// Interpolates the keys at a frame; frames before the first key and after the last take that key. There must be a key.
// `Key` has a function eased_between(a, b, x), x the share of the time from a to b.
template <typename Key>
Key between_keys(const std::map<int, Key>& keys, int frame) {
  const auto after = keys.lower_bound(frame);
  if (after == keys.begin() || (after != keys.end() && after->first == frame)) return after->second;
  const auto before = std::prev(after);
  if (after == keys.end()) return before->second;
  const double x = (static_cast<double>(frame) - before->first) / (static_cast<double>(after->first) - before->first);
  return eased_between(before->second, after->second, x);
}

}  // namespace bodyopt
