// A state that is accepted must lead to a finite skin.
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/rig.h"
#include "tests/fuzz/given_file.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() { return {testing::read_bytes(given_file("tet.state"))}; }

void read(const std::string& bytes) {
  static Deformer deformer(tet_basis(), tet_dynamics(), {}, {.name = "cpu"});
  const JiggleState state = load_state(as_file("jiggle.state", with_checksum(bytes)), tet_dynamics());
  deformer.set_state(state);
  const Pose pose = bind_pose(tet_basis().skeleton);
  const int next = state.frame < 1'000'000 ? state.frame + 1 : state.frame;
  require_finite(deformer.jiggle({&pose, 1}, {&next, 1}).positions, "the skin after a state");
}

const bool added = add_target({"jiggle_state", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
