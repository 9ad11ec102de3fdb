// The edges of triangles over a surface.

// corner: barycentric. Near an edge of its triangle: 1, some pixels off: 0.
float edge(vec3 corner) {
  const vec3 width = fwidth(corner);
  const vec3 near = smoothstep(0.3 * width, 1.3 * width, corner);
  return 1 - min(near.x, min(near.y, near.z));
}

vec3 wired(vec3 colour, vec3 corner) { return mix(colour, vec3(0.012, 0.014, 0.018), 0.65 * edge(corner)); }
