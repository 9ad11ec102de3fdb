// Texture coordinates and materials of a character's own file, and where they go.
#include "assets/gltf/skin_surface.h"

#include <gtest/gtest.h>

#include "assets/caches/gltf_shapes.h"
#include "assets/caches/join_caches.h"
#include "assets/caches/usda.h"
#include "assets/characters/character.h"
#include "assets/gltf/gltf_file.h"
#include "assets/gltf/gltf_guard.h"
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
  ASSERT_EQ(painted.surface.materials.size(), 2u);
  EXPECT_EQ(painted.surface.materials[0].name, "cloth");
  EXPECT_EQ(painted.surface.materials[1].name, "skin");
  EXPECT_EQ(painted.surface.material_of, (std::vector<std::size_t>{1, 1, 0, 0}));
  EXPECT_EQ(painted.surface.materials[0].colour(),
            (std::array<double, 4>{1, 1, 1, 1}));  // what is no colour is left out
  EXPECT_EQ(painted.surface.materials[1].colour(), (std::array<double, 4>{0.75, 0.5, 0.25, 1}));
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
    const Json& material = file.look().at("materials").at(static_cast<std::size_t>(primitives[p].material));
    EXPECT_EQ(material.at("name"), painted.surface.materials[p].name);
    EXPECT_EQ((SurfaceMaterial{"", material}.colour()[2]), p == 0 ? 1 : 0.25);
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

