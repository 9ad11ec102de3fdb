#version 450
#extension GL_GOOGLE_include_directive : require
// Muscle fibres on a skin that is on the device, a little above it.
#include "layout.h"
#include "view.glsl"
#include "thick_line.glsl"

layout(push_constant) uniform Push {
  View view;
  vec4 offset_lift;  // world; how far above the skin, metres
  vec2 half_width;
  uint orthographic;
};

struct Segment {
  uint from, to, fibre;  // points, and whose
};
layout(std430, set = 0, binding = 0) readonly buffer Segments { Segment segments[]; };
layout(std430, set = 0, binding = 1) readonly buffer Points { FibrePoint points[]; };  // of runtime vertices
layout(std430, set = 0, binding = 2) readonly buffer Positions { float positions[]; };
layout(std430, set = 0, binding = 3) readonly buffer Normals { float normals[]; };
layout(std430, set = 0, binding = 4) readonly buffer Colours { uint colours[]; };  // of the fibres, as in view_line

layout(location = 0) out vec4 out_colour;

vec3 lifted(uint vertex) {
  const uint at = 3 * vertex;
  return vec3(positions[at], positions[at + 1], positions[at + 2]) +
         offset_lift.w * vec3(normals[at], normals[at + 1], normals[at + 2]);
}

vec3 position(uint k) {
  const FibrePoint p = points[k];
  return to_camera(view, p.wa * lifted(p.a) + p.wb * lifted(p.b) + p.wc * lifted(p.c) + offset_lift.xyz);
}

void main() {
  const Segment segment = segments[gl_VertexIndex / 6];
  const vec4 colour = unpackUnorm4x8(colours[segment.fibre]);
  out_colour = vec4(pow(colour.rgb, vec3(2.2)), colour.a);
  gl_Position = thick_line(view, position(segment.from), position(segment.to), orthographic != 0, half_width,
                           gl_VertexIndex % 6);
}
