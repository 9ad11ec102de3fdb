// Frames of Direct Delta Mush of single vertices, with the bits that pose_skin has of them.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/basis/basis.h"

namespace bodyopt::cpu {

// R (row-major) and t, relative to the frame's origin, of each of the vertices: it stands at t + R (d + delta d).
// skinning: J x 12 of the frame -> frames P x 12. Quickest where vertices of one block stand side by side.
void vertex_frames(const DdmTable& ddm, std::span<const std::uint32_t> vertices, const float* skinning,
                   std::span<float> frames);

}  // namespace bodyopt::cpu
