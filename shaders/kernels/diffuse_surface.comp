#version 450
#extension GL_GOOGLE_include_directive : require
// Diffuse stage: where the skin carries the nodes that lie on it, relative to the frame's origin. Semantics:
// runtime/cpu/dynamics_kernels.h.
#include "layout.h"

// Threads: push.surface_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { DiffuseSurfacePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { SurfacePoint surface[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float positions[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float origins[]; };
layout(set = 0, binding = 3) writeonly buffer B3 { float nodes[]; };

void main() {
  uint node = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (node >= push.surface_count) return;
  SurfacePoint point = surface[node];
  uint x = 3 * push.vertex_count * frame;
  uint at = 3 * (frame * push.node_count + node);
  for (uint i = 0; i < 3; ++i) {
    float origin = origins[4 * frame + i];
    precise float value = point.wa * (positions[x + 3 * point.a + i] - origin) +
                          point.wb * (positions[x + 3 * point.b + i] - origin) +
                          point.wc * (positions[x + 3 * point.c + i] - origin);
    nodes[at + i] = value;
  }
}
