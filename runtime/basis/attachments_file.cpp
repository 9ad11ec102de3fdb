// Attachments as safetensors: per mesh one tensor per array of attachments.h, named attached.<mesh>.<array>; names and
// what they are bound to as metadata.
#include <nlohmann/json.hpp>

#include "runtime/basis/attachments.h"
#include "runtime/basis/table_file.h"
#include "runtime/core/strict_json.h"

namespace bodyopt {
namespace {

constexpr const char* kAttachmentsSchema = "bodyopt-attached-1";

// Applies `visit(name, array, values to a row)` to every array of mesh k.
template <typename Mesh, typename Visit>
void for_each_array(Mesh& mesh, std::size_t k, Visit visit) {
  const std::string table = "attached." + std::to_string(k) + ".";
  visit(table + "rest", mesh.rest, 3);
  visit(table + "triangles", mesh.triangles, 3);
  visit(table + "vertex_anchor", mesh.vertex_anchor, 1);
  visit(table + "anchors", mesh.anchors, 1);
  visit(table + "point_begin", mesh.point_begin, 1);
  visit(table + "points", mesh.points, 1);
}

std::string list_text(const Attachments& attachments, const std::filesystem::path& path) {
  Json list = Json::array();
  for (const AttachedMesh& mesh : attachments.meshes) list.push_back({{"name", mesh.name}, {"bound", mesh.bound}});
  return strict_json_text(list, path.string());
}

std::vector<AttachedMesh> named_meshes(const TableReader& reader, const std::filesystem::path& path) {
  const auto list = parse_strict_json(reader.metadata("meshes"), path.string() + ", metadata 'meshes'");
  const auto is_text = [](const Json& entry, const char* key) {
    return entry.contains(key) && entry.at(key).is_string();
  };
  std::vector<AttachedMesh> meshes;
  if (!list.is_array()) reader.refuse("its metadata 'meshes' is not a list");
  for (const Json& entry : list) {
    if (!entry.is_object() || !is_text(entry, "name") || !is_text(entry, "bound")) {
      reader.refuse("its metadata 'meshes' has an entry without the texts 'name' and 'bound'");
    }
    meshes.emplace_back();
    meshes.back().name = entry.at("name");
    meshes.back().bound = entry.at("bound");
  }
  return meshes;
}

}  // namespace

void save_attachments(const Attachments& attachments, const std::filesystem::path& path) {
  validate(attachments, "the attachments to be saved");
  Safetensors file;
  file.metadata = attachments.metadata;
  for (std::size_t k = 0; k < attachments.meshes.size(); ++k) {
    for_each_array(attachments.meshes[k], k, [&](const std::string& name, const auto& values, std::uint64_t width) {
      file.tensors[name] = tensor_from(values, width);
    });
  }
  file.metadata["schema"] = kAttachmentsSchema;
  file.metadata["meshes"] = list_text(attachments, path);
  file.metadata["checksum"] = content_checksum(file);
  write_safetensors(file, path);
}

Attachments load_attachments(const std::filesystem::path& path) {
  const Safetensors file = read_safetensors(path);
  TableReader reader(file, path, "attached geometry");
  reader.require_schema(kAttachmentsSchema);
  Attachments attachments;
  attachments.meshes = named_meshes(reader, path);
  for (std::size_t k = 0; k < attachments.meshes.size(); ++k) {
    for_each_array(attachments.meshes[k], k, [&](const std::string& name, auto& values, std::uint64_t width) {
      reader.read(name, values, width);
    });
  }
  reader.refuse_unknown_tensors();
  attachments.metadata = file.metadata;
  for (const char* own : {"schema", "checksum", "meshes"}) attachments.metadata.erase(own);
  validate(attachments, path.string());
  return attachments;
}

Attachments load_attachments(const std::filesystem::path& path, const Basis& basis, const std::string& basis_name) {
  Attachments attachments = load_attachments(path);
  validate(attachments, basis, path.string(), basis_name);
  return attachments;
}

std::filesystem::path attachments_beside(std::filesystem::path basis) {
  return basis.replace_extension(".attached.safetensors");
}

}  // namespace bodyopt
