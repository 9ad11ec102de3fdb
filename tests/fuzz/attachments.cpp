#include "runtime/basis/attachments.h"

#include "tests/fuzz/given_file.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() { return {testing::read_bytes(given_file("capsule.attached.safetensors"))}; }

void read(const std::string& bytes) {
  static const Basis basis = load_basis(given_file("capsule.safetensors"));
  for (const AttachedMesh& mesh :
       load_attachments(as_file("attached.safetensors", with_checksum(bytes)), basis).meshes) {
    require_finite(mesh.rest, "vertices");
  }
}

const bool added = add_target({"attachments", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
