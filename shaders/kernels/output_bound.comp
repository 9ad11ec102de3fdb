#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: boxes around triangles. Semantics: runtime/cpu/kernels.h.
#include "fold.h"
#include "layout.h"

// Threads: push.box_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputBoundPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint triangles[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float positions[]; };
layout(set = 0, binding = 2) writeonly buffer B2 { float boxes[]; };

void main() {
  uint box = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y, small = small_box_count(push.triangle_count);
  if (box >= push.box_count) return;
  uint x = 3 * push.vertex_count * frame, at = 6 * (push.box_count * frame + box);
  bool is_large = box >= small;
  uint corners = 3 * kBoxTriangles * (is_large ? kLargeBox : 1), begin = corners * (is_large ? box - small : box);
  uint end = min(begin + corners, 3 * push.triangle_count);
  for (uint i = 0; i < 3; ++i) {
    float low = positions[x + 3 * triangles[begin] + i], high = low;
    for (uint k = begin + 1; k < end; ++k) {
      float value = positions[x + 3 * triangles[k] + i];
      low = min(low, value);
      high = max(high, value);
    }
    boxes[at + i] = low;
    boxes[at + 3 + i] = high;
  }
}
