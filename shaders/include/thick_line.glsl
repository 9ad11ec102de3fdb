// A line of some pixels' width as two triangles. Needs view.glsl.

// Corner 0..5 of the line from a to b (camera space); half: half its width over half the picture's size, both in
// pixels.
vec4 thick_line(View view, vec3 a, vec3 b, bool orthographic, vec2 half_width, uint corner) {
  const float nearest = -1e-4;
  if (!orthographic) {  // what lies behind the camera is cut off: it would come out in front
    if (a.z > nearest && b.z > nearest) return vec4(0, 0, -1, 1);
    if (a.z > nearest) a = mix(b, a, (nearest - b.z) / (a.z - b.z));
    if (b.z > nearest) b = mix(a, b, (nearest - a.z) / (b.z - a.z));
  }
  const vec4 from = to_picture(view, a, orthographic), to = to_picture(view, b, orthographic);
  const vec2 along = (to.xy / to.w - from.xy / from.w) / half_width;
  const float size = length(along);
  const vec2 side = size > 1e-9 ? vec2(-along.y, along.x) / size : vec2(1, 0);
  const bool end = corner == 1 || corner == 2 || corner == 4;
  const float sign = corner == 0 || corner == 1 || corner == 3 ? -1 : 1;
  vec4 at = end ? to : from;
  at.xy += at.w * sign * side * half_width;
  return at;
}
