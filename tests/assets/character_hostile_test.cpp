// Bytes that nobody vouches for: every one of these must be an error, and none a crash.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "assets/characters/character.h"
#include "runtime/core/json.h"
#include "tests/assets/character_checks.h"
#include "tests/assets/gltf_blob.h"

namespace bodyopt {
namespace {

TEST(CharacterHostile, BuffersMayLieBesideTheFileButNowhereElse) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  std::filesystem::create_directories(folder / "in/parts");
  put_bytes(folder / "in/parts/my data.bin", blob.binary);
  put_bytes(folder / "secret.bin", blob.binary);
  std::filesystem::create_symlink(folder / "secret.bin", folder / "in/link.bin");
  const auto read_with = [&](const std::string& uri) {
    blob.root["buffers"] = {{{"byteLength", blob.binary.size()}, {"uri", uri}}};
    put_bytes(folder / "in/c.gltf", blob.root.dump());
    return read_character(folder / "in/c.gltf");
  };
  EXPECT_EQ(read_with("parts/my%20data.bin").vertices.rows(), 4);
  EXPECT_EQ(read_with("parts/../parts/my data.bin").vertices.rows(), 4);
  for (const std::string uri :
       {"../secret.bin", "parts/../../secret.bin", "%2e%2e/secret.bin", "link.bin", "missing.bin", "file:///etc/passwd",
        "/etc/passwd", "/dev/zero", "", ".", "data:,abc", "data:application/octet-stream;base64,AAAA",
        "data:application/octet-stream;base64,???"}) {
    error_of(ErrorKind::file, [&] { read_with(uri); });
  }
  error_of(ErrorKind::file, [&] { read_with((folder / "secret.bin").string()); });
}

// Whatever the file is called: what it is, not where a parser stopped.
TEST(CharacterHostile, FilesOfOtherKindsAreNamed) {
  const TemporaryFolder folder;
  const std::pair<const char*, const char*> files[] = {
      {"#usda 1.0\n", "a USD file"},
      {"PXR-USDC", "a USD file"},
      {"<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\">", "a COLLADA file"},
      {"# Blender\nv 0 0 0\n", "an OBJ"},
      {"version https://git-lfs.github.com/spec/v1\noid", "a pointer of Git LFS"},
      {"", "it is empty"}};
  for (const auto& [bytes, kind] : files) {
    for (const char* name : {"hero.gltf", "hero.fbx"}) {
      put_bytes(folder / name, bytes);
      const std::string said = error_of(ErrorKind::file, [&] { read_character(folder / name); });
      EXPECT_NE(said.find("is not a glTF file"), std::string::npos) << said;
      EXPECT_NE(said.find(kind), std::string::npos) << said;
    }
  }
  put_bytes(folder / "hero.gltf", "\xef\xbb\xbf \n{");
  EXPECT_NE(error_of(ErrorKind::file, [&] { read_character(folder / "hero.gltf"); }).find("JSON"), std::string::npos);
}

TEST(CharacterHostile, EveryTruncationIsAnError) {
  const TemporaryFolder folder;
  const std::string bytes = two_joint_square().glb();
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    put_bytes(folder / "t.glb", bytes.substr(0, length));
    error_of(ErrorKind::file, [&] { read_character(folder / "t.glb"); });
  }
  const std::string json = two_joint_square().root.dump();
  for (std::size_t length = 0; length <= json.size(); length += 7) {
    put_bytes(folder / "t.gltf", json.substr(0, length));
    error_of(ErrorKind::file, [&] { read_character(folder / "t.gltf"); });
  }
  error_of(ErrorKind::file, [&] { read_character(folder / "absent.glb"); });
  error_of(ErrorKind::file, [&] { read_character(folder / ""); });
}

TEST(CharacterHostile, HostileHeadersAreErrors) {
  const TemporaryFolder folder;
  const std::string good = two_joint_square().glb();
  const auto refuse = [&](std::size_t offset, const std::string& replacement) {
    std::string bytes = good;
    bytes.replace(offset, replacement.size(), replacement);
    put_bytes(folder / "h.glb", bytes);
    error_of(ErrorKind::file, [&] { read_character(folder / "h.glb"); });
  };
  refuse(0, "glTX");
  refuse(4, std::string("\1\0\0\0", 4));
  refuse(4, std::string("\3\0\0\0", 4));
  refuse(8, "\xff\xff\xff\xff");
  refuse(12, "\xff\xff\xff\xff");
  refuse(12, std::string("\0\0\0\0", 4));
  refuse(16, "BINX");
  const std::size_t json_end = good.find("BIN") - 4;
  refuse(json_end, "\xff\xff\xff\x7f");
  // The chunk reaches eight bytes beyond the file, which tinygltf alone would read.
  std::uint32_t length = 0;
  std::memcpy(&length, good.data() + json_end, 4);
  length += 8;
  refuse(json_end, std::string(reinterpret_cast<const char*>(&length), 4));
  put_bytes(folder / "deep.gltf", std::string(200000, '[') + std::string(200000, ']'));
  error_of(ErrorKind::file, [&] { read_character(folder / "deep.gltf"); });
}

