// Musculoskeletal models; those that are accepted are posed, and their paths traced.
#include "tests/fuzz/fuzz_target.h"
#include "tests/muscle_models/small_models.h"
#include "trainer/muscle_models/model.h"

namespace bodyopt::fuzz {
namespace {

using namespace trainer;

void read_as(const std::string& name, const std::string& bytes) {
  const muscle_models::Model model = muscle_models::read_model(as_file(name, bytes).string());
  const muscle_models::ModelPose pose = muscle_models::pose_model(model, muscle_models::default_values(model));
  for (const muscle_models::ModelMuscle& muscle : model.muscles) {
    require_finite(std::vector{muscle_models::path_length(muscle_models::trace_path(muscle, pose))},
                   "the length of a muscle");
  }
}

std::vector<std::string> opensim_seeds() { return {testing::small_osim()}; }
std::vector<std::string> mujoco_seeds() { return {testing::small_mujoco()}; }
void read_opensim(const std::string& bytes) { read_as("model.osim", bytes); }
void read_mujoco(const std::string& bytes) { read_as("model.xml", bytes); }

const bool added =
    add_target({"opensim", opensim_seeds, read_opensim}) && add_target({"mujoco", mujoco_seeds, read_mujoco});

}  // namespace
}  // namespace bodyopt::fuzz
