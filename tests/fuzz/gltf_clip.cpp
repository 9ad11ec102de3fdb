#include <nlohmann/json.hpp>

#include "runtime/core/json.h"
#include "tests/assets/gltf_blob.h"
#include "tests/fuzz/clip.h"
#include "tests/fuzz/small_limb.h"

namespace bodyopt::fuzz {
namespace {

// As the writer has it, and another's: skinned, with other channels, for other joints.
std::vector<std::string> seeds() {
  Clip bending;
  for (int k = 0; k < 3; ++k) bending.poses.push_back(bent(limb(), 0.2 * k));
  GltfBlob other = two_joint_square();
  other.root["nodes"][0]["name"] = "upper";
  other.root["nodes"][1]["name"] = "lower";
  other.root["animations"] =
      Json::array({{{"name", "step"}, {"channels", Json::array()}, {"samplers", Json::array()}}});
  animate(other, 0, "translation", {0, 0.1f}, {0, 0, 0, 1, 0, 0}, "STEP");
  animate(other, 1, "rotation", {0, 0.1f}, {0, 0, 0, 1, 0, 0.6f, 0, 0.8f});
  return {written("bend.glb", [&](const auto& path) { write_clip(bending, limb().skeleton, path); }), other.glb()};
}

void read(const std::string& bytes) {
  const std::filesystem::path path = as_file("clip.glb", bytes);
  clip_names(path);
  require_finite_poses(read_clip(path.string(), limb().skeleton, {}));
}

const bool added = add_target({"gltf_clip", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
