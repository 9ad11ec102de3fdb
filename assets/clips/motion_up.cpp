#include "assets/clips/motion_up.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bodyopt {
namespace {

// The mean of all frames; shorter than 1 where they differ.
Vec3 mean_up(std::span<const SourceFrame> frames, std::span<const BonePair> bones) {
  Vec3 up{0, 0, 0};
  double whole = std::numeric_limits<double>::min();
  for (const SourceFrame& frame : frames) {
    for (const BonePair& pair : bones) {
      const Vec3 bone = frame.bone(pair);
      if (!(length(bone) > 0)) continue;
      up = up + (pair.skeleton[1] / length(bone)) * bone;
      whole += std::abs(pair.skeleton[1]);
    }
  }
  return (1 / whole) * up;
}

// How far the height of the lowest joint varies, RMS, file units.
double unevenness(std::span<const SourceFrame> frames, std::span<const BonePair> bones, const Vec3& up) {
  double sum = 0, squares = 0;
  for (const SourceFrame& frame : frames) {
    double lowest = std::numeric_limits<double>::max();
    for (const BonePair& pair : bones) lowest = std::min(lowest, dot(up, frame.place(pair.source_joint)));
    sum += lowest;
    squares += lowest * lowest;
  }
  const auto count = static_cast<double>(frames.size());
  return std::sqrt(std::max(0.0, squares / count - sum * sum / count / count));
}

}  // namespace

std::optional<Vec3> named_axis(const std::string& name) {
  const bool is_down = name.starts_with('-');
  const std::size_t axis = std::string("xyz").find(name.substr(is_down ? 1 : 0));
  if (name.size() != (is_down ? 2 : 1) || axis == std::string::npos) return std::nullopt;
  Vec3 up{0, 0, 0};
  up[axis] = is_down ? -1 : 1;
  return up;
}

std::string name_of_axis(const Vec3& axis) {
  for (const char* name : {"x", "y", "z", "-x", "-y"}) {
    if (dot(*named_axis(name), axis) > 0.5) return name;
  }
  return "-z";
}

Vec3 up_of_motion(std::span<const SourceFrame> frames, std::span<const BonePair> bones,
                  const std::optional<Vec3>& rest_up, std::vector<std::string>& notes) {
  constexpr double kWeak = 0.4, kTravel = 0.03;  // of the length of all bones
  const Vec3 y{0, 1, 0}, mean = mean_up(frames, bones), by_rest = rest_up.value_or(y);
  Vec3 by_body = y;
  for (const char* name : {"z", "-z", "x", "-x", "-y"}) {
    if (const Vec3 axis = *named_axis(name); dot(axis, mean) > dot(by_body, mean)) by_body = axis;
  }
  if (by_body == by_rest || !(dot(by_body, mean) > kWeak)) return by_rest;
  const bool trusts_body = by_body == y || !rest_up;
  const Vec3 &likely = trusts_body ? by_body : by_rest, &other = trusts_body ? by_rest : by_body;
  double size = 0;
  for (const BonePair& pair : bones) size += length(frames[0].bone(pair));
  const double uneven = unevenness(frames, bones, likely);
  const Vec3& up = uneven > kTravel * size && unevenness(frames, bones, other) < 0.25 * uneven ? other : likely;
  if (rest_up || up != by_body) {
    notes.push_back("The body stands along " + name_of_axis(by_body) + ", " +
                    (rest_up ? "and with all rotations zero along " + name_of_axis(by_rest) : "or lies") + ": " +
                    name_of_axis(up) + " was taken to be up (--up says otherwise).");
  }
  return up;
}

}  // namespace bodyopt
