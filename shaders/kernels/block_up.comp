#version 450
#extension GL_GOOGLE_include_directive : require
// Block inverse, up, second half: a workgroup multiplies one panel, kBlockSize rows by kSumParts parts of the sum.
// Semantics: runtime/cpu/dynamics_kernels.h.
#include "layout.h"

// Threads: kWorkgroupSize * push.panel_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { BlockUpPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { InversePanel panels[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float values[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float gathered[]; };
layout(set = 0, binding = 3) writeonly buffer B3 { float results[]; };

shared float part_sums[kWorkgroupSize];

void main() {
  InversePanel panel = panels[push.first_panel + gl_WorkGroupID.x];
  uint lane = gl_LocalInvocationID.x, row = lane % kBlockSize;
  uint first = gl_WorkGroupID.y * push.slot_count;
  uint column = panel.first_value - push.first_value + row;
  precise float part = 0.0;
  for (uint c = lane / kBlockSize; c < panel.input_count; c += kSumParts) {
    part += values[column + c * kBlockSize] * gathered[first + panel.first_input + c];
  }
  part_sums[lane] = part;
  barrier();
  if (lane >= panel.row_count) return;
  precise float low = part_sums[row] + part_sums[row + kBlockSize];
  precise float high = part_sums[row + 2 * kBlockSize] + part_sums[row + 3 * kBlockSize];
  precise float sum = low + high;
  uint slot = panel.first_slot + row;
  if (slot >= push.own_end) sum = gathered[first + slot] + sum;
  results[first + slot] = sum;
}
