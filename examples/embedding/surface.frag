#version 450
// The colour, darker where a triangle is seen from its side.
layout(push_constant) uniform Constants { vec4 box, colour; };
layout(location = 0) in vec3 place;
layout(location = 0) out vec4 shade;

void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  shade = vec4(colour.rgb * (0.3 + 0.7 * abs(normal.z)), 1.0);
}
