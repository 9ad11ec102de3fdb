#version 450
#extension GL_GOOGLE_include_directive : require
// A skin in its own materials, lit as clay is; edges over it.
#include "studio.glsl"
#include "view.glsl"
#include "wire.glsl"

layout(push_constant) uniform Push {
  View view;
  vec4 colour;
  vec3 offset;
  float least_alpha;  // a hole where alpha is lower, with an edge of a pixel; 0: seen through as it says; -1: opaque
  uint wire, orthographic;
  uint first_vertex;
};

const float kWhite = 0.85;  // of what is white, so that light does not wash it out

layout(set = 0, binding = 4) uniform sampler2D image;
layout(set = 0, binding = 5) uniform sampler2D detail;  // normal: x right, y up the image; roughness

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec3 in_corner;
layout(location = 3) in vec2 in_uv;
layout(location = 4) in vec3 in_own;
layout(location = 0) out vec4 out_colour;

// The normal of a map of them, in the frame of the image's axes on the surface, by their derivatives.
vec3 bumped(vec3 n, vec2 mapped) {
  const vec3 dx = dFdx(in_position), dy = dFdy(in_position);
  const vec2 ux = dFdx(in_uv), uy = dFdy(in_uv);
  const float side = sign(dot(cross(dx, dy), n));
  const vec3 along_x = side * cross(dy, n), along_y = side * cross(n, dx);
  const vec3 right = along_x * ux.x + along_y * uy.x, down = along_x * ux.y + along_y * uy.y;
  if (dot(right, right) < 1e-30 || dot(down, down) < 1e-30) return n;
  const float towards = sqrt(max(0.01, 1 - dot(mapped, mapped)));
  return normalize(mapped.x * normalize(right) - mapped.y * normalize(down) + towards * n);
}

void main() {
  const vec3 eye = orthographic != 0 ? vec3(0, 0, 1) : normalize(-in_position);
  const vec3 up = vec3(view.rows[0].y, view.rows[1].y, view.rows[2].y);
  const float size = length(in_normal);
  vec3 n = size > 1e-20 ? in_normal / size : eye;
  if (!gl_FrontFacing) n = -n;
  const vec4 base = colour * texture(image, in_uv);
  const vec3 small = texture(detail, in_uv).rgb;
  vec3 lit = lit_surface(kWhite * base.rgb * in_own, small.z, bumped(n, small.xy * 255 / 127 - 128.0 / 127), eye, up);
  if (wire != 0) lit = wired(lit, in_corner);
  float alpha = least_alpha < 0 ? 1 : base.a;
  if (least_alpha > 0) alpha = clamp(0.5 + (base.a - least_alpha) / max(1e-4, fwidth(base.a)), 0, 1);
  out_colour = vec4(lit, alpha);
}