Json sparse(int count, int indices, int type, int values) {
  return {{"count", count},
          {"indices", {{"bufferView", indices}, {"componentType", type}}},
          {"values", {{"bufferView", values}}}};
}

TEST(CharacterHostile, HostileJsonIsAnError) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, Json>> patches{
      {"/asset/version", "1.0"},
      {"/asset/version", 2},
      {"/asset", 5},
      {"/extensionsRequired", {"KHR_draco_mesh_compression"}},
      {"/extensionsRequired", 3},
      {"/buffers/0/byteLength", 1e15},
      {"/buffers/0/byteLength", -1},
      {"/buffers/0", 0},
      {"/buffers", "x"},
      {"/accessors/0/count", 5},
      {"/accessors/0/count", 0},
      {"/accessors/0/count", 6148914691236517206ull},
      {"/accessors/0/count", 18446744073709551615ull},
      {"/accessors/0/count", -1},
      {"/accessors/0/byteOffset", 18446744073709551608ull},
      {"/accessors/0/byteOffset", 8},
      {"/accessors/0/bufferView", 99},
      {"/accessors/0/bufferView", -7},
      {"/accessors/0/componentType", 5124},
      {"/accessors/0/componentType", 5130},
      {"/accessors/0/componentType", 5125},
      {"/accessors/0/type", "VEC4"},
      {"/accessors/0/type", "VEC9"},
      {"/accessors/0/sparse", sparse(99, 1, 5121, 0)},
      {"/accessors/0/sparse", sparse(-1, 1, 5121, 0)},
      {"/accessors/0/sparse", sparse(2147483647, 1, 5121, 0)},
      {"/accessors/0/sparse", sparse(1, 99, 5121, 0)},
      {"/accessors/0/sparse", sparse(1, 1, 5126, 0)},
      {"/accessors/0/sparse", sparse(1, 1, 5121, -1)},
      {"/accessors/0/sparse", sparse(2, 1, 5121, 3)},
      {"/scenes", Json::array({{{"nodes", {2}}}, 7})},
      {"/accessors/1/componentType", 5126},
      {"/accessors/1/count", 3},
      {"/accessors/2/count", 3},
      {"/accessors/3/count", 5},
      {"/accessors/4/count", 1},
      {"/bufferViews/0/byteOffset", 18446744073709551600ull},
      {"/bufferViews/0/byteLength", 18446744073709551600ull},
      {"/bufferViews/0/byteLength", 1},
      {"/bufferViews/0/byteStride", 4},
      {"/bufferViews/0/byteStride", -4},
      {"/bufferViews/0/byteStride", 12.5},
      {"/bufferViews/0/byteOffset", -4},
      {"/accessors/0/byteOffset", -12},
      {"/bufferViews/0/byteStride", 16},
      {"/bufferViews/0/byteStride", 18446744073709551600ull},
      {"/bufferViews/0/buffer", 1},
      {"/bufferViews/0/buffer", -1},
      {"/meshes/0/primitives/0/mode", 0},
      {"/meshes/0/primitives/0/mode", 1},
      {"/meshes/0/primitives/0/mode", 77},
      {"/meshes/0/primitives/0/indices", 99},
      {"/meshes/0/primitives/0/indices", 0},
      {"/meshes/0/primitives/0/attributes/POSITION", 99},
      {"/meshes/0/primitives/0/attributes/POSITION", -2},
      {"/meshes/0/primitives/0/attributes/JOINTS_0", 0},
      {"/meshes/0/primitives/0/attributes", {{"POSITION", 0}}},
      {"/meshes/0/primitives/0/attributes", {{"JOINTS_0", 1}, {"WEIGHTS_0", 2}}},
      {"/meshes/0/primitives", Json::array()},
      {"/meshes", Json::array()},
      {"/skins", Json::array()},
      {"/skins/0/joints", Json::array()},
      {"/skins/0/joints", {0}},
      {"/skins/0/joints", {0, 0}},
      {"/skins/0/joints", {0, 99}},
      {"/skins/0/joints", {-1, 0}},
      {"/skins/0/inverseBindMatrices", 0},
      {"/skins/0/inverseBindMatrices", 99},
      {"/nodes/2/skin", 9},
      {"/nodes/2/mesh", 9},
      {"/nodes/1/children", {0}},
      {"/nodes/1/children", {1}},
      {"/nodes/1/children", {44}},
      {"/nodes/1/children", {-3}},
      {"/nodes/2/children", {1}},
      {"/nodes/0/children", {1, 1}},
      {"/nodes/0/matrix", {1, 2, 3}},
      {"/nodes/0/rotation", {1, 2}},
      {"/nodes/1/translation", {1e300, 1e308, 1e308}},
      {"/nodes", 7},
  };
  for (const auto& [pointer, value] : patches) {
    GltfBlob blob = two_joint_square();
    blob.root["buffers"] = {{{"byteLength", blob.binary.size()}}};
    blob.root[Json::json_pointer(pointer)] = value;
    SCOPED_TRACE(pointer + " = " + value.dump());
    error_of(ErrorKind::file, [&] { read(blob, folder); });
  }
}

