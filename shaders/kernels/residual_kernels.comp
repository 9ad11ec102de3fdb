#version 450
#extension GL_GOOGLE_include_directive : require
// Residual stage: Gaussian kernels of a region's coordinates around training frames. Semantics: runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.centre_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { ResidualKernelsPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { Region regions[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint centre_region[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint centres[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float coordinates[]; };
layout(set = 0, binding = 4) writeonly buffer B4 { float kernels[]; };

void main() {
  uint m = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (m >= push.centre_count) return;
  Region region = regions[centre_region[m]];
  uint coordinate = push.coordinate_count * frame + region.coordinate_begin;
  uint row_words = (region.coordinate_count + 1) / 2;
  uint centre = region.centre_values + (m - region.centre_begin) * row_words;
  precise float distance2 = 0.0;
  for (uint k = 0; k < region.coordinate_count; ++k) {
    float value = unpackHalf2x16(centres[centre + k / 2] >> 16 * (k % 2)).x;
    precise float difference = coordinates[coordinate + k] - value;
    distance2 += difference * difference;
  }
  kernels[frame * push.centre_count + m] = exp(-(distance2 * region.inverse_width2));
}
