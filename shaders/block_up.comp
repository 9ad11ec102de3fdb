#version 450
#extension GL_GOOGLE_include_directive : require
// Block inverse, up, second half: a workgroup multiplies one panel. Semantics: runtime/cpu/dynamics_kernels.h.
#include "layout.h"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { BlockUpPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { InversePanel panels[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float values[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float gathered[]; };
layout(set = 0, binding = 3) writeonly buffer B3 { float results[]; };

uint first_input;
float panel_input(uint c) { return gathered[first_input + c]; }

#include "panel_product.glsl"

void main() {
  InversePanel panel = panels[push.first_panel + gl_WorkGroupID.x];
  uint lane = gl_LocalInvocationID.x, first = gl_WorkGroupID.y * push.slot_count;
  first_input = first + panel.first_input;
  precise float sum = panel_product(panel, lane);
  if (lane >= panel.row_count) return;
  uint slot = first + panel.first_slot + lane;
  if (panel.first_slot >= push.own_end) sum = gathered[slot] + sum;
  results[slot] = sum;
}
