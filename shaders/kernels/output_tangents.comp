#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: tangents of the output vertices, where the host program wants them. Semantics: runtime/cpu/kernels.h.
#include "layout.h"
#include "tangent.h"

// Threads: push.output_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputTangentsPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { TangentVertex vertices[]; };
layout(set = 0, binding = 1) readonly buffer B1 { TangentCorner corners[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float positions[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float normals[]; };
layout(set = 0, binding = 4) writeonly buffer B4 { float tangents[]; };

void main() {
  uint output_number = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (output_number >= push.output_count) return;
  TangentVertex vertex = vertices[output_number];
  uint x = 3 * push.vertex_count * frame, a = x + 3 * vertex.vertex;
  float n[3], sum[4] = float[4](0.0, 0.0, 0.0, 0.0), tangent[3];
  for (uint i = 0; i < 3; ++i) n[i] = normals[a + i];
  for (uint k = vertex.corner_begin; k < vertex.corner_end; ++k) {
    TangentCorner corner = corners[k];
    uint b = x + 3 * corner.b, c = x + 3 * corner.c;
    float to_b[3], to_c[3];
    for (uint i = 0; i < 3; ++i) {
      to_b[i] = positions[b + i] - positions[a + i];
      to_c[i] = positions[c + i] - positions[a + i];
    }
    add_corner(corner, n, to_b, to_c, sum);
  }
  vertex_tangent(sum, tangent);
  uint to = push.first_word + frame * push.frame_words + output_number * push.element_words;
  for (uint i = 0; i < 3; ++i) tangents[to + i] = tangent[i];
  tangents[to + 3] = vertex.sign;
}
