#include "trainer/simulate/muscle_fibres.h"

#include <algorithm>

#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

constexpr double kFullShortening = 0.2;
constexpr double kSeriesStrain = 0.04;  // of tendon and aponeurosis at the largest force

}  // namespace

double rest_length(const Muscle& muscle) {
  double total = 0;
  for (std::size_t k = 0; k + 1 < muscle.path.size(); ++k) {
    total += length(muscle.path[k + 1].position - muscle.path[k].position);
  }
  return total;
}

double path_length(const Muscle& muscle, std::span<const Affine> skinning) {
  double total = 0;
  for (std::size_t k = 0; k + 1 < muscle.path.size(); ++k) {
    const MusclePoint &a = muscle.path[k], &b = muscle.path[k + 1];
    total += length(skinning[b.joint] * b.position - skinning[a.joint] * a.position);
  }
  return total;
}

std::vector<FibreDrive> fibre_drives(const std::vector<Muscle>& muscles, std::span<const double> bellies,
                                     std::span<const Affine> skinning, double least_slack) {
  std::vector<FibreDrive> drives;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    const double rest = rest_length(muscles[m]), belly = bellies[m] > 0 ? bellies[m] : rest;
    if (!(rest > 0)) {
      drives.push_back({0, 1});
      continue;
    }
    const double shorter = std::max(rest - path_length(muscles[m], skinning), 0.0);
    const double u = std::min(shorter / rest / kFullShortening, 1.0);
    const double slack = std::max(1 - (shorter + kSeriesStrain * rest) / belly, least_slack);
    drives.push_back({muscles[m].max_activation * u * u * (3 - 2 * u), slack});
  }
  return drives;
}

bool matches_pattern(const std::string& pattern, const std::string& name) {
  if (!pattern.ends_with('*')) return name == pattern;
  return name.starts_with(std::string_view(pattern).substr(0, pattern.size() - 1));
}

std::vector<std::vector<std::size_t>> flexed_muscles(const std::vector<std::string>& controls,
                                                     const std::vector<Muscle>& muscles) {
  std::vector<std::vector<std::size_t>> flexed;
  for (const std::string& control : controls) {
    std::vector<std::size_t>& found = flexed.emplace_back();
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      if (matches_pattern(control, muscles[m].name)) found.push_back(m);
    }
    if (found.empty()) {
      throw Error(ErrorKind::mismatch, "the control '" + control + "' flexes none of the " +
                                           std::to_string(muscles.size()) +
                                           " muscles: expected a muscle's name, or the beginning of some and '*'");
    }
  }
  return flexed;
}

}  // namespace bodyopt::trainer
