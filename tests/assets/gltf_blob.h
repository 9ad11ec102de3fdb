// Builds glTF files by hand, independently of the writer under test, right or wrong on purpose.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {

inline void put_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// Runs `read`, which must throw an Error of `kind`; returns its text.
inline std::string error_of(ErrorKind kind, const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

inline bool mentions(const std::vector<std::string>& notes, const std::string& text) {
  for (const std::string& note : notes) {
    if (note.find(text) != std::string::npos) return true;
  }
  return false;
}

struct GltfBlob {
  Json root = {{"asset", {{"version", "2.0"}}}};
  std::string binary;

  template <class T>
  std::size_t add(const std::vector<T>& values, int component_type, const std::string& type, std::size_t components,
                  bool normalized = false) {
    const std::size_t bytes = values.size() * sizeof(T);
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes}});
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", component_type},
                                 {"normalized", normalized},
                                 {"count", values.size() / components},
                                 {"type", type}});
    binary.append(reinterpret_cast<const char*>(values.data()), bytes);
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    return root["accessors"].size() - 1;
  }
  std::size_t scalars(const std::vector<float>& values) { return add(values, 5126, "SCALAR", 1); }
  std::size_t vectors(const std::vector<float>& values) { return add(values, 5126, "VEC3", 3); }
  std::size_t quads(const std::vector<float>& values) { return add(values, 5126, "VEC4", 4); }
  std::size_t matrices(const std::vector<float>& values) { return add(values, 5126, "MAT4", 16); }
  std::size_t joints(const std::vector<std::uint8_t>& values) { return add(values, 5121, "VEC4", 4); }

  std::string glb() const {
    Json full = root;
    if (!full.contains("buffers")) full["buffers"] = {{{"byteLength", binary.size()}}};
    return glb_of(full.dump(), binary);
  }

  static std::string glb_of(std::string json, const std::string& binary) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t value) {
      const auto narrow = static_cast<std::uint32_t>(value);
      std::string bytes(4, '\0');
      std::memcpy(bytes.data(), &narrow, 4);
      return bytes;
    };
    return "glTF" + word(2) + word(28 + json.size() + binary.size()) + word(json.size()) + "JSON" + json +
           word(binary.size()) + std::string("BIN\0", 4) + binary;
  }
};

// Adds a channel to the first animation, which must be there.
inline void animate(GltfBlob& blob, int node, const std::string& path, const std::vector<float>& times,
                    const std::vector<float>& values, const std::string& interpolation = "LINEAR") {
  const std::size_t input = blob.scalars(times);
  const std::size_t output = path == "rotation" ? blob.quads(values) : blob.vectors(values);
  Json& animation = blob.root["animations"][0];  // which more keys of the root would move
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
}

inline std::vector<float> identity_matrices(std::size_t count) {
  std::vector<float> values;
  for (std::size_t i = 0; i < 16 * count; ++i) values.push_back(i % 16 % 5 == 0 ? 1.0f : 0.0f);
  return values;
}

// A square of four vertices in the xy plane on two joints, "root" (at the origin) and its child "tip" (at y = 1).
inline GltfBlob two_joint_square() {
  GltfBlob blob;
  const std::size_t position = blob.vectors({0, 0, 0, 1, 0, 0, 1, 2, 0, 0, 2, 0});
  const std::size_t joints = blob.joints({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
  const std::size_t weights = blob.quads({1, 0, 0, 0, 0.75f, 0.25f, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 0});
  const std::size_t indices = blob.add(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 1);
  std::vector<float> binds = identity_matrices(2);
  binds[16 + 13] = -1;
  const std::size_t inverse_binds = blob.matrices(binds);
  blob.root["nodes"] = {{{"name", "root"}, {"children", {1}}},
                        {{"name", "tip"}, {"translation", {0, 1, 0}}},
                        {{"name", "square"}, {"mesh", 0}, {"skin", 0}}};
  blob.root["meshes"] = {{{"primitives",
                           {{{"attributes", {{"POSITION", position}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}},
                             {"indices", indices}}}}}};
  blob.root["skins"] = {{{"joints", {0, 1}}, {"inverseBindMatrices", inverse_binds}}};
  return blob;
}

}  // namespace bodyopt
