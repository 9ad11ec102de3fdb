#version 450
// The corners of a mesh's triangles, pulled by number; or of the one triangle that covers the picture (the backdrop).

layout(push_constant) uniform Push {
  vec4 view[3];      // world to camera space, rows: x right, y up, z towards the camera
  vec4 projection;   // x and y scale; depth = (z * projection.z + projection.w) / w
  uint kind;
  uint orthographic;  // w is 1; otherwise it is -z
};
const uint kBackdrop = 2;

layout(std430, set = 0, binding = 0) readonly buffer Triangles { uint triangles[]; };
layout(std430, set = 0, binding = 1) readonly buffer Positions { float positions[]; };
layout(std430, set = 0, binding = 2) readonly buffer Normals { float normals[]; };
layout(std430, set = 0, binding = 3) readonly buffer Colours { float colours[]; };

layout(location = 0) out vec3 out_position;  // camera space; for the backdrop: picture coordinates in xy, -1..1
layout(location = 1) out vec3 out_normal;    // camera space
layout(location = 2) out vec3 out_colour;    // linear RGB

const uint kColoured = 1;

void main() {
  out_normal = vec3(0);
  out_colour = vec3(0);
  if (kind == kBackdrop) {
    const vec2 corner = vec2(gl_VertexIndex == 1 ? 3 : -1, gl_VertexIndex == 2 ? 3 : -1);
    out_position = vec3(corner, 0);
    gl_Position = vec4(corner, 1, 1);  // behind everything
    return;
  }
  const uint at = 3 * triangles[gl_VertexIndex];
  const vec4 position = vec4(positions[at], positions[at + 1], positions[at + 2], 1);
  const vec3 normal = vec3(normals[at], normals[at + 1], normals[at + 2]);
  out_position = vec3(dot(view[0], position), dot(view[1], position), dot(view[2], position));
  out_normal = vec3(dot(view[0].xyz, normal), dot(view[1].xyz, normal), dot(view[2].xyz, normal));
  if (kind == kColoured) out_colour = vec3(colours[at], colours[at + 1], colours[at + 2]);
  gl_Position = vec4(projection.x * out_position.x, -projection.y * out_position.y,
                     projection.z * out_position.z + projection.w, orthographic != 0 ? 1 : -out_position.z);
}