TEST(CharacterHostile, HostileNumbersAreErrors) {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::function<void(GltfBlob&)>& damage) {
    GltfBlob blob = two_joint_square();
    damage(blob);
    error_of(ErrorKind::file, [&] { read(blob, folder); });
  };
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    refuse([&](GltfBlob& b) {
      primitive(b)["attributes"]["POSITION"] = b.vectors({0, 0, 0, 1, bad, 0, 1, 2, 0, 0, 2, 0});
    });
    refuse([&](GltfBlob& b) {
      primitive(b)["attributes"]["WEIGHTS_0"] = b.quads({1, 0, 0, 0, bad, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
    });
    refuse([&](GltfBlob& b) {
      auto binds = identity_matrices(2);
      binds[3 + 16] = bad;
      b.root["skins"][0]["inverseBindMatrices"] = b.matrices(binds);
    });
  }
  refuse([](GltfBlob& b) { primitive(b)["attributes"]["POSITION"] = b.vectors(std::vector<float>(12, 1.0f)); });
  refuse([](GltfBlob& b) { primitive(b)["indices"] = b.add(std::vector<std::uint16_t>{0, 1, 4}, 5123, "SCALAR", 1); });
  refuse([](GltfBlob& b) { primitive(b)["indices"] = b.add(std::vector<std::uint16_t>{0, 1}, 5123, "SCALAR", 1); });
  refuse([](GltfBlob& b) { primitive(b)["indices"] = b.add(std::vector<std::uint16_t>{0, 1, 1}, 5123, "SCALAR", 1); });
  refuse([](GltfBlob& b) {
    primitive(b)["attributes"]["JOINTS_0"] = b.joints({2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  });
  refuse([](GltfBlob& b) { b.root["skins"][0]["inverseBindMatrices"] = b.matrices(std::vector<float>(32, 0.0f)); });
  refuse([](GltfBlob& b) { b.root["skins"][0]["inverseBindMatrices"] = b.matrices(std::vector<float>(32, 1.0f)); });
  // One accessor used a hundred thousand times asks for vast memory.
  refuse([](GltfBlob& b) {
    primitive(b)["attributes"]["POSITION"] = b.vectors(std::vector<float>(30000, 0.5f));
    const Json copy = primitive(b);
    for (int i = 0; i < 2000; ++i) b.root["meshes"][0]["primitives"].push_back(copy);
  });
}

TEST(CharacterHostile, DamagedBytesNeverCrash) {
  const TemporaryFolder folder;
  const std::string good = two_joint_square().glb();
  unsigned state = 7;
  const auto random = [&](std::size_t below) {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
  };
  int survived = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string bytes = good;
    for (std::size_t k = 0; k <= random(3); ++k) {
      bytes[20 + random(bytes.size() - 20)] = "0123456789-,:[]{}\"\xff\0eE."[random(22)];
    }
    put_bytes(folder / "d.glb", bytes);
    try {
      expect_valid(read_character(folder / "d.glb", 1));
      ++survived;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
    }
  }
  EXPECT_GT(survived, 10);
}

}  // namespace
}  // namespace bodyopt
