// The viewport's view: world to camera space, and onto the picture.

struct View {
  vec4 rows[3];     // world to camera space: x right, y up, z towards the camera
  vec4 projection;  // x and y scale; depth = (z projection.z + projection.w) / w
};

vec3 to_camera(View view, vec3 world) {
  const vec4 at = vec4(world, 1);
  return vec3(dot(view.rows[0], at), dot(view.rows[1], at), dot(view.rows[2], at));
}

vec3 turn_to_camera(View view, vec3 direction) {
  return vec3(dot(view.rows[0].xyz, direction), dot(view.rows[1].xyz, direction), dot(view.rows[2].xyz, direction));
}

// w is 1 for an orthographic camera, otherwise -z.
vec4 to_picture(View view, vec3 at, bool orthographic) {
  return vec4(view.projection.x * at.x, -view.projection.y * at.y, view.projection.z * at.z + view.projection.w,
              orthographic ? 1 : -at.z);
}
