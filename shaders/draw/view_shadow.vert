#version 450
// A skin seen from straight above, for its shadow.

layout(push_constant) uniform Push {
  vec4 shadow;  // centre x, z; half sides of the map a metre; height of the ground
  vec4 offset_reach;  // offset of the skin, world; one over the height at which it casts no shadow (1/m)
  uint first_vertex;
};

layout(std430, set = 0, binding = 0) readonly buffer Positions { float positions[]; };

layout(location = 0) out float out_nearness;

void main() {
  const uint at = 3 * (first_vertex + gl_VertexIndex);
  const vec3 position = vec3(positions[at], positions[at + 1], positions[at + 2]) + offset_reach.xyz;
  out_nearness = 1 - (position.y - shadow.w) * offset_reach.w;
  gl_Position = vec4((position.xz - shadow.xy) * shadow.z, 0.5, 1);
}
