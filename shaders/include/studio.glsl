// A small studio: a large warm key light from the upper left, a cool fill from the right, a rim light, light all
// around. The lights stand with the camera, so that every picture reads alike. Camera space, linear RGB.

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

// A surface with a sheen, faint where it is rough (1: matt). n: normal; eye: towards the camera; up: the world's.
vec3 lit_surface(vec3 colour, float rough, vec3 n, vec3 eye, vec3 up) {
  const vec3 around = mix(kGround, kSky, 0.5 + 0.5 * dot(n, up));
  const vec3 diffuse = around + kKey * wrapped(dot(n, kKeyDirection)) + kFill * wrapped(dot(n, kFillDirection)) +
                       kRim * max(0, dot(n, kRimDirection));
  const float gloss = (1 - rough) * (1 - rough);
  const float glint = pow(max(0, dot(n, normalize(kKeyDirection + eye))), mix(28, 160, gloss));
  const float grazing = pow(1 - max(0, dot(n, eye)), 4);
  return colour * diffuse + mix(0.07, 0.6, gloss) * glint * kKey +
         0.10 * grazing * (0.3 + 0.7 * max(0, dot(n, kRimDirection))) * kRim;
}

vec3 clay(vec3 colour, vec3 n, vec3 eye, vec3 up) { return lit_surface(colour, 1, n, eye, up); }

// Flat enough for a colour to be found on the colour bar, shaded enough for the shape to be seen.
vec3 coloured(vec3 colour, vec3 n, vec3 eye, vec3 up) {
  const float light =
      0.50 + 0.50 * wrapped(dot(n, kKeyDirection)) + 0.08 * dot(n, up) + 0.08 * max(0, dot(n, kFillDirection));
  return colour * light * mix(0.75, 1.0, max(0, dot(n, eye)));
}

// Darker towards the edges and the bottom; noise of half a step hides the steps of 8 bits. at: picture, -1..1, y down.
vec3 backdrop(vec2 at) {
  const float height = 0.5 - 0.5 * at.y;
  const float noise =
      fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;  // Jimenez 2014
  const vec3 colour = mix(vec3(0.008, 0.008, 0.009), vec3(0.026, 0.028, 0.032), height);
  return colour * (1 - 0.18 * dot(at, at)) + noise * 0.0012;
}
