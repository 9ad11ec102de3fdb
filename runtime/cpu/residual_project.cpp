#include "runtime/cpu/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/residual_project.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// The coordinates of a region; features, coordinates: of the frame.
void project_lanes(const ResidualTable& residual, const Region& region, const float* features, float* coordinates) {
  const std::uint32_t* index = residual.region_features.data() + region.feature_begin;
  const std::uint32_t* first_row = residual.projections.data() + region.projection_values;
  for (std::uint32_t c = 0; c < region.coordinate_count; c += kLaneCount) {
    const LaneRows rows(c, region.coordinate_count, (region.feature_count + 1) / 2);
    Lanes sum = 0.0f;
    for (std::uint32_t k = 0; k < region.feature_count; k += 2) {
      const LaneWords words = rows.words(first_row + k / 2);
      sum += lanes_from_low_halves(words) * features[index[k]];
      if (k + 1 < region.feature_count) sum += lanes_from_high_halves(words) * features[index[k + 1]];
    }
    store_some_lanes(sum, region.coordinate_count - c, coordinates + region.coordinate_begin + c);
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(project_lanes);

void region_coordinates(const ResidualTable& residual, std::size_t region, const float* features, float* coordinates) {
  HWY_DYNAMIC_DISPATCH(project_lanes)(residual, residual.regions[region], features, coordinates);
}

void residual_project(const ResidualTable& residual, std::span<const float> features, std::uint32_t frame_count,
                      std::span<float> coordinates) {
  for (std::size_t f = 0; f < frame_count; ++f) {
    for (std::size_t r = 0; r < residual.regions.size(); ++r) {
      region_coordinates(residual, r, features.data() + f * residual.feature_count(),
                         coordinates.data() + f * residual.coordinate_count());
    }
  }
}

}  // namespace bodyopt::cpu
#endif
