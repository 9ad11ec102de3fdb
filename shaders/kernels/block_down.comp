#version 450
#extension GL_GOOGLE_include_directive : require
// Block inverse, down: a workgroup multiplies one strip, kBlockSize rows by kBlockSize parts of the sum. Semantics:
// runtime/cpu/dynamics_kernels.h.
#include "layout.h"

// Threads: kWorkgroupSize * push.strip_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { BlockDownPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { InverseStrip strips[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float values[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint slot_unknown[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float results[]; };
// Two bindings of one buffer: a level reads unknowns of the levels above it alone, and writes its own.
layout(set = 0, binding = 4) readonly buffer B4 { float solutions_above[]; };
layout(set = 0, binding = 5) writeonly buffer B5 { float solutions[]; };

#include "right_side.glsl"

// A lane has one part of the sum of several rows, so that a workgroup reads values side by side.
const uint kRowStep = kWorkgroupSize / kBlockSize;
const uint kLaneRows = kBlockSize / kRowStep;

// kBlockSize parts per row, and one number that is not used, so that the rows' first parts are not in one bank.
const uint kRowParts = kBlockSize + 1u;
shared float part_sums[kBlockSize * kRowParts];

void main() {
  InverseStrip strip = strips[push.first_strip + gl_WorkGroupID.x];
  uint lane = gl_LocalInvocationID.x, part = lane % kBlockSize, first_row = lane / kBlockSize;
  uint from = strip.first_value - push.first_value + part;
  precise float parts[kLaneRows];
  for (uint r = 0; r < kLaneRows; ++r) parts[r] = 0.0;
  for (uint k = part; k < strip.input_count; k += kBlockSize) {
    float boundary = solutions_above[right_side_at(gl_WorkGroupID.y, slot_unknown[strip.first_input + k])];
    for (uint r = 0; r < kLaneRows; ++r) {
      uint row = first_row + r * kRowStep;
      if (row < strip.row_count) parts[r] += values[from + row * kBlockSize] * boundary;
    }
    from += strip.panel_step;
  }
  for (uint r = 0; r < kLaneRows; ++r) part_sums[(first_row + r * kRowStep) * kRowParts + part] = parts[r];
  barrier();
  if (lane >= strip.row_count) return;
  precise float sums[kBlockSize];
  for (uint p = 0; p < kBlockSize; ++p) sums[p] = part_sums[lane * kRowParts + p];
  for (uint width = kBlockSize / 2; width > 0; width /= 2) {
    for (uint p = 0; p < width; ++p) sums[p] += sums[p + width];
  }
  uint slot = strip.first_slot + lane;
  precise float solution = results[gl_WorkGroupID.y * push.slot_count + slot] - sums[0];
  solutions[right_side_at(gl_WorkGroupID.y, slot_unknown[slot])] = solution;
}
