// Texture coordinates and materials of a character's own file, and where they go.
#include "assets/skin_surface.h"

#include <gtest/gtest.h>

#include "assets/character.h"
#include "assets/gltf_file.h"
#include "assets/gltf_shapes.h"
#include "assets/usda.h"
#include "tests/assets/gltf_blob.h"
#include "tests/support/hostile_bytes.h"

namespace bodyopt::testing {
namespace skin_surface_test {

// The square in two parts, of skin and of something that has a material without a colour.
GltfBlob painted_square() {
  GltfBlob blob = two_joint_square();
  const std::size_t texture = blob.add(std::vector<float>{0, 1, 1, 1, 1, 0.25f, 0, 0}, 5126, "VEC2", 2);
  Json& primitives = blob.root["meshes"][0]["primitives"];
  primitives[0]["attributes"]["TEXCOORD_0"] = texture;
  primitives.push_back(primitives[0]);
  primitives[0]["material"] = 1;
  primitives[1]["material"] = 0;
  blob.root["materials"] = {{{"name", "cloth"}, {"pbrMetallicRoughness", {{"baseColorFactor", {2, "red", 0, 1}}}}},
                            {{"name", "skin"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.75, 0.5, 0.25, 1}}}}}};
  return blob;
}

struct Painted {
  explicit Painted(const TemporaryFolder& folder) : path(folder / "painted.glb") {
    put_bytes(path, painted_square().glb());
    const Character read = read_character(path);
    corners.assign(read.output_triangles.data(), read.output_triangles.data() + read.output_triangles.size());
    points = output_from_welded(read, read.vertices);
    surface = read_skin_surface(path, points.size() / 3, corners);
  }
  CacheLayout layout() const {
    return {"painted", static_cast<std::uint32_t>(points.size() / 3), corners, {1, 2}, 24, {}, surface};
  }
  void write(CacheWriter& writer) const {
    writer.append(points, {});
    writer.append(points, {});
    writer.close();
  }
  std::filesystem::path path;
  std::vector<std::uint32_t> corners;
  std::vector<float> points;
  SkinSurface surface;
};

TEST(SkinSurface, IsThatOfTheFile) {
  const TemporaryFolder folder;
  const Painted painted(folder);
  EXPECT_EQ(painted.surface.materials, (std::vector<std::string>{"cloth", "skin"}));
  EXPECT_EQ(painted.surface.material_of, (std::vector<std::size_t>{1, 1, 0, 0}));
  EXPECT_EQ(painted.surface.colours[0], (std::array<double, 4>{1, 1, 1, 1}));  // what is no colour is left out
  EXPECT_EQ(painted.surface.colours[1], (std::array<double, 4>{0.75, 0.5, 0.25, 1}));
  ASSERT_EQ(painted.surface.texture.size(), 16u);
  EXPECT_EQ(painted.surface.texture[5], 0.25);
}

TEST(SkinSurface, GoesIntoMorphTargetsByMaterial) {
  const TemporaryFolder folder;
  const Painted painted(folder);
  GltfShapesWriter writer(folder / "shapes.glb", painted.layout());
  painted.write(writer);
  const GltfFile file(folder / "shapes.glb");
  const auto& primitives = file.model().meshes.at(0).primitives;
  ASSERT_EQ(primitives.size(), 2u);
  for (std::size_t p = 0; p < 2; ++p) {
    const tinygltf::Material& material = file.model().materials.at(static_cast<std::size_t>(primitives[p].material));
    EXPECT_EQ(material.name, painted.surface.materials[p]);
    EXPECT_EQ(material.pbrMetallicRoughness.baseColorFactor[2], painted.surface.colours[p][2]);
    EXPECT_EQ(file.numbers(primitives[p].attributes.at("TEXCOORD_0"), TINYGLTF_TYPE_VEC2, "texture"),
              painted.surface.texture);
    EXPECT_EQ(primitives[p].targets.size(), 1u);
    const auto corners = file.indices(primitives[p].indices, TINYGLTF_TYPE_SCALAR, "corners");
    const auto first = painted.corners.begin() + (p == 0 ? 6 : 0);
    EXPECT_EQ(corners, std::vector<std::uint32_t>(first, first + 6));
  }
}

TEST(SkinSurface, UsdCountsItsSecondCoordinateFromBelow) {
  const TemporaryFolder folder;
  const Painted painted(folder);
  UsdaWriter writer(folder / "shapes.usda", painted.layout());
  painted.write(writer);
  const std::string text = read_bytes(folder / "shapes.usda");
  const std::string once = "(0, 0), (1, 0), (1, 0.75), (0, 1)";
  EXPECT_NE(
      text.find("    texCoord2f[] primvars:st = [" + once + ", " + once + "] (\n        interpolation = \"vertex\""),
      std::string::npos)
      << text;
}

TEST(SkinSurface, OfAnotherMeshIsRefused) {
  const TemporaryFolder folder;
  const Painted painted(folder);
  std::vector<std::uint32_t> corners = painted.corners;
  std::swap(corners[0], corners[1]);  // as of a character that its joints mirror
  EXPECT_FALSE(read_skin_surface(painted.path, 8, corners).empty());
  corners[0] = 3;
  const std::string said = error_of(ErrorKind::mismatch, [&] { read_skin_surface(painted.path, 8, corners); });
  EXPECT_NE(said.find("painted.glb"), std::string::npos);
  error_of(ErrorKind::mismatch, [&] { read_skin_surface(painted.path, 7, painted.corners); });
  put_bytes(folder / "bare.glb", two_joint_square().glb());
  EXPECT_TRUE(read_skin_surface(folder / "bare.glb", 4, std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}).empty());
}

TEST(SkinSurface, OfMaterialsThatAreNotThereIsRefused) {
  const TemporaryFolder folder;
  GltfBlob blob = painted_square();
  blob.root["meshes"][0]["primitives"][1]["material"] = 9;
  put_bytes(folder / "wrong.glb", blob.glb());
  error_of(ErrorKind::file, [&] { read_skin_surface(folder / "wrong.glb", 8, Painted(folder).corners); });
}

}  // namespace skin_surface_test
}  // namespace bodyopt::testing
