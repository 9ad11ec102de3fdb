#include "assets/gltf/gltf_guard.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "assets/fbx/fbx_parse.h"
#include "assets/gltf/fbx_glb.h"
#include "assets/gltf/gltf_meshopt.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/file_problem.h"
#include "runtime/core/json.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr int kMaxNesting = 64;
constexpr std::size_t kMaxBufferBytes = std::size_t{4} << 30;  // many buffers may name the same large file
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

[[noreturn]] void fail(const std::filesystem::path& path, const auto&... problem) {
  throw Error(ErrorKind::file, path, ": ", problem...);
}

struct Chunks {
  std::string json;
  Bytes binary;
};

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t word = 0;
  for (int i = 3; i >= 0; --i)
    word = word << 8 | static_cast<unsigned char>(bytes[offset + static_cast<std::size_t>(i)]);
  return word;
}

Chunks split_glb(const std::filesystem::path& path, std::string_view bytes) {
  if (bytes.size() < 20) fail(path, "the file ends inside its header; it is cut off");
  if (word_at(bytes, 4) != 2) {
    fail(path, "glTF container version ", word_at(bytes, 4), ", expected 2; export it as glTF 2.0");
  }
  if (word_at(bytes, 8) != bytes.size()) {
    fail(path, "its header says ", word_at(bytes, 8), " bytes, the file has ", bytes.size(),
         word_at(bytes, 8) > bytes.size() ? "; it is cut off or damaged"
                                          : "; something was appended to it, or it is damaged");
  }
  Chunks chunks;
  for (std::size_t offset = 12; offset < bytes.size();) {
    if (bytes.size() - offset < 8) fail(path, "a chunk header is cut off");
    const std::size_t length = word_at(bytes, offset);
    const std::uint32_t type = word_at(bytes, offset + 4);
    if (offset == 12 && type != kJsonChunk) fail(path, "its first chunk is not JSON");
    offset += 8;
    if (length > bytes.size() - offset) fail(path, "a chunk is longer than the file");
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(offset);
    const auto end = begin + static_cast<std::ptrdiff_t>(length);
    if (type == kJsonChunk && chunks.json.empty()) chunks.json.assign(begin, end);
    if (type == kBinaryChunk && chunks.binary.empty()) chunks.binary.assign(begin, end);
    offset += length;
  }
  return chunks;
}

