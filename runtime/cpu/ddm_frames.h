// Frames of Direct Delta Mush: a vertex stands at t + R (d + delta d). Where more than one thing is done with them they
// are found once; pose_skin has the same bits of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt::cpu {

// Numbers of a block's frames: nine of R (row-major), three of t, of each those of all lanes side by side.
inline constexpr std::size_t kFrameNumbers = 12 * kBlockSize;

// Frames of as many blocks as `frames` holds, from first_block on, t relative to the frame's origin. Takes skinning J x
// 12 of the frame -> frames blocks x 12 x kBlockSize.
void block_frames(const DdmTable& ddm, const float* skinning, std::uint32_t first_block, std::span<float> frames);

// R (row-major) and t of each of the vertices -> frames P x 12.
void vertex_frames(const DdmTable& ddm, std::span<const std::uint32_t> vertices, const float* skinning,
                   std::span<float> frames);
// R and t of vertices 0, 1, ..., vertex_count - 1 -> V x 12.
std::vector<float> vertex_frames(const DdmTable& ddm, std::uint32_t vertex_count, const float* skinning);

}  // namespace bodyopt::cpu
