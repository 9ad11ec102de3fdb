#include "assets/gltf/fbx_materials.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/gltf/gltf_write.h"
#include "assets/gltf/surface_materials.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

// Returns where a file lies here whose name was written elsewhere. It is looked up as written, beside the FBX file, and
// in folders of its images.
std::string image_uri(const FbxObject& texture, const fs::path& path) {
  std::string written = texture.node->child("RelativeFilename").text(0);
  if (written.empty()) written = texture.node->child("FileName").text(0);
  std::ranges::replace(written, '\\', '/');
  const std::string name = fs::path(written).filename().string();
  std::string uri = name;
  for (const std::string& place : {written, name, path.stem().string() + ".fbm/" + name, "textures/" + name}) {
    std::error_code absent;
    if (fs::path(place).is_absolute() || place.starts_with("..")) continue;
    if (!fs::is_regular_file(path.parent_path() / place, absent)) continue;
    uri = place;
    break;
  }
  for (std::size_t at = uri.find('%'); at != std::string::npos; at = uri.find('%', at + 1)) uri.insert(at + 1, "25");
  return uri;
}

// The image that a text file has as base64, in any number of pieces; empty: it has none.
std::string image_as_data_uri(const FbxNode& content) {
  std::string base64;
  for (const FbxValue& value : content.values) {
    if (const auto* const piece = std::get_if<std::string>(&value)) base64 += *piece;
  }
  const bool is_image = base64.starts_with("iVBORw0KGgo") || base64.starts_with("/9j/") || base64.starts_with("UklGR");
  return is_image ? "data:application/octet-stream;base64," + base64 : "";
}

// The number of its texture among those of `glb`. `known`: by texture, and by video whose image the file holds. What is
// no image is taken from the file of its name.
std::size_t texture_number(const FbxScene& scene, const FbxObject& texture, const fs::path& path,
                           std::map<std::int64_t, std::size_t>& known, GlbWriter& glb) {
  const auto [own, is_new] = known.try_emplace(texture.id, glb.root["textures"].size());
  if (!is_new) return own->second;
  Json image = {{"name", texture.name}};
  for (const FbxObject* video : scene.into(texture.id, "Video")) {
    const FbxNode* const content = video->node->find("Content");
    if (content == nullptr) continue;
    const std::string bytes = content->text(0);
    const bool is_image = !image_type(bytes).empty();
    const std::string uri = is_image ? "" : image_as_data_uri(*content);
    if (!is_image && uri.empty()) continue;
    const auto [shared, is_first] = known.try_emplace(video->id, own->second);
    if (!is_first) return own->second = shared->second;
    if (is_image) {
      image["bufferView"] = glb.add_bytes(bytes);
    } else {
      image["uri"] = uri;
    }
    break;
  }
  if (image.size() == 1) image["uri"] = image_uri(texture, path);
  glb.root["textures"].push_back({{"source", glb.root["images"].size()}});
  glb.root["images"].push_back(image);
  return own->second;
}

}  // namespace

std::map<std::int64_t, std::size_t> add_fbx_materials(const FbxScene& scene, const fs::path& path, GlbWriter& glb) {
  std::map<std::int64_t, std::size_t> numbers, known;
  for (const FbxObject& material : scene.objects()) {
    if (material.kind != "Material") continue;
    Json base = {{"metallicFactor", 0}};
    if (const auto textures = scene.into(material.id, "Texture", "DiffuseColor"); !textures.empty()) {
      base["baseColorTexture"]["index"] = texture_number(scene, *textures.front(), path, known, glb);
    } else {
      const Vec3 colour =
          scene.number(material, "DiffuseFactor", 1) * scene.vector(material, "DiffuseColor", {1, 1, 1});
      const auto share = [&](std::size_t k) { return std::clamp(colour[k], 0.0, 1.0); };
      base["baseColorFactor"] = {share(0), share(1), share(2), 1};
    }
    numbers[material.id] = glb.root["materials"].size();
    glb.root["materials"].push_back({{"name", material.name}, {"pbrMetallicRoughness", base}});
  }
  return numbers;
}

}  // namespace bodyopt
