// Musculoskeletal models; those that are accepted are posed, and their paths traced.
#include "tests/anatomy/small_models.h"
#include "tests/fuzz/fuzz_target.h"
#include "trainer/anatomy/model.h"

namespace bodyopt::fuzz {
namespace {

void read_as(const std::string& name, const std::string& bytes) {
  const anatomy::Model model = anatomy::read_model(as_file(name, bytes).string());
  const anatomy::ModelPose pose = anatomy::pose_model(model, anatomy::default_values(model));
  for (const anatomy::ModelMuscle& muscle : model.muscles) {
    require_finite(std::vector{anatomy::path_length(anatomy::trace_path(muscle, pose))}, "the length of a muscle");
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
