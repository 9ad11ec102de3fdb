#version 450
// The triangle that covers the picture.

layout(location = 0) out vec2 out_at;  // 0..1

void main() {
  out_at = vec2(gl_VertexIndex == 1 ? 2 : 0, gl_VertexIndex == 2 ? 2 : 0);
  gl_Position = vec4(2 * out_at - 1, 0.5, 1);
}
