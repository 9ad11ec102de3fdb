#version 450
#extension GL_GOOGLE_include_directive : require
// Residual stage: the coordinates of a region, p = P f. Semantics: runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.coordinate_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { ResidualProjectPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { Region regions[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint region_features[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint coordinate_region[]; };
layout(set = 0, binding = 3) readonly buffer B3 { uint projections[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float features[]; };
layout(set = 0, binding = 5) writeonly buffer B5 { float coordinates[]; };

void main() {
  uint c = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (c >= push.coordinate_count) return;
  Region region = regions[coordinate_region[c]];
  uint feature = push.feature_count * frame;
  uint row_words = (region.feature_count + 1) / 2;
  uint row = region.projection_values + (c - region.coordinate_begin) * row_words;
  precise float sum = 0.0;
  for (uint k = 0; k < region.feature_count; ++k) {
    float value = unpackHalf2x16(projections[row + k / 2] >> 16 * (k % 2)).x;
    sum += value * features[feature + region_features[region.feature_begin + k]];
  }
  coordinates[frame * push.coordinate_count + c] = sum;
}
