#include "tests/support/limb_glb.h"

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/support/read_bytes.h"

namespace bodyopt {

LimbGlb::LimbGlb(const std::filesystem::path& scratch) {
  write_character(limb_character(), scratch);
  const std::string bytes = testing::read_bytes(scratch);
  const auto word = [&](std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  root = Json::parse(bytes.substr(20, word(12)));
  root.erase("buffers");
  binary = bytes.substr(28 + word(12), word(20 + word(12)));
}

std::size_t LimbGlb::add_mesh(const trainer::LooseMesh& mesh, double units_per_metre) {
  std::vector<float> positions;
  std::vector<std::uint32_t> corners;
  for (const Vec3& p : mesh.vertices) {
    for (const double x : p) positions.push_back(static_cast<float>(units_per_metre * x));
  }
  for (const auto& triangle : mesh.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  const std::size_t position = vectors(positions), indices = add(corners, 5125, "SCALAR", 1);
  root["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}}}}});
  return root["meshes"].size() - 1;
}

Json& LimbGlb::add_node(const std::string& name, std::size_t mesh, int parent) {
  const std::size_t node = root["nodes"].size();
  if (parent >= 0) {
    root["nodes"][static_cast<std::size_t>(parent)]["children"].push_back(node);
  } else {
    root["scenes"][0]["nodes"].push_back(node);
  }
  root["nodes"].push_back({{"name", name}, {"mesh", mesh}});
  return root["nodes"].back();
}

namespace testing {

std::string limb_file(const TemporaryFolder& folder, bool moves) {
  LimbGlb limb(folder / "limb.glb");
  limb.add_node("eye", limb.add_mesh(sphere_at("", {0, 0, 0.02}, 0.008)), 2);
  if (moves) {
    const std::size_t times = limb.scalars({0, 1}), turns = limb.quads({0, 0, 0, 1, 0.6f, 0, 0, 0.8f});
    limb.root["animations"] = {{{"name", "nod"},
                                {"samplers", {{{"input", times}, {"output", turns}}}},
                                {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}}}}}};
  }
  put_bytes(folder / "limb.glb", limb.glb());
  return (folder / "limb.glb").string();
}

}  // namespace testing
}  // namespace bodyopt
