// Extensions that a file requires, and views that are compressed.
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "tests/assets/character_checks.h"

namespace bodyopt {
namespace {

// What the encoder of the library makes of a view, the plain bytes being nowhere else.
void compress(GltfBlob& blob, std::size_t accessor, std::size_t stride, const std::string& mode) {
  Json& view = blob.root["bufferViews"][blob.root["accessors"][accessor]["bufferView"].get<std::size_t>()];
  const std::size_t count = view["byteLength"].get<std::size_t>() / stride;
  const char* plain = blob.binary.data() + view["byteOffset"].get<std::size_t>();
  std::vector<unsigned char> encoded(1 << 16);
  if (mode == "ATTRIBUTES") {
    encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), plain, count, stride));
  } else {
    std::vector<std::uint16_t> indices(count);
    std::memcpy(indices.data(), plain, 2 * count);
    encoded.resize(mode == "TRIANGLES"
                       ? meshopt_encodeIndexBuffer(encoded.data(), encoded.size(), indices.data(), count)
                       : meshopt_encodeIndexSequence(encoded.data(), encoded.size(), indices.data(), count));
  }
  view["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                   {"byteOffset", blob.binary.size()},
                                                   {"byteLength", encoded.size()},
                                                   {"byteStride", stride},
                                                   {"count", count},
                                                   {"mode", mode}};
  view["buffer"] = 1;
  blob.binary.append(reinterpret_cast<const char*>(encoded.data()), encoded.size());
  blob.binary.resize((blob.binary.size() + 3) / 4 * 4, '\0');
}

// Its second buffer stands for what is not compressed, and is nowhere.
GltfBlob compressed_square(const std::string& index_mode) {
  GltfBlob blob = two_joint_square();
  const auto& attributes = primitive(blob)["attributes"];
  compress(blob, attributes["POSITION"], 12, "ATTRIBUTES");
  compress(blob, attributes["JOINTS_0"], 4, "ATTRIBUTES");
  compress(blob, attributes["WEIGHTS_0"], 16, "ATTRIBUTES");
  compress(blob, primitive(blob)["indices"], 2, index_mode);
  blob.root["buffers"] = {{{"byteLength", blob.binary.size()}},
                          {{"byteLength", 4096}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  blob.root["extensionsRequired"] = {"EXT_meshopt_compression"};
  return blob;
}

TEST(GltfCompression, CompressedViewsAreAsTheirPlainOnes) {
  const TemporaryFolder folder;
  const Character plain = read(two_joint_square(), folder);
  for (const char* mode : {"TRIANGLES", "INDICES"}) {
    const Character c = read(compressed_square(mode), folder);
    EXPECT_EQ(c.vertices, plain.vertices);
    EXPECT_EQ(c.triangles, plain.triangles);
    ASSERT_EQ(c.weights[1].size(), plain.weights[1].size());
    EXPECT_EQ(c.weights[1][0].weight, plain.weights[1][0].weight);
  }
}

TEST(GltfCompression, DamagedViewsAreErrors) {
  const TemporaryFolder folder;
  const std::string at = "/bufferViews/0/extensions/EXT_meshopt_compression";
  const std::vector<std::pair<std::string, Json>> patches{
      {"", 3},
      {"/buffer", 9},
      {"/buffer", -1},
      {"/byteOffset", 18446744073709551600ull},
      {"/byteLength", 18446744073709551600ull},
      {"/byteLength", 3},
      {"/byteStride", 0},
      {"/byteStride", 6},
      {"/byteStride", 260},
      {"/count", 0},
      {"/count", 1u << 30},
      {"/count", 18446744073709551615ull},
      {"/count", 1.5},
      {"/mode", "TRIANGLES"},
      {"/mode", "POINTS"},
      {"/mode", 1},
      {"/filter", "OCTAHEDRAL"},
      {"/filter", "QUATERNION"},
      {"/filter", "GAUSSIAN"},
  };
  for (const auto& [key, value] : patches) {
    GltfBlob blob = compressed_square("TRIANGLES");
    blob.root[Json::json_pointer(at + key)] = value;
    const std::string text = error_of(ErrorKind::file, [&] { read(blob, folder); });
    EXPECT_NE(text.find("c.glb: compressed buffer view 0 "), std::string::npos) << key << value << text;
  }
  // Whatever the bytes are.
  const GltfBlob sound = compressed_square("TRIANGLES");
  const auto& view = sound.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
  for (std::size_t k = 0; k < view["byteLength"].get<std::size_t>(); ++k) {
    GltfBlob blob = sound;
    blob.binary[view["byteOffset"].get<std::size_t>() + k] ^= '\x55';
    try {
      expect_valid(read(blob, folder, 1));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
    }
  }
}

TEST(GltfCompression, RequiredExtensionsAreReadWhereTheyChangeNothingOrNamed) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  for (const char* name : {"VRMC_vrm", "VRMC_springBone", "VRM", "KHR_materials_unlit", "KHR_texture_basisu",
                           "EXT_texture_webp", "MSFT_texture_dds", "KHR_mesh_quantization", "KHR_xmp_json_ld"}) {
    blob.root["extensionsRequired"] = {name};
    EXPECT_EQ(read(blob, folder).vertices.rows(), 4) << name;
  }
  put_bytes(folder / "c.vrm", blob.glb());
  EXPECT_EQ(read_character(folder / "c.vrm").vertices.rows(), 4);
  blob.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  std::string text = error_of(ErrorKind::file, [&] { read(blob, folder); });
  EXPECT_NE(text.find("requires the extension \"EXT_mesh_gpu_instancing\""), std::string::npos) << text;
  EXPECT_EQ(text.find("compress"), std::string::npos) << text;

  blob.root.erase("extensionsRequired");
  blob.root["extensionsUsed"] = {"KHR_draco_mesh_compression"};  // with plain data beside it
  EXPECT_EQ(read(blob, folder).vertices.rows(), 4);
  blob.root["accessors"][0].erase("bufferView");
  text = error_of(ErrorKind::file, [&] { read(blob, folder); });
  EXPECT_NE(text.find("compressed by Draco"), std::string::npos) << text;
}

}  // namespace
}  // namespace bodyopt
