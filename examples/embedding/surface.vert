#version 450
// A view along z: what is in `box` fills the picture.
layout(push_constant) uniform Constants { vec4 box, colour; };  // centre, 1 over half its size
layout(location = 0) in vec3 position;
layout(location = 0) out vec3 place;

void main() {
  place = (position - box.xyz) * box.w;
  gl_Position = vec4(place.x, -place.y, 0.5 - 0.5 * place.z, 1.0);
}
