// What a shot chooses of a basis' modifiers; what is accepted is driven.
#include "assets/clips/shot_modifiers.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/modifiers/driven_small_basis.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> modifiers_seeds() {
  return {R"({"schema": "bodyopt-modifiers-1", "modifiers": [{"name": "shown", "on": true, "strength": 0.5,
 "controls": {"rate": 20, "depth": 0.5, "exertion": 0.25, "seed": 3}}]})"};
}
void read_modifiers_file(const std::string& bytes) {
  Basis basis = testing::breathing_basis();
  choose_modifiers(as_file("modifiers.json", bytes), basis.modifiers);
  validate(basis, "what a shot chose");
  std::vector<Pose> poses = testing::bind_poses(basis, 30);
  drive_modifiers(basis, {}, 24, poses);
  for (const Pose& pose : poses) require_finite(pose.modifiers, "weights");
}

const bool added = add_target({"shot_modifiers", modifiers_seeds, read_modifiers_file});

}  // namespace
}  // namespace bodyopt::fuzz