// Is a brace the first that is neither white space nor the mark of UTF-8?
bool starts_an_object(std::string_view text) {
  text = without_mark(text);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{';
}

// Parses with a limit on nesting (destructors and tinygltf recurse), without extras.
Json parse_json(const std::filesystem::path& path, const std::string& text) {
  const auto filter = [&](int depth, Json::parse_event_t event, const Json& value) {
    if (depth > kMaxNesting) fail(path, "its JSON is nested deeper than 64 levels");
    return event != Json::parse_event_t::key || value != "extras";
  };
  try {
    return Json::parse(text, filter);
  } catch (const Json::exception& error) {
    fail(path, "its JSON cannot be read (", error.what(), "); not a glTF file, or damaged");
  }
}

void check_version(const std::filesystem::path& path, const Json& root) {
  if (!root.is_object() || !root.contains("asset") || !root["asset"].is_object() ||
      !root["asset"].contains("version") || !root["asset"]["version"].is_string()) {
    fail(path, "has no asset.version; it is not a glTF file");
  }
  const std::string version = root["asset"]["version"];
  if (version.rfind("2.", 0) != 0) fail(path, "glTF version ", version, ", expected 2.0; export it as glTF 2.0");
}

// Extensions that change only what is not read here (lights, what avatars do, how light meets a material) or that are
// read.
bool is_harmless(const std::string& extension) {
  constexpr const char* kBeginnings[] = {"KHR_materials_", "EXT_materials_", "ADOBE_materials_",
                                         "KHR_texture_",   "EXT_texture_",   "MSFT_texture_",
                                         "KHR_lights_",    "EXT_lights_",    "VRM",
                                         "KHR_xmp",        "KHR_audio",      "MSFT_lod"};
  return std::ranges::any_of(kBeginnings, [&](const char* beginning) { return extension.starts_with(beginning); }) ||
         extension == "KHR_mesh_quantization" || extension == "EXT_meshopt_compression";
}

bool names(const Json& root, const char* list, const char* extension) {
  return root.contains(list) && root[list].is_array() && std::ranges::find(root[list], extension) != root[list].end();
}

// Meshes compressed by Draco leave their accessors without data.
void check_compression(const std::filesystem::path& path, const Json& root) {
  constexpr const char* kDraco = "KHR_draco_mesh_compression";
  bool lacks_data = names(root, "extensionsRequired", kDraco);
  if (names(root, "extensionsUsed", kDraco) && root.contains("accessors") && root["accessors"].is_array()) {
    for (const Json& accessor : root["accessors"]) {
      lacks_data =
          lacks_data || (accessor.is_object() && !accessor.contains("bufferView") && !accessor.contains("sparse"));
    }
  }
  if (lacks_data) {
    fail(path, "its meshes are compressed by Draco (", kDraco,
         "), which is not read here; export it without that compression");
  }
}

void check_extensions(const std::filesystem::path& path, const Json& root) {
  if (!root.contains("extensionsRequired")) return;
  const Json& required = root["extensionsRequired"];
  if (!required.is_array()) fail(path, "extensionsRequired is not an array");
  for (const Json& extension : required) {
    if (extension.is_string() && is_harmless(extension)) continue;
    fail(path, "requires the extension ", extension.dump().substr(0, 80),
         ", which is not read here, and says that it cannot be read without; export it without that extension");
  }
}

// Refuses values that tinygltf would take as 0, as they are no numbers that may stand there.
void check_counts(const std::filesystem::path& path, const Json& root) {
  for (const char* list : {"bufferViews", "accessors"}) {
    if (!root.contains(list) || !root[list].is_array()) continue;  // tinygltf refuses what is no list
    for (std::size_t k = 0; k < root[list].size(); ++k) {
      for (const char* key : {"byteOffset", "byteLength", "byteStride", "count"}) {
        const Json& entry = root[list][k];
        if (!entry.is_object() || !entry.contains(key) || entry[key].is_number_unsigned()) continue;
        fail(path, key, " of ", list, " ", k, " is ", entry[key].dump().substr(0, 40),
             ", expected a whole number, 0 or above");
      }
    }
  }
}

std::string percent_decoded(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[i + 1])) &&
        std::isxdigit(static_cast<unsigned char>(uri[i + 2]))) {
      text += static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

Bytes resolve_buffer(const std::filesystem::path& path, const Json& buffer, const Bytes* binary) {
  if (!buffer.is_object() || !buffer.contains("byteLength") || !buffer["byteLength"].is_number_unsigned()) {
    fail(path, "a buffer has no byteLength");
  }
  const std::uint64_t length = buffer["byteLength"];
  Bytes bytes;
  if (!buffer.contains("uri")) {
    if (binary == nullptr && buffer.contains("extensions")) return bytes;  // what compressed views fill
    if (binary == nullptr) fail(path, "a buffer has no data (no uri and no BIN chunk)");
    bytes = *binary;
  } else if (!buffer["uri"].is_string()) {
    fail(path, "a buffer's uri is not a string");
  } else if (const std::string uri = buffer["uri"]; tinygltf::IsDataURI(uri)) {
    std::string mime;
    if (!tinygltf::DecodeDataURI(&bytes, mime, uri, 0, false)) fail(path, "a buffer's data URI cannot be decoded");
  } else {
    const std::filesystem::path beside = gltf_file_beside(path, "buffer", uri);
    if (!std::filesystem::exists(beside)) {
      fail(path, "its buffer '", uri, "' is missing: a .gltf file and the buffers beside it belong together");
    }
    const std::string content = read_gltf_bytes(beside);
    bytes.assign(content.begin(), content.end());
  }
  if (length > bytes.size()) {
    fail(path, "a buffer of ", length, " bytes has only ", bytes.size(), "; the file is cut off or damaged");
  }
  bytes.resize(length);
  return bytes;
}

void remove_extensions(Json& json) {
  if (json.is_object()) json.erase("extensions");
  for (Json& child : json) {
    if (child.is_structured()) remove_extensions(child);
  }
}

// Nothing for what does not lie beside it.
std::optional<std::filesystem::path> find_beside(const std::filesystem::path& path, const std::string& uri) {
  const std::filesystem::path relative = percent_decoded(uri);
  if (relative.is_absolute() || uri.find("://") != std::string::npos) return std::nullopt;
  std::error_code no_place;
  const std::filesystem::path folder = std::filesystem::weakly_canonical(std::filesystem::absolute(path)).parent_path();
  const std::filesystem::path file = std::filesystem::weakly_canonical(folder / relative, no_place);
  const auto [end, unused] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  if (no_place || end != folder.end()) return std::nullopt;
  return file;
}

}  // namespace

