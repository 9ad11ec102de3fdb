#version 450
#extension GL_GOOGLE_include_directive : require
// A skin as clay, as a polished ball would show it (matcap), in facets, by its normals, by the heat of a distance, in
// colours of its vertices, or black. Edges go over it, and a ghost is see-through.
#include "studio.glsl"
#include "view.glsl"
#include "wire.glsl"

layout(push_constant) uniform Push {
  View view;
  vec4 offset_alpha;
  vec4 tint_heat;
  uint style, wire, orthographic;
  uint first_vertex, first_reference, reference_kind;
};
const uint kColours = 2;  // of reference_kind
const uint kMatcap = 2, kFlat = 3, kNormals = 4, kSilhouette = 5;

const uint kPaletteSize = 256;
layout(std430, set = 0, binding = 4) readonly buffer Palette { float palette[]; };  // the colour bar, linear RGB

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec3 in_corner;
layout(location = 3) in float in_heat;
layout(location = 4) in vec3 in_own;
layout(location = 0) out vec4 out_colour;

// Polished: a soft window above, a strip of light at the side, dark where it looks away.
vec3 matcap(vec3 colour, vec3 n) {
  const float window = smoothstep(0.55, 0.95, dot(n, normalize(vec3(-0.35, 0.75, 0.55))));
  const float strip = smoothstep(0.25, 0.0, abs(dot(n, normalize(vec3(0.85, 0.10, -0.25))) - 0.62));
  const float body = 0.10 + 0.62 * pow(0.5 + 0.5 * dot(n, normalize(vec3(-0.30, 0.60, 0.70))), 1.6);
  return colour * (1.35 * body) + 0.42 * window + 0.16 * strip * vec3(0.80, 0.90, 1.0);
}

vec3 palette_colour(float t) {
  const float at = clamp(t, 0, 1) * (kPaletteSize - 1);
  const uint k = min(uint(at), kPaletteSize - 2);
  const vec3 low = vec3(palette[3 * k], palette[3 * k + 1], palette[3 * k + 2]);
  const vec3 high = vec3(palette[3 * k + 3], palette[3 * k + 4], palette[3 * k + 5]);
  return mix(low, high, at - k);
}

void main() {
  const vec3 eye = orthographic != 0 ? vec3(0, 0, 1) : normalize(-in_position);
  const vec3 up = vec3(view.rows[0].y, view.rows[1].y, view.rows[2].y);
  vec3 n = in_normal;
  if (style == kFlat) n = cross(dFdx(in_position), -dFdy(in_position));
  const float size = length(n);
  n = size > 1e-20 ? n / size : eye;
  if (style == kFlat ? dot(n, eye) < 0 : !gl_FrontFacing) n = -n;
  const vec3 base = tint_heat.rgb;
  vec3 colour;
  if (tint_heat.w > 0) {
    colour = coloured(reference_kind == kColours ? in_own : palette_colour(in_heat), n, eye, up);
  } else if (style == kMatcap) {
    colour = matcap(base, n);
  } else if (style == kNormals) {
    colour = 0.5 + 0.5 * n;
    colour *= colour;
  } else if (style == kSilhouette && offset_alpha.w >= 1) {
    colour = vec3(0);
  } else {
    colour = clay(base, n, eye, up);
  }
  if (wire != 0) colour = wired(colour, in_corner);
  float alpha = offset_alpha.w;
  if (alpha < 1) alpha *= 0.25 + 0.75 * pow(1 - max(0, dot(n, eye)), 1.5);  // a ghost is seen by its outline
  out_colour = vec4(colour, alpha);
}
