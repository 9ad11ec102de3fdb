#include "assets/gltf/surface_materials.h"

#include <algorithm>
#include <cmath>

#include "assets/gltf/gltf_guard.h"
#include "runtime/basis/read_file.h"

namespace bodyopt {
namespace {

[[noreturn]] void refuse_image_of(const std::string& why) { throw Error(ErrorKind::file, why); }

// Null: it is not there.
const Json* member(const Json* json, const char* key) {
  if (json == nullptr || !json->is_object()) return nullptr;
  const auto found = json->find(key);
  return found == json->end() ? nullptr : &*found;
}

// An entry of a list of the file's; null: it is not there.
const Json* listed(const GltfFile& file, const char* list, std::size_t index) {
  const Json* all = member(&file.look(), list);
  return all != nullptr && all->is_array() && index < all->size() ? &(*all)[index] : nullptr;
}

std::optional<std::size_t> whole_number(const Json* json) {
  if (json == nullptr || !json->is_number_unsigned() || *json > 1'000'000) return std::nullopt;
  return json->get<std::size_t>();
}

bool is_within(const Json& json, double low, double high) { return json.is_number() && json >= low && json <= high; }

bool are_within(const Json& json, std::size_t count, double low, double high) {
  return json.is_array() && json.size() == count &&
         std::ranges::all_of(json, [&](const Json& number) { return is_within(number, low, high); });
}

void take_if(const Json* from, const char* key, Json& to, auto is_right) {
  const Json* value = member(from, key);
  if (value != nullptr && is_right(*value)) to[key] = *value;
}

bool is_switch(const Json& json) { return json.is_boolean(); }
bool is_share(const Json& json) { return is_within(json, 0, 1); }
bool is_moderate(const Json& json) { return is_within(json, -1e3, 1e3); }
bool is_pair(const Json& json) { return are_within(json, 2, -1e6, 1e6); }

const Json* transform_in(const Json* texture) { return member(member(texture, "extensions"), "KHR_texture_transform"); }

int texture_set(const Json* texture) {
  const auto own = whole_number(member(texture, "texCoord"));
  return static_cast<int>(whole_number(member(transform_in(texture), "texCoord")).value_or(own.value_or(0)));
}

// Old files give it by an extension of their time.
Json base_of(const Json* material) {
  const Json* old = member(member(material, "extensions"), "KHR_materials_pbrSpecularGlossiness");
  const Json* base = member(material, "pbrMetallicRoughness");
  if (old == nullptr) return base == nullptr ? Json() : *base;
  Json renamed = {{"metallicFactor", 0}};
  if (const Json* colour = member(old, "diffuseFactor")) renamed["baseColorFactor"] = *colour;
  if (const Json* texture = member(old, "diffuseTexture")) renamed["baseColorTexture"] = *texture;
  return renamed;
}

}  // namespace

std::array<double, 4> SurfaceMaterial::colour() const {
  const Json* factor = member(member(&gltf, "pbrMetallicRoughness"), "baseColorFactor");
  return factor == nullptr ? std::array<double, 4>{1, 1, 1, 1} : factor->get<std::array<double, 4>>();
}

const Json* SurfaceMaterial::texture() const {
  return member(member(&gltf, "pbrMetallicRoughness"), "baseColorTexture");
}

std::string SurfaceMaterial::alpha_mode() const { return gltf.value("alphaMode", "OPAQUE"); }

double SurfaceMaterial::number(const char* key, double otherwise) const {
  const Json* own = member(&gltf, key);
  const Json* value = own != nullptr ? own : member(member(&gltf, "pbrMetallicRoughness"), key);
  return value == nullptr ? otherwise : value->get<double>();
}

std::optional<TextureTransform> transform_of(const Json& texture) {
  const Json* given = transform_in(&texture);
  if (given == nullptr) return std::nullopt;
  const auto pair = [&](const char* key, double usual) { return given->value(key, std::array{usual, usual}); };
  const auto offset = pair("offset", 0), scale = pair("scale", 1);
  const double angle = given->value("rotation", 0.0), c = std::cos(angle), s = std::sin(angle);
  return TextureTransform{{{c * scale[0], s * scale[1], offset[0]}, {-s * scale[0], c * scale[1], offset[1]}}};
}

std::string image_type(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return "image/png";
  if (bytes.starts_with("\xff\xd8\xff")) return "image/jpeg";
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) return "image/webp";
  return "";
}

int base_texture_set(const GltfFile& file, int material) {
  if (material < 0) return 0;
  const Json base = base_of(listed(file, "materials", static_cast<std::size_t>(material)));
  return texture_set(member(&base, "baseColorTexture"));
}

std::size_t MaterialReader::count() const {
  const Json* all = member(&file_.look(), "materials");
  return all != nullptr && all->is_array() ? all->size() : 0;
}

