#version 450
#extension GL_GOOGLE_include_directive : require
// Block inverse, up, first half: what every slot of a level starts from. Semantics: runtime/cpu/dynamics_kernels.h.
#include "layout.h"

// Threads: push.end_slot - push.first_slot
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { BlockGatherPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint slot_unknown[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint child_slots[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float right_sides[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float results[]; };
layout(set = 0, binding = 4) writeonly buffer B4 { float gathered[]; };

#include "right_side.glsl"

void main() {
  uint slot = push.first_slot + gl_GlobalInvocationID.x, right_side = gl_GlobalInvocationID.y;
  if (slot >= push.end_slot) return;
  uint first = right_side * push.slot_count;
  precise float sum = 0.0;
  for (uint k = 0; k < 2; ++k) {
    uint child = child_slots[2 * slot + k];
    if (child != kNoSlot) sum += results[first + child];
  }
  if (slot < push.own_end) sum = right_sides[right_side_at(right_side, slot_unknown[slot])] - sum;
  gathered[first + slot] = sum;
}
