#include "assets/fbx_materials.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/gltf_write.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

std::string text_in(const FbxObject& object, const char* name) {
  const FbxNode* found = object.node->find(name);
  return found == nullptr ? "" : found->text(0);
}

// The name of a file that was written elsewhere, where it lies here: as written, beside the FBX file, or in a folder of
// its images.
std::string image_uri(const FbxObject& texture, const fs::path& path) {
  std::string written = text_in(texture, "RelativeFilename");
  if (written.empty()) written = text_in(texture, "FileName");
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

Json image_of(const FbxScene& scene, const FbxObject& texture, const fs::path& path, GlbWriter& glb) {
  for (const FbxObject* video : scene.into(texture.id, "Video")) {
    const std::string content = text_in(*video, "Content");
    if (!content.empty() && video->node->find("Content")->values.size() == 1) {
      return {{"name", texture.name}, {"bufferView", glb.add_bytes(content)}};
    }
  }
  return {{"name", texture.name}, {"uri", image_uri(texture, path)}};
}

}  // namespace

std::map<std::int64_t, std::size_t> add_fbx_materials(const FbxScene& scene, const fs::path& path, GlbWriter& glb) {
  std::map<std::int64_t, std::size_t> numbers;
  for (const FbxObject& material : scene.objects()) {
    if (material.kind != "Material") continue;
    Json base = {{"metallicFactor", 0}};
    if (const auto textures = scene.into(material.id, "Texture", "DiffuseColor"); !textures.empty()) {
      const Json image = image_of(scene, *textures.front(), path, glb);  // before a list that it may move
      glb.root["images"].push_back(image);
      const std::size_t source = glb.root["images"].size() - 1;
      base["baseColorTexture"]["index"] = glb.root["textures"].size();
      glb.root["textures"].push_back({{"source", source}});
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
