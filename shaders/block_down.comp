#version 450
#extension GL_GOOGLE_include_directive : require
// Block inverse, down: a workgroup multiplies one panel. Semantics: runtime/cpu/dynamics_kernels.h.
#include "layout.h"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { BlockDownPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { InversePanel panels[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float values[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint slot_unknown[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float results[]; };
layout(set = 0, binding = 4) buffer B4 { float solutions[]; };

#include "right_side.glsl"

uint first_input;
float panel_input(uint c) { return solutions[right_side_at(gl_WorkGroupID.y, slot_unknown[first_input + c])]; }

#include "panel_product.glsl"

void main() {
  InversePanel panel = panels[push.first_panel + gl_WorkGroupID.x];
  uint lane = gl_LocalInvocationID.x;
  first_input = panel.first_input;
  precise float sum = panel_product(panel, lane);
  if (lane >= panel.row_count) return;
  uint slot = panel.first_slot + lane;
  precise float solution = results[gl_WorkGroupID.y * push.slot_count + slot] - sum;
  solutions[right_side_at(gl_WorkGroupID.y, slot_unknown[slot])] = solution;
}
