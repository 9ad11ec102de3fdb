// How attached meshes follow the skin: one function per kernel, one file each; the reference for the Vulkan kernels.
// Arrays are of one frame.
#pragma once

#include <cstddef>
#include <span>

namespace bodyopt {
struct AttachTables;
}

namespace bodyopt::cpu {

// Output stage: how the skin moved around each corner of points. positions V x 3 -> stretches C x 9, row-major.
void output_stretch(const AttachTables& tables, std::span<const float> positions, std::span<float> stretches);

// Output stage: how each anchor turns, and where it is. `positions`: V x 3, world; `skinning`: J x 12, relative to
// `origin` (three numbers). -> frames K x 12: R, row-major, and then c.
void output_anchor(const AttachTables& tables, std::span<const float> stretches, std::span<const float> positions,
                   std::span<const float> skinning, const float* origin, std::span<float> frames);

// Output stage: vertices of a mesh, those from first_vertex of all on, as many as attached holds. -> x 3, world.
void output_attach(const AttachTables& tables, std::size_t first_vertex, std::span<const float> frames,
                   std::span<float> attached);

}  // namespace bodyopt::cpu
