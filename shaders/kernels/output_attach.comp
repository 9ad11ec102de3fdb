#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: vertices of an attached mesh, where the host program wants them. Semantics:
// runtime/cpu/attach_kernels.h.
#include "attach.h"

// Threads: push.vertex_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputAttachPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { AttachVertex vertices[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float frames[]; };
layout(set = 0, binding = 2) writeonly buffer B2 { float attached[]; };

void main() {
  uint number = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (number >= push.vertex_count) return;
  AttachVertex vertex = vertices[push.first_vertex + number];
  uint at = kAnchorNumbers * (frame * push.anchor_count + vertex.anchor);
  uint to = push.first_word + frame * push.frame_words + number * push.element_words;
  for (uint i = 0; i < 3; ++i) {
    uint row = at + 3 * i;
    precise float away = frames[row] * vertex.x + frames[row + 1] * vertex.y + frames[row + 2] * vertex.z;
    attached[to + i] = frames[at + 9 + i] + away;
  }
}
