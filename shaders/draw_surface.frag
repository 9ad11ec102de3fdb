#version 450
// Clay in a small studio: a large warm key light from the upper left, a cool fill from the right, a rim light from
// behind and light from all around. The lights stand with the camera, so that every picture reads alike.

layout(push_constant) uniform Push {
  vec4 view[3];
  vec4 projection;
  uint kind;
  uint orthographic;
};
const uint kColoured = 1;
const uint kBackdrop = 2;

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec3 in_colour;
layout(location = 0) out vec4 out_colour;

const vec3 kClay = vec3(0.545, 0.500, 0.440);  // as the zero of heat_colour()
const vec3 kKeyDirection = normalize(vec3(-0.72, 0.72, 0.42)), kKey = vec3(1.22, 1.10, 0.96);
const vec3 kFillDirection = normalize(vec3(0.90, 0.10, 0.45)), kFill = vec3(0.13, 0.16, 0.21);
const vec3 kRimDirection = normalize(vec3(0.55, 0.45, -0.75)), kRim = vec3(0.55, 0.58, 0.65);
const vec3 kSky = vec3(0.105, 0.115, 0.135), kGround = vec3(0.060, 0.054, 0.050);

// Diffuse light of a large source, which reaches a little around the edge.
float wrapped(float cosine) {
  const float w = 0.12;
  return max(0, (cosine + w) / (1 + w));
}

vec3 clay(vec3 n, vec3 eye, vec3 up) {
  const vec3 around = mix(kGround, kSky, 0.5 + 0.5 * dot(n, up));
  const vec3 diffuse = around + kKey * wrapped(dot(n, kKeyDirection)) + kFill * wrapped(dot(n, kFillDirection)) +
                       kRim * max(0, dot(n, kRimDirection));
  const float glint = pow(max(0, dot(n, normalize(kKeyDirection + eye))), 28);
  const float grazing = pow(1 - max(0, dot(n, eye)), 4);
  return kClay * diffuse + 0.07 * glint * kKey + 0.10 * grazing * (0.3 + 0.7 * max(0, dot(n, kRimDirection))) * kRim;
}

// Flat enough for a colour to be found on the colour bar, shaded enough for the shape to be seen.
vec3 coloured(vec3 n, vec3 eye, vec3 up) {
  const float light = 0.50 + 0.50 * wrapped(dot(n, kKeyDirection)) + 0.08 * dot(n, up) + 0.08 * max(0, dot(n, kFillDirection));
  return in_colour * light * mix(0.75, 1.0, max(0, dot(n, eye)));
}

// Darker towards the edges and the bottom; noise of half a step hides the steps of 8 bits.
vec3 backdrop(vec2 at) {
  const float height = 0.5 - 0.5 * at.y;
  const float noise = fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453) - 0.5;
  const vec3 colour = mix(vec3(0.008, 0.008, 0.009), vec3(0.026, 0.028, 0.032), height);
  return colour * (1 - 0.18 * dot(at, at)) + noise * 0.0012;
}

void main() {
  if (kind == kBackdrop) {
    out_colour = vec4(backdrop(in_position.xy), 1);
    return;
  }
  const vec3 eye = orthographic != 0 ? vec3(0, 0, 1) : normalize(-in_position);
  const vec3 up = vec3(view[0].y, view[1].y, view[2].y);
  const float size = length(in_normal);
  vec3 n = size > 1e-6 ? in_normal / size : eye;
  if (!gl_FrontFacing) n = -n;
  out_colour = vec4(kind == kColoured ? coloured(n, eye, up) : clay(n, eye, up), 1);
}