std::filesystem::path gltf_file_beside(const std::filesystem::path& path, const char* what, const std::string& uri) {
  if (const std::optional<std::filesystem::path> file = find_beside(path, uri)) return *file;
  fail(path, what, " '", uri, "' lies outside the file's folder; only files beside it are read");
}

std::string read_gltf_bytes(const std::filesystem::path& path) {
  return read_file(path, kMaxBufferBytes, "a glTF file");
}

GuardedGltf guard_gltf(const std::filesystem::path& path, std::string_view bytes) {
  if (is_fbx(bytes)) return guard_gltf(path, glb_of_fbx(path, bytes));
  const bool is_glb = bytes.starts_with("glTF");
  if (!is_glb && !starts_an_object(bytes)) {
    const bool should_be = path.extension() == ".glb" || path.extension() == ".vrm";
    fail(path,
         should_be ? "does not start with 'glTF'; it is not a .glb file"
                   : "is not a glTF file (.glb, .gltf), nor an FBX file",
         looks_like(path));
  }
  const Chunks chunks = is_glb ? split_glb(path, bytes) : Chunks{std::string(bytes.begin(), bytes.end()), {}};

  Json root = parse_json(path, chunks.json);
  check_version(path, root);
  check_compression(path, root);
  check_extensions(path, root);
  check_counts(path, root);

  GuardedGltf guarded;
  std::size_t buffer_bytes = 0;
  const Json buffers = root.contains("buffers") ? root["buffers"] : Json::array();
  if (!buffers.is_array()) fail(path, "buffers is not an array");
  try {
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      guarded.buffers.push_back(resolve_buffer(path, buffers[i], is_glb && i == 0 ? &chunks.binary : nullptr));
      buffer_bytes += guarded.buffers.back().size();
      if (buffer_bytes > kMaxBufferBytes) fail(path, "its buffers hold more than 4 GiB");
    }
  } catch (const std::filesystem::filesystem_error& error) {
    fail(path, "a buffer's file cannot be found: ", describe_refusal(error));
  }
  decompress_views(path, root, guarded.buffers);
  for (const char* key : {"materials", "textures", "samplers", "images", "cameras"}) {
    if (root.contains(key)) guarded.look[key] = std::move(root[key]);
    root.erase(key);
  }
  for (const char* key : {"buffers", "extensionsRequired", "extensionsUsed"}) root.erase(key);
  remove_extensions(root);
  guarded.json = root.dump(-1, ' ', false, Json::error_handler_t::replace);
  return guarded;
}

std::vector<std::filesystem::path> gltf_files(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files{path};
  const std::string extension = lower_case(path.extension().string());
  if (extension != ".gltf" && extension != ".fbx") return files;
  const std::string bytes = read_gltf_bytes(path);
  const Json root = extension == ".fbx" ? guard_gltf(path, bytes).look : parse_json(path, bytes);
  for (const char* kind : {"buffers", "images"}) {
    for (const Json& part : root.contains(kind) ? root[kind] : Json::array()) {
      if (!part.is_object() || !part.contains("uri") || !part["uri"].is_string()) continue;
      const std::string uri = part["uri"];
      if (uri.starts_with("data:")) continue;
      const std::optional<std::filesystem::path> file = find_beside(path, uri);
      const bool is_needed = std::string_view(kind) == "buffers";  // without an image a colour is shown
      std::error_code absent;
      if (file && (is_needed || std::filesystem::is_regular_file(*file, absent))) files.push_back(*file);
    }
  }
  return files;
}

}  // namespace bodyopt
