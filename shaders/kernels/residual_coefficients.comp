#version 450
#extension GL_GOOGLE_include_directive : require
// Residual stage: c = fade (W [1, coordinates, kernels] of a region, less the coefficients at rest). Semantics:
// runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.coefficient_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { ResidualCoefficientsPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { Region regions[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint coefficient_region[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float weights[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float rest_coefficients[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float coordinates[]; };
layout(set = 0, binding = 5) readonly buffer B5 { float kernels[]; };
layout(set = 0, binding = 6) readonly buffer B6 { float fades[]; };
layout(set = 0, binding = 7) writeonly buffer B7 { float coefficients[]; };

void main() {
  uint c = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (c >= push.coefficient_count) return;
  uint r = coefficient_region[c];
  Region region = regions[r];
  uint coordinate = push.coordinate_count * frame + region.coordinate_begin;
  uint phi = push.centre_count * frame + region.centre_begin;
  uint row =
      region.weight_values + (c - region.coefficient_begin) * (1 + region.coordinate_count + region.centre_count);
  precise float sum = weights[row];
  for (uint k = 0; k < region.coordinate_count; ++k) sum += weights[row + 1 + k] * coordinates[coordinate + k];
  row += 1 + region.coordinate_count;
  for (uint m = 0; m < region.centre_count; ++m) sum += weights[row + m] * kernels[phi + m];
  precise float away = sum - rest_coefficients[c];
  coefficients[frame * push.coefficient_count + c] = fades[frame * push.region_count + r] * away;
}
