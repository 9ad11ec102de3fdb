#include "runtime/basis/dynamics.h"

#include "tests/fuzz/given_file.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() { return {testing::read_bytes(given_file("tet.dynamics.safetensors"))}; }

void read(const std::string& bytes) {
  const Dynamics dynamics = load_dynamics(as_file("dynamics.safetensors", with_checksum(bytes)), tet_basis());
  require_finite(dynamics.tets.nodes, "nodes");
  require_finite(dynamics.jiggle.springs, "springs");
}

const bool added = add_target({"dynamics", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
