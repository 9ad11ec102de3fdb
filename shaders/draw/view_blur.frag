#version 450
// A shadow's soft edge: the mean over three rings. It is taken on a small picture, not at every pixel of the ground.

layout(push_constant) uniform Push {
  float caster;  // radius of what casts it, in half sides of the picture
};

layout(set = 0, binding = 0) uniform sampler2D picture;

layout(location = 0) in vec2 in_at;
layout(location = 0) out vec4 out_colour;

void main() {
  float sum = 0;
  for (int ring = 0; ring < 3; ++ring) {
    for (int k = 0; k < 6; ++k) {
      const float angle = (k + 0.5 * ring) * 1.0471976;
      sum += texture(picture, in_at + caster * (0.006 + 0.012 * ring) * vec2(cos(angle), sin(angle))).r;
    }
  }
  out_colour = vec4(sum / 18, 0, 0, 1);
}
