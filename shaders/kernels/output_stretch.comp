#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: how the skin moved around corners of points that meshes are attached to. Semantics:
// runtime/cpu/attach_kernels.h.
#include "attach.h"

// Threads: push.corner_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputStretchPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { AttachCorner corners[]; };
layout(set = 0, binding = 1) readonly buffer B1 { AttachFan fans[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float positions[]; };
layout(set = 0, binding = 3) writeonly buffer B3 { float stretches[]; };

void main() {
  uint number = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (number >= push.corner_count) return;
  AttachCorner corner = corners[number];
  uint x = 3 * push.vertex_count * frame, a = x + 3 * corner.vertex;
  float stretch[9] = float[9](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), normal[3] = float[3](0.0, 0.0, 0.0);
  for (uint k = corner.fan_begin; k < corner.fan_end; ++k) {
    AttachFan fan = fans[k];
    float to_b[3], to_c[3];
    for (uint i = 0; i < 3; ++i) {
      to_b[i] = positions[x + 3 * fan.b + i] - positions[a + i];
      to_c[i] = positions[x + 3 * fan.c + i] - positions[a + i];
    }
    add_fan(fan, to_b, to_c, stretch, normal);
  }
  finish_stretch(corner, normal, stretch);
  uint to = kStretchNumbers * (frame * push.corner_count + number);
  for (uint i = 0; i < kStretchNumbers; ++i) stretches[to + i] = stretch[i];
}