SurfaceMaterial MaterialReader::read(std::size_t index, std::vector<SurfaceTexture>& textures) {
  const Json* given = listed(file_, "materials", index);
  SurfaceMaterial material{"material_" + std::to_string(index)};
  const Json* name = member(given, "name");
  if (name != nullptr && name->is_string() && !name->get<std::string>().empty()) material.name = *name;
  set_ = base_texture_set(file_, static_cast<int>(index));
  Json& gltf = material.gltf;
  take_if(given, "emissiveFactor", gltf, [](const Json& json) { return are_within(json, 3, 0, 1); });
  take_if(given, "doubleSided", gltf, is_switch);
  take_if(given, "alphaMode", gltf, [](const Json& json) { return json == "MASK" || json == "BLEND"; });
  if (gltf.contains("alphaMode")) take_if(given, "alphaCutoff", gltf, is_share);
  if (material.alpha_mode() == "MASK" && material.number("alphaCutoff", 0.5) == 0) {  // no alpha is lower: opaque
    gltf.erase("alphaMode");
    gltf.erase("alphaCutoff");
  }
  if (given == nullptr) return material;
  for (const char* key : {"normalTexture", "occlusionTexture", "emissiveTexture"})
    take_texture(*given, key, textures, gltf);
  const Json base = base_of(given);
  Json checked = Json::object();
  take_if(&base, "baseColorFactor", checked, [](const Json& json) { return are_within(json, 4, 0, 1); });
  for (const char* key : {"metallicFactor", "roughnessFactor"}) take_if(&base, key, checked, is_share);
  for (const char* key : {"baseColorTexture", "metallicRoughnessTexture"}) take_texture(base, key, textures, checked);
  if (!checked.empty()) gltf["pbrMetallicRoughness"] = checked;
  return material;
}

void MaterialReader::take_texture(const Json& from, const char* key, std::vector<SurfaceTexture>& textures, Json& to) {
  const Json* given = member(&from, key);
  const Json* index = member(given, "index");
  if (index == nullptr || texture_set(given) != set_) return;
  const SurfaceTexture* own = texture(*index);
  if (own == nullptr) return;
  const auto known = std::ranges::find_if(
      textures, [&](const SurfaceTexture& of) { return of.bytes == own->bytes && of.sampler == own->sampler; });
  Json& texture = to[key] = {{"index", static_cast<std::size_t>(known - textures.begin())}};
  if (known == textures.end()) textures.push_back(*own);
  for (const char* factor : {"scale", "strength"}) take_if(given, factor, texture, is_moderate);
  Json transform = Json::object();
  for (const char* part : {"offset", "scale"}) take_if(transform_in(given), part, transform, is_pair);
  take_if(transform_in(given), "rotation", transform, is_moderate);
  if (!transform.empty()) texture["extensions"]["KHR_texture_transform"] = transform;
}

const SurfaceTexture* MaterialReader::texture(const Json& index) {
  const std::optional<std::size_t> number = whole_number(&index);
  const Json* given = number ? listed(file_, "textures", *number) : nullptr;
  if (given == nullptr) return nullptr;
  const auto [known, is_new] = textures_.try_emplace(*number);
  std::optional<SurfaceTexture>& texture = known->second;
  if (!is_new) return texture ? &*texture : nullptr;
  const Json* webp = member(member(given, "extensions"), "EXT_texture_webp");
  const auto source = whole_number(member(webp != nullptr ? webp : given, "source"));
  if (!source) {
    notes_.push_back("Texture " + std::to_string(*number) +
                     " has no image in a format that is read (PNG, JPEG, WebP).");
    return nullptr;
  }
  const Image& from = image(*source);
  if (!from.bytes) return nullptr;
  Json sampler = Json::object();
  if (const auto of = whole_number(member(given, "sampler"))) {
    const Json* named = listed(file_, "samplers", *of);
    take_if(named, "magFilter", sampler, [](const Json& json) { return json == kNearest || json == kLinear; });
    for (const char* key : {"wrapS", "wrapT"}) {
      take_if(named, key, sampler, [](const Json& json) { return json == kClamped || json == kMirrored; });
    }
  }
  texture = SurfaceTexture{from.name, from.type, from.bytes, sampler};
  return &*texture;
}

const MaterialReader::Image& MaterialReader::image(std::size_t index) {
  const auto [known, is_new] = images_.try_emplace(index);
  Image& image = known->second;
  if (!is_new) return image;
  const Json* given = listed(file_, "images", index);
  const Json *name = member(given, "name"), *uri = member(given, "uri");
  image.name = "image_" + std::to_string(index);
  if (name != nullptr && name->is_string()) {
    image.name = *name;
  } else if (uri != nullptr && uri->is_string() && !uri->get_ref<const std::string&>().starts_with("data:")) {
    image.name = std::filesystem::path(uri->get<std::string>()).stem().string();
  }
  try {
    std::string bytes = image_bytes(given);
    if (bytes.size() > bytes_left_) refuse_image_of("the images take more than 1 GiB");
    bytes_left_ -= bytes.size();
    image.type = image_type(bytes);
    if (image.type.empty()) refuse_image_of("is neither PNG, JPEG nor WebP: damaged, or of another format");
    image.bytes = std::make_shared<const std::string>(std::move(bytes));
  } catch (const std::exception& error) {
    notes_.push_back(concat(file_.path(), ": image '", image.name, "': ", error.what(),
                            "; its material's colour is taken in its place"));
  }
  return image;
}

std::string MaterialReader::image_bytes(const Json* image) {
  const Json *view = member(image, "bufferView"), *uri = member(image, "uri");
  if (view != nullptr) {
    const auto bytes = file_.bytes(static_cast<int>(whole_number(view).value_or(1'000'001)), "its bytes");
    return {bytes.begin(), bytes.end()};
  }
  if (uri == nullptr || !uri->is_string()) refuse_image_of("it has neither a buffer view nor a URI");
  if (!uri->get_ref<const std::string&>().starts_with("data:")) {
    files_.push_back(gltf_file_beside(file_.path(), "image", *uri));
    return read_file(files_.back(), bytes_left_, "an image");
  }
  std::vector<unsigned char> bytes;
  std::string type;
  if (!tinygltf::IsDataURI(*uri) || !tinygltf::DecodeDataURI(&bytes, type, *uri, 0, false)) {
    refuse_image_of("its data URI cannot be decoded");
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace bodyopt
