#include "runtime/cpu/ddm_frames.h"

#include <numeric>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/ddm_frames.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lane_ddm.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

void frame_lanes(const DdmTable& ddm, const float* skinning, std::uint32_t block, std::span<float> frames) {
  for (std::size_t at = 0; at < frames.size(); at += kFrameNumbers, ++block) {
    for (std::uint32_t lane = 0; lane < kBlockSize; lane += kLaneCount) {
      Lanes r[9], t[3];
      ddm_frames(ddm, block, lane, skinning, load_vertices(&ddm.vertices[block * kBlockSize + lane]), r, t);
      store_frames(r, t, &frames[at + lane]);
    }
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(frame_lanes);

void block_frames(const DdmTable& ddm, const float* skinning, std::uint32_t first_block, std::span<float> frames) {
  HWY_DYNAMIC_DISPATCH(frame_lanes)(ddm, skinning, first_block, frames);
}

void vertex_frames(const DdmTable& ddm, std::span<const std::uint32_t> vertices, const float* skinning,
                   std::span<float> frames) {
  // The frames of a whole block cost as much as one of them: those of a few blocks are kept.
  struct KnownBlock {
    std::uint32_t block = kNoSlot;
    float numbers[kFrameNumbers];
  };
  constexpr std::uint32_t kKept = 32;
  KnownBlock blocks[kKept];
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const std::uint32_t block = vertices[k] / kBlockSize;
    KnownBlock& known = blocks[block % kKept];
    if (known.block != block) block_frames(ddm, skinning, block, known.numbers);
    known.block = block;
    for (std::size_t i = 0; i < 12; ++i) frames[12 * k + i] = known.numbers[i * kBlockSize + vertices[k] % kBlockSize];
  }
}

std::vector<float> vertex_frames(const DdmTable& ddm, std::uint32_t vertex_count, const float* skinning) {
  std::vector<std::uint32_t> vertices(vertex_count);
  std::iota(vertices.begin(), vertices.end(), 0U);
  std::vector<float> frames(12 * vertices.size());
  vertex_frames(ddm, vertices, skinning, frames);
  return frames;
}

}  // namespace bodyopt::cpu
#endif
