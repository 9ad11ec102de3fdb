#include "trainer/attach/loose_meshes.h"

#include "tests/assets/gltf_blob.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/small_limb.h"

namespace bodyopt::fuzz {
namespace {

using namespace trainer;

std::vector<std::string> seeds() {
  GltfBlob skinned = two_joint_square(), hung = two_joint_square();
  for (GltfBlob* blob : {&skinned, &hung}) {
    blob->root["nodes"][0]["name"] = "upper";
    blob->root["nodes"][1]["name"] = "lower";
  }
  hung.root["nodes"][2] = {{"name", "flag"}, {"mesh", 0}};
  hung.root["nodes"][1]["children"] = {2};
  return {skinned.glb(), hung.glb()};
}

void read(const std::string& bytes) {
  std::vector<std::string> notes;
  for (const LooseMesh& mesh : read_loose_meshes(GltfFile(as_file("mesh.glb", bytes)), limb().skeleton, 0, 1, notes)) {
    for (const Vec3& vertex : mesh.vertices) require_finite(vertex, "vertices");
  }
}

const bool added = add_target({"loose_meshes", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
