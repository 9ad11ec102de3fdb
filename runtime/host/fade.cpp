#include "runtime/host/fade.h"

#include <algorithm>

namespace bodyopt {
namespace {

// Sums, over the nine features of a joint, the squared distances from their ranges.
double squared_excess(const ResidualTable& residual, std::size_t joint, std::span<const float> joint_features) {
  double sum = 0;
  for (std::size_t k = 9 * joint; k < 9 * joint + 9; ++k) {
    const FeatureRange& range = residual.features[k];
    const double x{joint_features[k]};
    const double outside = std::max({0.0, double{range.low} - x, x - double{range.high}});
    sum += outside * outside;
  }
  return sum;
}

}  // namespace

std::vector<double> joints_off(const ResidualTable& residual, std::span<const float> joint_features,
                               std::vector<double> off) {
  const FadeTable& fade = residual.fade;
  off.resize(fade.tolerance.size());
  const float* row = fade.directions.data();
  for (std::size_t j = 0; j < off.size(); ++j) {
    double sum = squared_excess(residual, j, joint_features);
    for (std::uint32_t d = fade.direction_begin[j]; d < fade.direction_begin[j + 1]; ++d) {
      double along = 0;
      for (std::uint32_t n = fade.joint_begin[j]; n < fade.joint_begin[j + 1]; ++n) {
        const std::size_t first = std::size_t{9} * fade.joints[n];
        for (std::size_t k = 0; k < 9; ++k) along += double{*row++} * double{joint_features[first + k]};
      }
      sum += along * along;
    }
    off[j] = std::max(0.0, sum - double{fade.tolerance[j]});
  }
  return off;
}

std::vector<float> region_fades(const ResidualTable& residual, std::span<const float> joint_features) {
  std::vector<float> fades(residual.regions.size());
  region_fades(residual, joints_off(residual, joint_features), fades);
  return fades;
}

void region_fades(const ResidualTable& residual, std::span<const double> joints_off, std::span<float> fades) {
  const FadeTable& fade = residual.fade;
  std::ranges::fill(fades, 1.0f);
  if (fade.empty()) return;
  for (std::size_t r = 0; r < fades.size(); ++r) {
    double sum = 1;
    for (std::uint32_t k = fade.region_begin[r]; k < fade.region_begin[r + 1]; ++k) {
      sum += double{fade.region_weights[k]} * joints_off[fade.region_joints[k]];
    }
    fades[r] = static_cast<float>(1 / sum);
  }
}

int fading_joint(const ResidualTable& residual, std::span<const double> joints_off, std::vector<double>& taken) {
  const FadeTable& fade = residual.fade;
  if (fade.empty()) return -1;
  taken.assign(fade.tolerance.size(), 0.0);
  for (std::size_t k = 0; k < fade.region_joints.size(); ++k) {
    taken[fade.region_joints[k]] += double{fade.region_weights[k]} * joints_off[fade.region_joints[k]];
  }
  const auto most = std::ranges::max_element(taken);
  return most != taken.end() && *most > 0 ? static_cast<int>(most - taken.begin()) : -1;
}

}  // namespace bodyopt
