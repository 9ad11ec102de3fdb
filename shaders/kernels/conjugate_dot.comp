#version 450
#extension GL_GOOGLE_include_directive : require
// Quality mode: a scalar product, by one workgroup, in one order. Semantics: runtime/cpu/dynamics_kernels.h.
#include "layout.h"

// Threads: kWorkgroupSize
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { ConjugatePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { float a[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float b[]; };
layout(set = 0, binding = 2) writeonly buffer B2 { float sum[]; };

shared float parts[kWorkgroupSize];

void main() {
  uint lane = gl_LocalInvocationID.x;
  precise float part = 0.0;
  for (uint i = lane; i < push.count; i += kWorkgroupSize) part += a[i] * b[i];
  parts[lane] = part;
  for (uint half_size = kWorkgroupSize / 2; half_size > 0; half_size /= 2) {
    barrier();
    if (lane < half_size) parts[lane] += parts[lane + half_size];
  }
  if (lane == 0) sum[0] = parts[0];
}
