// The capsule limb as a glTF file that more can be added to by hand. Nodes 0 to 2 are its joints.
#pragma once

#include "runtime/core/json.h"
#include "tests/assets/gltf_blob.h"
#include "tests/support/attached_limb.h"

namespace bodyopt {

struct LimbGlb : GltfBlob {
  explicit LimbGlb(const std::filesystem::path& scratch);

  // Returns the mesh's index.
  std::size_t add_mesh(const trainer::LooseMesh& mesh, double units_per_metre = 1);

  // A node with that mesh, below a node or (-1) at the top. Returns it.
  Json& add_node(const std::string& name, std::size_t mesh, int parent);
};

namespace testing {

// In a folder the limb with an eye, and where `moves` says so a clip of its own. Returns the file.
std::string limb_file(const TemporaryFolder& folder, bool moves);

}  // namespace testing
}  // namespace bodyopt
