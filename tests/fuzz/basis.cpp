// A basis, or levels of detail; what is accepted is evaluated.
#include "runtime/basis/levels.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/fuzz/given_file.h"
#include "tests/support/small_basis.h"

namespace bodyopt::fuzz {
namespace {

// The smallest first: most of what can go wrong is in the tables' counts.
std::vector<std::string> seeds() {
  const Basis basis = testing::small_basis();
  Basis carried = basis;
  carried.skeleton.features = {{1, 0, axis_angle({1, 2, 0}, 0.3), axis_angle({0, 1, 3}, 0.7)}};
  const auto bytes_of = [](const Basis& of) {
    return written("basis.safetensors", [&](const auto& path) { save_basis(of, path); });
  };
  return {testing::read_bytes(given_file("tet.safetensors")), bytes_of(basis), bytes_of(carried)};
}

void read(const std::string& bytes) {
  for (const Level& level : load_levels(as_file("basis.safetensors", with_checksum(bytes)))) {
    Pose pose = bind_pose(level.basis.skeleton);
    pose.controls.resize(level.basis.residual.controls.size());
    Deformer(level.basis, {.name = "cpu"}).evaluate({&pose, 1});
  }
}

const bool added = add_target({"basis", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
