#include <algorithm>

#include "runtime/cpu/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/pose_skin.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lane_ddm.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// A block of one frame. skinning, origin: of the frame; frames: of the block, or null; displacements, positions:
// 3 x kBlockSize.
void pose_block(const DdmTable& ddm, std::uint32_t block, const float* skinning, const float* frames,
                const float* origin, const float* displacements, float* positions) {
  for (std::uint32_t lane = 0; lane < kBlockSize; lane += kLaneCount) {
    const LaneVertices v = load_vertices(&ddm.vertices[block * kBlockSize + lane]);
    Lanes r[9], t[3], delta[3], x[3];
    if (frames) {
      load_frames(frames + lane, r, t);
    } else {
      ddm_frames(ddm, block, lane, skinning, v, r, t);
    }
    load_points(displacements + 3 * lane, delta);
    ddm_positions(r, t, v, delta, x);
    for (int i = 0; i < 3; ++i) x[i] += origin[i];
    store_points(x, positions + 3 * lane);
  }
}

// Blocks from `block` on, as many as positions hold; the last may not be full.
void pose_lanes(const DdmTable& ddm, const float* skinning, const float* frames, const float* origin,
                std::uint32_t block, std::span<const float> displacements, std::span<float> positions) {
  constexpr std::size_t kNumbers = 3 * kBlockSize;
  std::size_t at = 0;
  for (; at + kNumbers <= positions.size(); at += kNumbers) {
    pose_block(ddm, block++, skinning, frames, origin, &displacements[at], &positions[at]);
    if (frames) frames += kFrameNumbers;
  }
  if (at == positions.size()) return;
  float delta[kNumbers] = {}, x[kNumbers];
  std::copy_n(&displacements[at], positions.size() - at, delta);
  pose_block(ddm, block, skinning, frames, origin, delta, x);
  std::copy_n(x, positions.size() - at, &positions[at]);
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(pose_lanes);

void pose_blocks(const DdmTable& ddm, const float* skinning, const float* frames, const float* origin,
                 std::uint32_t first_block, std::span<const float> displacements, std::span<float> positions) {
  HWY_DYNAMIC_DISPATCH(pose_lanes)(ddm, skinning, frames, origin, first_block, displacements, positions);
}

void pose_skin(const DdmTable& ddm, std::uint32_t joint_count, std::span<const float> skinning,
               std::span<const float> origins, std::span<const float> displacements, std::span<float> positions) {
  const std::size_t frames = origins.size() / 4;
  const std::size_t numbers = frames == 0 ? 0 : positions.size() / frames;
  for (std::size_t f = 0; f < frames; ++f) {
    pose_blocks(ddm, skinning.data() + f * 12 * joint_count, nullptr, &origins[4 * f], 0,
                displacements.subspan(f * numbers, numbers), positions.subspan(f * numbers, numbers));
  }
}

}  // namespace bodyopt::cpu
#endif
