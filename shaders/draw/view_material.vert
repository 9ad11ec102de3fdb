#version 450
#extension GL_GOOGLE_include_directive : require
// The corners of a skin's triangles, as view_surface.vert has them, with what its materials need.
#include "view.glsl"

layout(push_constant) uniform Push {
  View view;
  vec4 colour;  // linear RGB and alpha
  vec3 offset;  // world, metres
  float least_alpha;
  uint wire, orthographic;
  uint first_vertex;  // of the frame to draw
};

struct SurfaceVertex {
  uint vertex;
  float u, v;
  uint red_green, blue;
};
layout(std430, set = 0, binding = 0) readonly buffer Corners { uint corners[]; };
layout(std430, set = 0, binding = 1) readonly buffer Positions { float positions[]; };
layout(std430, set = 0, binding = 2) readonly buffer Normals { float normals[]; };
layout(std430, set = 0, binding = 3) readonly buffer Vertices { SurfaceVertex vertices[]; };

layout(location = 0) out vec3 out_position;  // camera space
layout(location = 1) out vec3 out_normal;    // camera space
layout(location = 2) out vec3 out_corner;    // barycentric
layout(location = 3) out vec2 out_uv;
layout(location = 4) out vec3 out_own;       // the vertex' own colour

void main() {
  // Edges need to know their corner; otherwise every vertex is shaded once.
  const SurfaceVertex vertex = vertices[wire != 0 ? corners[gl_VertexIndex] : gl_VertexIndex];
  const uint at = 3 * (first_vertex + vertex.vertex);
  out_position = to_camera(view, vec3(positions[at], positions[at + 1], positions[at + 2]) + offset);
  out_normal = turn_to_camera(view, vec3(normals[at], normals[at + 1], normals[at + 2]));
  const uint corner = gl_VertexIndex % 3;
  out_corner = vec3(corner == 0, corner == 1, corner == 2);
  out_uv = vec2(vertex.u, vertex.v);
  out_own = vec3(unpackUnorm2x16(vertex.red_green), unpackUnorm2x16(vertex.blue).x);
  gl_Position = to_picture(view, out_position, orthographic != 0);
}
