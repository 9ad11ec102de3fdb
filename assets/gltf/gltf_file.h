// Reads glTF 2.0 (.glb, .gltf), to which FBX is converted, from bytes that nobody vouches for. tinygltf parses. Chunk
// sizes, nesting, buffers and accessor ranges, which it trusts, are checked here, before and after.
#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/core/error.h"
#include "runtime/core/json.h"

namespace bodyopt {

class GltfFile {
 public:
  // Extras and extensions are not loaded. Buffers may be in the file, a data URI, or a file in the same folder. Throws
  // Error(file).
  explicit GltfFile(const std::filesystem::path& path);
  // Reads a file's bytes that are in memory already; messages call them `path`.
  GltfFile(const std::filesystem::path& path, std::string_view bytes);

  const tinygltf::Model& model() const { return model_; }
  // `materials`, `textures`, `samplers`, `images` and `cameras` as the file has them, unchecked; the model has none.
  const Json& look() const { return look_; }
  const std::filesystem::path& path() const { return path_; }
  bool is_of_fbx() const { return is_of_fbx_; }
  // Names what the scene does not show, one sentence each: its nodes draw nothing in the model.
  const std::vector<std::string>& notes() const { return notes_; }

  // The numbers of an accessor, count x components, normalised integers as reals, zeros where it has no data. `what`
  // names the accessor in messages; `type` is TINYGLTF_TYPE_*. Throws Error(file) at a wrong index, type or range, a
  // NaN or infinity. It also does for far more numbers than the file has bytes: small files may ask for vast memory.
  std::vector<double> numbers(int accessor, int type, const std::string& what) const;

  // Like numbers(), for unsigned integer accessors of joint and vertex indices.
  std::vector<std::uint32_t> indices(int accessor, int type, const std::string& what) const;

  // The bytes of a buffer view. Throws Error(file).
  std::span<const unsigned char> bytes(int buffer_view, const std::string& what) const;

  // Throws Error(file), the message starting with the path.
  [[noreturn]] void fail(const auto&... problem) const { throw Error(ErrorKind::file, path_, ": ", problem...); }

 private:
  struct Elements;
  const tinygltf::Accessor& accessor(int index, int type, const std::string& what) const;
  std::vector<double> decode(const Elements& elements, const std::string& what) const;
  std::vector<double> decode(const tinygltf::Accessor& accessor, const std::string& what) const;
  void keep_what_is_shown();

  std::filesystem::path path_;
  bool is_of_fbx_;
  tinygltf::Model model_;
  Json look_;
  std::vector<std::string> notes_;
  mutable std::size_t bytes_left_ = 0;  // how much more may be decoded
};

}  // namespace bodyopt
