#version 450
#extension GL_GOOGLE_include_directive : require
// Strain stage: length of every fibre over its rest length, minus one. Semantics: runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.fibre_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { StrainMeasurePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { FibrePoint points[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint fibre_begin[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float rest_length[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float positions[]; };
layout(set = 0, binding = 4) writeonly buffer B4 { float strains[]; };

void main() {
  uint fibre = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (fibre >= push.fibre_count) return;
  uint x = 3 * push.strain_vertex_count * frame;
  uint begin = fibre_begin[fibre], end = fibre_begin[fibre + 1];
  precise float length = 0.0;
  precise float last[3] = float[3](0.0, 0.0, 0.0);
  for (uint p = begin; p < end; ++p) {
    FibrePoint point = points[p];
    precise float here[3];
    for (int i = 0; i < 3; ++i) {
      here[i] = point.wa * positions[x + 3 * point.a + i] + point.wb * positions[x + 3 * point.b + i] +
                point.wc * positions[x + 3 * point.c + i];
    }
    if (p > begin) {
      precise float dx = here[0] - last[0], dy = here[1] - last[1], dz = here[2] - last[2];
      precise float length2 = dx * dx + dy * dy + dz * dz;
      length += sqrt(length2);
    }
    for (int i = 0; i < 3; ++i) last[i] = here[i];
  }
  strains[frame * push.fibre_count + fibre] = (length - rest_length[fibre]) / rest_length[fibre];
}
