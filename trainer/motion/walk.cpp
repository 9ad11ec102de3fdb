#include "trainer/motion/walk.h"

#include <algorithm>
#include <cmath>

namespace bodyopt {

double largest_change(const Angles& from, const Angles& to) {
  double largest = 0;
  for (std::size_t k = 0; k < from.size(); ++k) largest = std::max(largest, std::abs(to[k] - from[k]));
  return largest;
}

double largest_change(const Posture& from, const Posture& to) {
  double largest = largest_change(from.angles, to.angles);
  const auto deviation = [](const Posture& posture, std::size_t j) {
    return j < posture.deviations.size() ? posture.deviations[j] : Vec3{};
  };
  for (std::size_t j = 0; j < std::max(from.deviations.size(), to.deviations.size()); ++j) {
    largest = std::max(largest, length(deviation(to, j) - deviation(from, j)));
  }
  return largest;
}

std::size_t steps_between(const Angles& from, const Angles& to, double step) {
  return static_cast<std::size_t>(std::ceil(largest_change(from, to) / step - 1e-9));
}

void walk(const Angles& from, const Angles& to, double step, std::vector<Angles>& frames) {
  const std::size_t steps = steps_between(from, to, step);
  for (std::size_t s = 1; s < steps; ++s) {
    const double t = static_cast<double>(s) / static_cast<double>(steps);
    Angles between(from.size());
    for (std::size_t k = 0; k < from.size(); ++k) between[k] = from[k] + t * (to[k] - from[k]);
    frames.push_back(between);
  }
  if (steps > 0) frames.push_back(to);
}

}  // namespace bodyopt
