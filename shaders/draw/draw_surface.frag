#version 450
#extension GL_GOOGLE_include_directive : require
// Clay, or colours, in the studio.
#include "studio.glsl"

layout(push_constant) uniform Push {
  vec4 view[3];
  vec4 projection;
  uint kind;
  uint orthographic;
};
const uint kColoured = 1;
const uint kBackdrop = 2;

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec3 in_colour;
layout(location = 0) out vec4 out_colour;

void main() {
  if (kind == kBackdrop) {
    out_colour = vec4(backdrop(in_position.xy), 1);
    return;
  }
  const vec3 eye = orthographic != 0 ? vec3(0, 0, 1) : normalize(-in_position);
  const vec3 up = vec3(view[0].y, view[1].y, view[2].y);
  const float size = length(in_normal);
  vec3 n = size > 1e-6 ? in_normal / size : eye;
  if (!gl_FrontFacing) n = -n;
  out_colour = vec4(kind == kColoured ? coloured(in_colour, n, eye, up) : clay(kClay, n, eye, up), 1);
}
