// The materials of a glTF file and their images, which nobody vouches for: what is wrong with them is left out.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "assets/gltf/gltf_file.h"
#include "runtime/core/json.h"

namespace bodyopt {

// An image as its file has it, PNG, JPEG or WebP by its first bytes, and how it is sampled.
struct SurfaceTexture {
  std::string name;                          // of the image
  std::string type;                          // "image/png"
  std::shared_ptr<const std::string> bytes;  // of one image the same
  Json sampler;                              // as glTF has it, checked; what it leaves out is as usual
};
inline constexpr int kNearest = 9728, kLinear = 9729, kClamped = 33071, kMirrored = 33648;  // in samplers

struct SurfaceMaterial {
  std::string name;
  // The material as glTF has it, checked, without what only some programs know (clear coats and such). Its textures are
  // numbers of a surface's textures, and are all sampled at the coordinates of the base colour's.
  Json gltf = Json::object();

  std::array<double, 4> colour() const;  // base colour, linear, with alpha
  // The base colour's texture; or null.
  const Json* texture() const;
  std::string alpha_mode() const;  // OPAQUE, MASK or BLEND
  double number(const char* key, double otherwise) const;
};

// How the coordinates of a texture are turned into those of its image (KHR_texture_transform): u' = row . (u, v, 1).
using TextureTransform = std::array<std::array<double, 3>, 2>;
std::optional<TextureTransform> transform_of(const Json& texture);

// Calls `take` with each texture that a material of glTF names.
template <typename Take>
void for_each_texture(Json& gltf, Take take) {
  for (auto& [key, value] : gltf.items()) {
    if (key == "pbrMetallicRoughness") for_each_texture(value, take);
    if (key.ends_with("Texture")) take(value);
  }
}

// The set of coordinates (TEXCOORD_n) that a material's base colour is sampled at. Material -1 is none.
int base_texture_set(const GltfFile& file, int material);

// PNG, JPEG or WebP, by its first bytes; empty: of none.
std::string image_type(std::string_view bytes);

// Reads the materials of all surfaces of a file: an image is read once, and all share one limit.
class MaterialReader {
 public:
  explicit MaterialReader(const GltfFile& file) : file_(file) {}

  const GltfFile& file() const { return file_; }
  std::size_t count() const;
  // Its textures are added to `textures`, which lists those of a surface.
  SurfaceMaterial read(std::size_t index, std::vector<SurfaceTexture>& textures);
  // Names images that could not be read since the last call, one sentence each.
  std::vector<std::string> take_notes() { return std::exchange(notes_, {}); }
  // The images beside the file that were looked for since.
  std::vector<std::filesystem::path> take_files() { return std::exchange(files_, {}); }

 private:
  struct Image {
    std::string name, type;
    std::shared_ptr<const std::string> bytes;  // null: it cannot be read, and the notes tell why
  };
  void take_texture(const Json& from, const char* key, std::vector<SurfaceTexture>& textures, Json& to);
  // Null: it cannot be read.
  const SurfaceTexture* texture(const Json& index);
  const Image& image(std::size_t index);
  std::string image_bytes(const Json* image);

  const GltfFile& file_;
  std::vector<std::string> notes_;
  std::vector<std::filesystem::path> files_;
  std::map<std::size_t, std::optional<SurfaceTexture>> textures_;  // by number in the file; none: it cannot be read
  std::map<std::size_t, Image> images_;
  int set_ = 0;  // of the material that is read
  std::size_t bytes_left_ = std::size_t{1} << 30;
};

}  // namespace bodyopt
