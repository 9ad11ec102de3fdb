#include "runtime/cpu/vertex_frames.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/vertex_frames.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lane_ddm.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// Those of a group of lanes cost as much as one: what was found of a few groups is kept.
struct KnownGroup {
  std::uint32_t group = kNoSlot;
  float numbers[12][kLaneCount];
};

void find_group(const DdmTable& ddm, std::uint32_t group, const float* skinning, KnownGroup& known) {
  const std::uint32_t first = group * kLaneCount;
  Lanes r[9], t[3];
  ddm_frames(ddm, first / kBlockSize, first % kBlockSize, skinning, load_vertices(&ddm.vertices[first]), r, t);
  for (int i = 0; i < 9; ++i) store_lanes(r[i], known.numbers[i]);
  for (int i = 0; i < 3; ++i) store_lanes(t[i], known.numbers[9 + i]);
  known.group = group;
}

void frames_of_groups(const DdmTable& ddm, std::span<const std::uint32_t> vertices, const float* skinning,
                      std::span<float> frames) {
  constexpr std::uint32_t kKept = 32;
  KnownGroup groups[kKept];
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const std::uint32_t group = vertices[k] / kLaneCount;
    KnownGroup& known = groups[group % kKept];
    if (known.group != group) find_group(ddm, group, skinning, known);
    for (std::size_t i = 0; i < 12; ++i) frames[12 * k + i] = known.numbers[i][vertices[k] % kLaneCount];
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(frames_of_groups);

void vertex_frames(const DdmTable& ddm, std::span<const std::uint32_t> vertices, const float* skinning,
                   std::span<float> frames) {
  HWY_DYNAMIC_DISPATCH(frames_of_groups)(ddm, vertices, skinning, frames);
}

}  // namespace bodyopt::cpu
#endif
