#version 450
#extension GL_GOOGLE_include_directive : require
// The corners of a skin's triangles where the deformer left them: nothing is copied.
#include "view.glsl"

layout(push_constant) uniform Push {
  View view;
  vec4 offset_alpha;     // offset: world, metres
  vec4 tint_heat;        // linear RGB; one over the top of the colour bar (1/m), 0: no heat
  uint style, wire, orthographic;
  uint first_vertex, first_reference;  // of the frame to draw, in vertices
  uint reference_kind;
};
const uint kDistances = 1, kColours = 2;

layout(std430, set = 0, binding = 0) readonly buffer Triangles { uint triangles[]; };
layout(std430, set = 0, binding = 1) readonly buffer Positions { float positions[]; };
layout(std430, set = 0, binding = 2) readonly buffer Normals { float normals[]; };
// Positions to measure against, distances that were measured (m), or colours (linear RGB).
layout(std430, set = 0, binding = 3) readonly buffer Reference { float reference[]; };

layout(location = 0) out vec3 out_position;  // camera space
layout(location = 1) out vec3 out_normal;    // camera space
layout(location = 2) out vec3 out_corner;    // barycentric
layout(location = 3) out float out_heat;     // 0..1 on the colour bar
layout(location = 4) out vec3 out_own;       // the vertex' own colour

void main() {
  // Edges need to know their corner; otherwise every vertex is shaded once.
  const uint vertex = wire != 0 ? triangles[gl_VertexIndex] : gl_VertexIndex;
  const uint at = 3 * (first_vertex + vertex);
  const vec3 position = vec3(positions[at], positions[at + 1], positions[at + 2]);
  out_heat = 0;
  out_own = vec3(0);
  if (tint_heat.w > 0) {
    const uint to = first_reference + vertex;
    if (reference_kind == kDistances) {
      out_heat = tint_heat.w * reference[to];
    } else {
      const vec3 there = vec3(reference[3 * to], reference[3 * to + 1], reference[3 * to + 2]);
      if (reference_kind == kColours) out_own = there;
      else out_heat = tint_heat.w * distance(position, there);
    }
  }
  out_position = to_camera(view, position + offset_alpha.xyz);
  out_normal = turn_to_camera(view, vec3(normals[at], normals[at + 1], normals[at + 2]));
  const uint corner = gl_VertexIndex % 3;
  out_corner = vec3(corner == 0, corner == 1, corner == 2);
  gl_Position = to_picture(view, out_position, orthographic != 0);
  if (offset_alpha.w < 1) gl_Position.z += 1e-3 * gl_Position.w;  // a ghost in the same place lies behind
}
