#include <algorithm>

#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void residual_features(std::span<const FeatureRange> ranges, std::span<const float> joint_features,
                       std::span<const float> strains, std::span<const float> controls, std::uint32_t frame_count,
                       std::span<float> features, std::span<float> excess) {
  const std::size_t count = ranges.size();
  if (count == 0 || frame_count == 0) return;
  const std::size_t strain_count = strains.size() / frame_count, control_count = controls.size() / frame_count;
  const std::size_t joint_count = count - strain_count - control_count;
  for (std::size_t f = 0; f < frame_count; ++f) {
    for (std::size_t k = 0; k < count; ++k) {
      float raw;
      if (k < joint_count) {
        raw = joint_features[f * joint_count + k];
      } else if (k < joint_count + strain_count) {
        raw = strains[f * strain_count + (k - joint_count)];
      } else {
        raw = controls[f * control_count + (k - joint_count - strain_count)];
      }
      const FeatureRange& range = ranges[k];
      const float inside = std::min(std::max(raw, range.low), range.high);
      features[f * count + k] = (inside - range.mean) * range.inverse_scale;
      excess[f * count + k] = std::max(range.low - raw, raw - range.high) > 0
                                  ? std::max(range.low - raw, raw - range.high) * range.inverse_scale
                                  : 0.0f;
    }
  }
}

}  // namespace bodyopt::cpu
