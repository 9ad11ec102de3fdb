#include "tests/fuzz/clip.h"
#include "tests/fuzz/small_limb.h"
#include "tests/support/fbx_writer.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() {
  using Cluster = testing::WrittenCluster;
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  testing::WrittenFbx file;
  file.unit = 100;
  file.models = {{.name = "upper", .before = {0, 90, 0}},
                 {.name = "lower", .parent = 0, .translation = {1, 0, 0}, .rotation_pivot = {0, 0.1, 0}},
                 {.name = "skin", .type = "Mesh"}};
  file.meshes = {{.model = 2,
                  .points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                  .polygons = {0, 1, 2, ~std::int64_t{3}},
                  .clusters = {Cluster{0, {0, 3}, {1, 1}, here, here}, Cluster{1, {1, 2}, {1, 1}, here, here}}}};
  file.curves = {{.model = 1, .axis = 2, .seconds = {0, 0.1}, .values = {0, 200}, .flags = 0x408, .slope_out = 9}};
  file.end = 0.1;
  return {file.text(), file.binary(7400, false), file.binary(7700, true)};
}

void read(const std::string& bytes) {
  const std::filesystem::path path = as_file("limb.fbx", bytes);
  const Character character = read_character(path, 0.1);
  require_finite(std::vector(character.vertices.data(), character.vertices.data() + character.vertices.size()),
                 "vertices");
  require_finite_poses(read_clip(path.string(), limb().skeleton, {}));
}

const bool added = add_target({"fbx", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
