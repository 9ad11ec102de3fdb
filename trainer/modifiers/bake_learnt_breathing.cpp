// Breathing learnt of a take of a dataset: what its shapes have beyond the skin that the basis gives in the same poses.
#include <cstdio>

#include "assets/character.h"
#include "assets/json_file.h"
#include "dataset/dataset.h"
#include "geometry/table_rows.h"
#include "runtime/core/error.h"
#include "trainer/curate/shape_stack.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/evaluated_skin.h"
#include "trainer/modifiers/learn_breath.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
namespace {

constexpr double kUsualDepth = 0.6;  // of the control: at it a breath is as deep as the take's

// Of the database, in the order of the take's cache.
std::vector<std::size_t> frames_of(const BakeInput& input, const PoseDatabase& database) {
  const std::string take = input.parameters.name("take");
  std::vector<std::size_t> frames;
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    if (database.takes[static_cast<std::size_t>(database.frames[n].take)] == take) frames.push_back(n);
  }
  if (frames.empty()) input.parameters.refuse("learns of the take '" + take + "', of which the dataset has no shapes");
  return frames;
}

}  // namespace

// numbers: parts of the take's breath for a depth of one.
BakedModifier bake_learnt_breathing(const BakeInput& input) {
  const ShapeStack stack(read_pose_database(read_dataset(input.folder / input.parameters.name("dataset"))));
  const PoseDatabase& database = stack.database();
  const std::vector<std::size_t> frames = frames_of(input, database);
  EvaluatedSkin skin(without_modifiers(input.basis));
  std::vector<Positions> offsets;
  for (const std::size_t n : frames) {
    Pose pose = database.frames[n].pose;
    pose.controls.clear();
    const Positions shape =
        modifier_shape(input, output_from_welded(database.character, stack.shape(n)), "the dataset's character");
    offsets.push_back(unpose_ddm(input.basis, pose, shape) - unpose_ddm(input.basis, pose, skin({&pose, 1})[0]));
  }
  const LearntBreath breath =
      learn_breath(rows_of(input.basis.mesh.rest), rows_of(input.basis.mesh.triangles), offsets, input.place);
  char text[64];
  std::snprintf(text, sizeof text, "%zu frames: %.2f litres a breath", offsets.size(), breath.litres);
  input.notes.push_back(input.place + " is learnt of " + text);
  BakedModifier baked;
  baked.components = breath.shapes;
  baked.numbers = {static_cast<float>(1 / kUsualDepth)};
  return baked;
}

}  // namespace bodyopt