// The painted square with an image for what is skin, and one beside the file for what is cloth.
class Pictured : public ::testing::Test {
 protected:
  Pictured() {
    blob_ = painted_square();
    blob_.add(std::vector<char>(kPng.begin(), kPng.end()), 5121, "SCALAR", 1);
    blob_.root["images"] = {{{"name", "skin & bone"}, {"bufferView", blob_.root["bufferViews"].size() - 1}},
                            {{"uri", "cloth%20of%20gold.webp"}}};
    blob_.root["samplers"] = {{{"wrapS", 33648}, {"wrapT", 10497}, {"magFilter", 9728}}};
    blob_.root["textures"] = {{{"source", 0}, {"sampler", 0}},
                              {{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
    Json& materials = blob_.root["materials"];
    materials[0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 1}};
    materials[0]["alphaMode"] = "MASK";
    materials[1]["pbrMetallicRoughness"]["baseColorTexture"] = {
        {"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 3}}, {"offset", {0.5, 0.25}}}}}}};
    materials[1]["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
    put_bytes(folder_ / "cloth of gold.webp", kWebp);
  }

  SkinSurface read(const std::filesystem::path& path) const {
    const GltfFile file(path);
    MaterialReader reader(file);
    return read_node_surface(reader, file.model().nodes.size() - 1, {});
  }
  SkinSurface read_blob() const {
    put_bytes(folder_ / "pictured.glb", blob_.glb());
    return read(folder_ / "pictured.glb");
  }
  // To a file of that name, and the file's text.
  std::string written(const SkinSurface& surface, const std::string& name) const {
    Painted painted(folder_);
    painted.surface = surface;
    painted.write(*write_cache(folder_ / name, painted.layout()));
    return read_bytes(folder_ / name);
  }

  static inline const std::string kPng = "\x89PNG\r\n\x1a\n of skin", kWebp = "RIFF....WEBP of cloth";
  TemporaryFolder folder_;
  GltfBlob blob_;
};

TEST_F(Pictured, ImagesGoIntoGltfAsTheyWere) {
  const SkinSurface read_first = read_blob();
  EXPECT_EQ(read_first.notes, std::vector<std::string>());
  const std::string text = written(read_first, "shapes.glb");
  EXPECT_NE(text.find(R"("extensionsRequired":["EXT_texture_webp"])"), std::string::npos);
  const SkinSurface again = read(folder_ / "shapes.glb");
  ASSERT_EQ(again.materials.size(), 2u);
  EXPECT_EQ(std::vector<double>(again.texture.begin(), again.texture.begin() + 16), read_first.texture);
  const auto texture_of = [&](const SurfaceMaterial& material) {
    return again.textures.at(material.texture()->at("index").get<std::size_t>());
  };
  EXPECT_EQ(*texture_of(again.materials[0]).bytes, kWebp);
  EXPECT_EQ(again.materials[0].alpha_mode(), "MASK");
  const SurfaceTexture skin = texture_of(again.materials[1]);
  EXPECT_EQ(*skin.bytes, kPng);
  EXPECT_EQ(skin.name, "skin & bone");
  EXPECT_EQ(skin.type, "image/png");
  EXPECT_EQ(skin.sampler, (Json{{"magFilter", 9728}, {"wrapS", 33648}}));
  EXPECT_EQ(again.materials[1].gltf.at("normalTexture").at("scale"), 0.5);
  EXPECT_EQ(again.materials[1].texture()->at("extensions"), read_first.materials[1].texture()->at("extensions"));
}

TEST_F(Pictured, CoordinatesAreTurnedAsTheMaterialSays) {
  Json& texture = blob_.root["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"];
  const auto expect_at = [&](const std::vector<double>& skin) {
    const std::vector<double> at = image_coordinates(read_blob(), Painted(folder_).corners);
    for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(at[k], skin[k], 1e-12) << k;
    EXPECT_EQ(at[9], 1);  // of the cloth
  };
  expect_at({0.5, 3.25, 2.5, 3.25, 2.5, 1, 0.5, 0.25});
  // A quarter to the left, as one sees it: v counts downwards.
  texture["extensions"]["KHR_texture_transform"] = {{"rotation", std::acos(0.0)}};
  expect_at({1, 0, 1, -1, 0.25, -1, 0, 0});
}

TEST_F(Pictured, ImagesLieBesideUsd) {
  const std::string text = written(read_blob(), "shapes.usda");
  const std::string naming = "asset inputs:file = @./";
  std::map<std::string, std::string> found;  // by extension
  for (std::size_t at = text.find(naming); at != std::string::npos; at = text.find(naming, at + 1)) {
    const std::string name = text.substr(at + naming.size(), text.find('@', at + naming.size()) - at - naming.size());
    found[std::filesystem::path(name).extension().string()] = read_bytes(folder_ / name);
  }
  EXPECT_EQ(found, (std::map<std::string, std::string>{{".png", kPng}, {".webp", kWebp}}));
  for (const char* part :
       {"float inputs:opacityThreshold = 0.5", "token inputs:wrapS = \"mirror\"", "int[] indices = [0, 1]",
        "rel material:binding = </painted/skin>", "(2.5, 0), (0.5, 0.75)",  // u and 1 - v in the image
        "float4 inputs:scale = (0.75, 0.5, 0.25, 1)"}) {
    EXPECT_NE(text.find(part), std::string::npos) << "expected '" << part << "' in:\n" << text;
  }
}

TEST_F(Pictured, MaterialsAndFacesOfUsdHaveNamesOfTheirOwn) {
  blob_.root["materials"][0]["name"] = "a";
  blob_.root["materials"][1]["name"] = "faces_of_a";
  const std::string text = written(read_blob(), "shapes.usda");
  std::set<std::string> names;
  for (std::size_t at = text.find("\n    def "); at != std::string::npos; at = text.find("\n    def ", at + 1)) {
    const std::size_t quote = text.find('"', at) + 1;
    const std::string name = text.substr(quote, text.find('"', quote) - quote);
    EXPECT_TRUE(names.insert(name).second) << name;
  }
  EXPECT_EQ(names.size(), 4u);
}

TEST_F(Pictured, ACutOffThatNoAlphaIsBelowIsNone) {
  blob_.root["materials"][0]["alphaCutoff"] = 0;
  EXPECT_EQ(read_blob().materials[0].alpha_mode(), "OPAQUE");
}

TEST_F(Pictured, JoinedPartsBringTheirImages) {
  Painted painted(folder_);
  painted.surface = read_blob();
  std::filesystem::create_directory(folder_ / "parts");
  std::vector<std::filesystem::path> parts;
  for (const int frame : {1, 2}) {
    CacheLayout layout = painted.layout();
    layout.frames = {frame};
    parts.push_back(folder_ / "parts" / (std::to_string(frame) + ".usda"));
    const auto writer = write_cache(parts.back(), layout);
    writer->append(painted.points, {});
    writer->close();
  }
  const auto images = [](const std::filesystem::path& folder) {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().filename().string().starts_with("painted_")) found.insert(read_bytes(entry.path()));
    }
    return found;
  };
  EXPECT_TRUE(images(folder_.path()).empty());
  join_caches(parts, folder_ / "whole.usda");
  EXPECT_EQ(images(folder_.path()), (std::set<std::string>{kPng, kWebp}));
}

TEST_F(Pictured, MeshesOfAFileShareItsImages) {
  put_bytes(folder_ / "pictured.glb", blob_.glb());
  const GltfFile file(folder_ / "pictured.glb");
  MaterialReader reader(file);
  const std::size_t node = file.model().nodes.size() - 1;
  const SkinSurface one = read_node_surface(reader, node, {}), other = read_node_surface(reader, node, {});
  ASSERT_EQ(one.textures.size(), 2u);
  ASSERT_EQ(other.textures.size(), 2u);
  EXPECT_EQ(one.textures[1].bytes, other.textures[1].bytes);
}

// What a .glb calls as FBX has it is not of FBX.
TEST_F(Pictured, CornersOfOtherFilesHaveNoRowsOfTheirOwn) {
  const SkinSurface before = read_blob();
  const std::size_t forged = blob_.add(std::vector<std::uint16_t>(40, 7), 5123, "SCALAR", 1);
  Json& attributes = blob_.root["meshes"][0]["primitives"][1]["attributes"];
  for (const char* name : {"_ROW_OF", "_MATERIAL_OF"}) attributes[name] = forged;
  attributes["_ROWS"] = attributes["TEXCOORD_0"];
  const SkinSurface surface = read_blob();
  EXPECT_TRUE(surface.texture_of.empty());
  EXPECT_EQ(surface.texture, before.texture);
  EXPECT_EQ(surface.material_of, before.material_of);
}

TEST_F(Pictured, TheBaseColoursSetOfCoordinatesIsTaken) {
  Json& primitive = blob_.root["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_3"] = blob_.add(std::vector<float>{5, 5, 5, 5, 5, 5, 5, 5}, 5126, "VEC2", 2);
  blob_.root["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 3;
  const SkinSurface surface = read_blob();
  EXPECT_EQ(surface.texture[0], 5);
  EXPECT_EQ(surface.texture[8], 0);
  EXPECT_FALSE(surface.materials[1].gltf.contains("normalTexture"));  // which is looked up elsewhere
}

TEST_F(Pictured, WhatIsWrongIsLeftOutAndTold) {
  std::filesystem::remove(folder_ / "cloth of gold.webp");
  blob_.root["samplers"][0]["wrapS"] = "often";
  blob_.root["materials"][1]["normalTexture"]["index"] = -1;
  blob_.root["materials"][1]["alphaMode"] = "sometimes";
  const SkinSurface surface = read_blob();
  ASSERT_EQ(surface.notes.size(), 1u);
  EXPECT_NE(surface.notes[0].find("cloth"), std::string::npos) << surface.notes[0];
  EXPECT_EQ(surface.materials[0].texture(), nullptr);
  EXPECT_EQ(surface.textures.at(0).sampler, (Json{{"magFilter", 9728}}));
  EXPECT_EQ(surface.materials[1].alpha_mode(), "OPAQUE");
  EXPECT_FALSE(surface.materials[1].gltf.contains("normalTexture"));
  written(surface, "shapes.glb");
  EXPECT_EQ(read(folder_ / "shapes.glb").materials.size(), 2u);
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

// What a shot is made of: an image that changes makes its results stale; one that is missing is a note elsewhere.
TEST(SkinSurface, ImagesBesideAFileAreFilesOfIt) {
  const TemporaryFolder folder;
  put_bytes(folder / "there.png", "image");
  put_bytes(folder / "hero.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "hero.bin", "byteLength": 4}],
      "images": [{"uri": "there.png"}, {"uri": "missing.png"}, {"uri": "../elsewhere.png"}, {"uri": "data:,"},
      {"uri": ""}, {"uri": "."}, {"uri": ")" +
                                      std::string(5000, 'x') + R"("}, {"uri": "https://x/)" + std::string(5000, 'y') +
                                      R"("}]})");
  std::vector<std::string> names;
  for (const auto& file : gltf_files(folder / "hero.gltf")) names.push_back(file.filename().string());
  EXPECT_EQ(names, (std::vector<std::string>{"hero.gltf", "hero.bin", "there.png"}));
}

}  // namespace skin_surface_test
}  // namespace bodyopt::testing
