// What is keyed at frames, poses and cameras alike, as it is at others.
#pragma once

#include <iterator>
#include <map>

#include "shots/session/view_settings.h"

namespace bodyopt {

// As the key before eases; before the first and after the last as those. There must be a key. `Key` has an `ease`, and
// a function blended(a, b, t).
template <typename Key>
Key between_keys(const std::map<int, Key>& keys, int frame) {
  const auto after = keys.lower_bound(frame);
  if (after == keys.begin() || (after != keys.end() && after->first == frame)) return after->second;
  const auto before = std::prev(after);
  if (after == keys.end()) return before->second;
  const double x = (static_cast<double>(frame) - before->first) / (static_cast<double>(after->first) - before->first);
  const KeyEase ease = before->second.ease;
  return blended(before->second, after->second,
                 ease == KeyEase::smooth   ? x * x * (3 - 2 * x)
                 : ease == KeyEase::linear ? x
                                           : 0);
}

// From one camera to another, `t` from 0 to 1, the short way about. Without perspective, or cut away, as the first.
CameraKey blended(const CameraKey& a, const CameraKey& b, double t);

}  // namespace bodyopt
