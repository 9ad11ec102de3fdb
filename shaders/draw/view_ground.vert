#version 450
#extension GL_GOOGLE_include_directive : require
// The triangle that covers the picture, with the ray of every pixel.
#include "view.glsl"

layout(push_constant) uniform Push {
  View view;
  vec4 shadow;  // centre x, z; half sides of the map a metre; strength
  vec4 ground;  // height; spacing of the grid; how far it reaches, metres, 0: none; axes (0 or 1)
  uint grid, light, orthographic;
};

layout(location = 0) out vec2 out_at;  // picture, -1..1, y down
layout(location = 1) out vec3 out_origin;
layout(location = 2) out vec3 out_direction;

void main() {
  out_at = vec2(gl_VertexIndex == 1 ? 3 : -1, gl_VertexIndex == 2 ? 3 : -1);
  gl_Position = vec4(out_at, 1, 1);
  const mat3 turn = mat3(view.rows[0].xyz, view.rows[1].xyz, view.rows[2].xyz);  // columns: the camera's axes, world
  const vec3 eye = -(turn * vec3(view.rows[0].w, view.rows[1].w, view.rows[2].w));
  const vec2 seen = vec2(out_at.x / view.projection.x, -out_at.y / view.projection.y);
  out_origin = orthographic != 0 ? eye + turn * vec3(seen, 0) : eye;
  out_direction = orthographic != 0 ? turn * vec3(0, 0, -1) : turn * vec3(seen, -1);
}
