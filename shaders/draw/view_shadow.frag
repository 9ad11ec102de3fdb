#version 450

layout(location = 0) in float in_nearness;
layout(location = 0) out vec4 out_colour;

void main() {
  const float near = clamp(in_nearness, 0, 1);
  out_colour = vec4(0.35 * near + 0.65 * near * near * near, 0, 0, 1);
}
