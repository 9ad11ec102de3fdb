#include "shots/session/pose_keys.h"

#include <cmath>
#include <iterator>
#include <string>

namespace bodyopt {
namespace {

Vec3 blend_of(const Vec3& a, const Vec3& b, double t) { return (1 - t) * a + t * b; }
double blend_of(double a, double b, double t) { return std::lerp(a, b, t); }

// `whole`: what one side lacks is as the other has it; otherwise it is zero there.
template <typename Value>
std::map<std::string, Value> blend_of(const std::map<std::string, Value>& a, const std::map<std::string, Value>& b,
                                      double t, bool whole) {
  std::map<std::string, Value> blended;
  for (const auto& [name, value] : a) {
    const auto other = b.find(name);
    blended[name] = blend_of(value, other != b.end() ? other->second : whole ? value : Value{}, t);
  }
  for (const auto& [name, value] : b) {
    if (!a.contains(name)) blended[name] = blend_of(whole ? value : Value{}, value, t);
  }
  return blended;
}

}  // namespace

ViewSettings::PoseKey between_keys(const std::map<int, ViewSettings::PoseKey>& keys, int frame) {
  const auto after = keys.lower_bound(frame);
  if (after == keys.begin() || (after != keys.end() && after->first == frame)) return after->second;
  const auto before = std::prev(after);
  if (after == keys.end()) return before->second;
  const double x = (static_cast<double>(frame) - before->first) / (static_cast<double>(after->first) - before->first);
  const double t = x * x * (3 - 2 * x);
  const ViewSettings::PoseKey &a = before->second, &b = after->second;
  return {blend_of(a.joints, b.joints, t, false), blend_of(a.axes, b.axes, t, false),
          blend_of(a.controls, b.controls, t, true), blend_of(a.pins, b.pins, t, true)};
}

ViewSettings::Posing keyed_posing(ViewSettings::Posing posing, int frame) {
  if (!posing.keys.empty()) static_cast<ViewSettings::PoseKey&>(posing) = between_keys(posing.keys, frame);
  return posing;
}

}  // namespace bodyopt
