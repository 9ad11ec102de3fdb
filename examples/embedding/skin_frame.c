/* Loads a trained character, turns one of its joints by half a right angle, and writes the skin as an OBJ file.
 *   skin_frame BASIS.safetensors JOINT OUT.obj */
#include <bodyopt/bodyopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void stop(bodyopt_result result, const char* text) {
  fprintf(stderr, "%s\n", text);
  exit(result);
}

static void check(bodyopt_result result) {
  if (result != BODYOPT_OK) stop(result, bodyopt_last_error());
}

int main(int argc, char** argv) {
  if (argc != 4) stop(BODYOPT_USAGE, "usage: skin_frame BASIS.safetensors JOINT OUT.obj");
  bodyopt_model* model = NULL;
  bodyopt_instance* instance = NULL;
  check(bodyopt_load_model(argv[1], NULL, &model));
  check(bodyopt_create_instance(model, NULL, &instance));
  bodyopt_description character = {.struct_size = sizeof(character)};
  check(bodyopt_describe(model, &character));
  const uint32_t joint = (uint32_t)atoi(argv[2]);
  if (joint >= character.joint_count) stop(BODYOPT_USAGE, "the character has no joint of this number");

  const size_t pose_size = character.joint_count * 10 * sizeof(double);
  const size_t skin_size = character.vertex_count * 3 * sizeof(float);
  const size_t triangle_size = character.triangle_count * 3 * sizeof(uint32_t);
  double* joints = malloc(pose_size);
  float* positions = malloc(skin_size);
  uint32_t* triangles = malloc(triangle_size);
  check(bodyopt_get_bind_pose(model, joints, pose_size));
  check(bodyopt_get_triangles(model, triangles, triangle_size));

  double* q = joints + 10 * joint + 3; /* its rotation, times one about z */
  const double s = sin(0.785398163 / 2), c = cos(0.785398163 / 2);
  const double turned[4] = {q[0] * c + q[1] * s, q[1] * c - q[0] * s, q[2] * c + q[3] * s, q[3] * c - q[2] * s};
  for (int i = 0; i < 4; ++i) q[i] = turned[i];
  bodyopt_poses poses = {.struct_size = sizeof(poses), .frame_count = 1, .joint_count = character.joint_count};
  poses.joints = joints;
  bodyopt_skin skin = {.struct_size = sizeof(skin), .positions = {.data = positions, .size = skin_size}};
  check(bodyopt_evaluate(instance, &poses, &skin));

  FILE* file = fopen(argv[3], "w");
  if (file == NULL) stop(BODYOPT_FILE, "the OBJ file cannot be written");
  for (const float* x = positions; x < positions + 3 * character.vertex_count; x += 3) {
    fprintf(file, "v %.9g %.9g %.9g\n", x[0], x[1], x[2]);
  }
  for (const uint32_t* t = triangles; t < triangles + 3 * character.triangle_count; t += 3) {
    fprintf(file, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  if (fclose(file) != 0) stop(BODYOPT_FILE, "the OBJ file could not be written to its end");
  printf("turned %s; wrote %u vertices\n", bodyopt_joint_name(model, joint), character.vertex_count);
  bodyopt_release_instance(instance);
  bodyopt_release_model(model);
  free(joints), free(positions), free(triangles);
  return BODYOPT_OK;
}
