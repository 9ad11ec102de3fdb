#version 450
#extension GL_GOOGLE_include_directive : require
// Lines of the host: skeletons, axes, edges of tetrahedra.
#include "view.glsl"
#include "thick_line.glsl"

layout(push_constant) uniform Push {
  View view;
  vec4 offset;  // world
  vec2 half_width;
  uint orthographic;
};

struct Point {
  float x, y, z;
  uint colour;  // sRGB and alpha, red lowest
};
layout(std430, set = 0, binding = 0) readonly buffer Points { Point points[]; };  // two per line

layout(location = 0) out vec4 out_colour;

vec3 position(uint k) { return to_camera(view, vec3(points[k].x, points[k].y, points[k].z) + offset.xyz); }

void main() {
  const uint line = gl_VertexIndex / 6, corner = gl_VertexIndex % 6;
  const vec4 colour = unpackUnorm4x8(points[2 * line + (corner == 1 || corner == 2 || corner == 4 ? 1 : 0)].colour);
  out_colour = vec4(pow(colour.rgb, vec3(2.2)), colour.a);
  gl_Position = thick_line(view, position(2 * line), position(2 * line + 1), orthographic != 0, half_width, corner);
}
