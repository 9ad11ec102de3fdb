// The materials of a glTF file and their images, which nobody vouches for: what is wrong with them is left out.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assets/gltf_file.h"
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
  // As glTF has it, checked, without what only some know (clear coats and such). Its textures are numbers of a
  // surface's textures, and are all sampled at the coordinates of the base colour's.
  Json gltf = Json::object();

  std::array<double, 4> colour() const;  // base colour, linear, with alpha
  // Of the base colour; or null.
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

// Which set of coordinates (TEXCOORD_n) the base colour of a material is sampled at. Material -1 is none.
int base_texture_set(const GltfFile& file, int material);

class MaterialReader {
 public:
  // Textures are added to `textures`; of images that cannot be read `notes` tell.
  MaterialReader(const GltfFile& file, std::vector<SurfaceTexture>& textures, std::vector<std::string>& notes)
      : file_(file), textures_(textures), notes_(notes) {}

  std::size_t count() const;
  SurfaceMaterial read(std::size_t index);

 private:
  struct Image {
    std::string name, type;
    std::shared_ptr<const std::string> bytes;  // null: it cannot be read, and the notes tell why
  };
  void take_texture(const Json& from, const char* key, Json& to);
  std::optional<std::size_t> texture(const Json& index);
  const Image& image(std::size_t index);
  std::string image_bytes(const Json* image) const;

  const GltfFile& file_;
  std::vector<SurfaceTexture>& textures_;
  std::vector<std::string>& notes_;
  std::map<std::size_t, std::optional<std::size_t>> known_;  // by number in the file
  std::map<std::size_t, Image> images_;
  int set_ = 0;  // of the material that is read
  std::size_t bytes_left_ = std::size_t{1} << 30;
};

}  // namespace bodyopt
