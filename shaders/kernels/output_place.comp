#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: three numbers of each vertex go where the host program wants them. Semantics: runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.output_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputPlacePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint output_vertex[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float values[]; };
layout(set = 0, binding = 2) writeonly buffer B2 { float placed[]; };

void main() {
  uint output_number = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (output_number >= push.output_count) return;
  uint from = 3 * (frame * push.vertex_count + output_vertex[output_number]);
  uint to = push.first_word + frame * push.frame_words + output_number * push.element_words;
  for (uint i = 0; i < 3; ++i) placed[to + i] = values[from + i];
}
