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

std::size_t LimbGlb::add_mesh(const LooseMesh& mesh, double units_per_metre) {
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

}  // namespace bodyopt
