#version 450
#extension GL_GOOGLE_include_directive : require
// The surroundings of the characters: the backdrop, and on the ground a grid and soft shadows.
#include "studio.glsl"
#include "view.glsl"

layout(push_constant) uniform Push {
  View view;
  vec4 shadow;
  vec4 ground;
  uint grid, light, orthographic;
};

layout(set = 0, binding = 0) uniform sampler2D shade;  // how near the ground something is, 0..1

layout(location = 0) in vec2 in_at;
layout(location = 1) in vec3 in_origin;
layout(location = 2) in vec3 in_direction;
layout(location = 0) out vec4 out_colour;

// 1 on lines `spacing` apart, a pixel and a half wide.
float lines(vec2 at, float spacing, vec2 width) {
  const vec2 off = abs(fract(at / spacing - 0.5) - 0.5) * spacing;
  const vec2 near = 1 - smoothstep(0.5 * width, 1.5 * width, off);
  const vec2 far = smoothstep(0.5, 0.15, width / spacing);  // lines closer than pixels fade
  return max(near.x * far.x, near.y * far.y);
}

void main() {
  if (light != 0) {
    out_colour = vec4(0.62, 0.62, 0.62, 1);
    return;
  }
  vec3 colour = backdrop(in_at);
  const float t = (ground.x - in_origin.y) / in_direction.y;
  const vec3 at = in_origin + t * in_direction;
  const vec2 width = fwidth(at.xz);
  if (ground.z > 0 && t > 0 && t < 1e6) {  // not along the ground
    const vec2 from_middle = (at.xz - shadow.xy) / ground.z;
    const float near = 1 / (1 + dot(from_middle, from_middle)), reach = near * near;
    colour *= 1 + 1.4 * reach;  // light falls on the ground
    if (grid != 0) {
      colour += reach * (0.010 * lines(at.xz, ground.y, width) + 0.016 * lines(at.xz, 5 * ground.y, width));
    }
    if (ground.w > 0) {
      const vec2 axis = (1 - smoothstep(0.5 * width, 1.5 * width, abs(at.xz))) * reach;
      colour = mix(colour, vec3(0.22, 0.030, 0.032), 0.55 * axis.y);
      colour = mix(colour, vec3(0.035, 0.070, 0.24), 0.55 * axis.x);
    }
    if (shadow.w > 0) colour *= 1 - shadow.w * texture(shade, 0.5 + 0.5 * (at.xz - shadow.xy) * shadow.z).r;
  }
  out_colour = vec4(colour, 1);
}
