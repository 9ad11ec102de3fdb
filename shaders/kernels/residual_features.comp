#version 450
#extension GL_GOOGLE_include_directive : require
// Residual stage: joint features, strains and controls, clamped to the trained range and standardised; and how far
// outside that range they were. Semantics: runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.joint_feature_count + push.strain_count + push.control_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { ResidualFeaturesPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { FeatureRange ranges[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float joint_features[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float strains[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float controls[]; };
layout(set = 0, binding = 4) writeonly buffer B4 { float features[]; };
layout(set = 0, binding = 5) writeonly buffer B5 { float excess[]; };

void main() {
  uint feature_count = push.joint_feature_count + push.strain_count + push.control_count;
  uint k = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (k >= feature_count) return;
  float raw;
  if (k < push.joint_feature_count) {
    raw = joint_features[frame * push.joint_feature_count + k];
  } else if (k < push.joint_feature_count + push.strain_count) {
    raw = strains[frame * push.strain_count + (k - push.joint_feature_count)];
  } else {
    raw = controls[frame * push.control_count + (k - push.joint_feature_count - push.strain_count)];
  }
  FeatureRange range = ranges[k];
  float inside = raw < range.low ? range.low : raw;
  inside = inside > range.high ? range.high : inside;
  float below = range.low - raw, above = raw - range.high;
  float outside = below > above ? below : above;
  features[frame * feature_count + k] = (inside - range.mean) * range.inverse_scale;
  excess[frame * feature_count + k] = outside > 0.0 ? outside * range.inverse_scale : 0.0;
}
