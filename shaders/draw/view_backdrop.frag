#version 450
// An image behind the characters.

layout(push_constant) uniform Push {
  vec2 scale;  // how much of the image's sides the view's are
  float opacity;
};

layout(set = 0, binding = 0) uniform sampler2D image;

layout(location = 0) in vec2 in_at;
layout(location = 0) out vec4 out_colour;

void main() {
  const vec2 from_middle = (in_at - 0.5) * scale;
  const vec4 texel = texture(image, 0.5 + from_middle);
  const float within = max(abs(from_middle.x), abs(from_middle.y)) <= 0.5 ? 1 : 0;
  out_colour = vec4(texel.rgb, within * opacity * texel.a);
}
