#include "runtime/basis/attachments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "runtime/basis/containers.h"
#include "runtime/basis/table_checks.h"
#include "runtime/basis/table_file.h"
#include "runtime/core/json.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

// Attachments as safetensors: per mesh one tensor per array of attachments.h, named attached.<mesh>.<array>; names and
// what they are bound to as metadata.

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

constexpr std::size_t kMostVertices = std::size_t{1} << 26;  // of one mesh

[[noreturn]] void refuse_owner(const std::string& origin, const std::string& basis_name, const auto&... what) {
  throw Error(ErrorKind::mismatch, origin, ": is not attached to ", basis_name, ": ", what...,
              " (another character, or edited since? Remove the file and attach the meshes anew)");
}

// Checks a mesh by itself.
class MeshValidator : TableChecks {
 public:
  MeshValidator(const AttachedMesh& mesh, const std::string& origin) : TableChecks(origin), mesh_(mesh) {}

  void run() const {
    if (mesh_.name != attachment_name(mesh_.name)) refuse("its name is none that a file can have");
    if (mesh_.rest.empty() || mesh_.rest.size() % 3 != 0 || mesh_.vertex_count() > kMostVertices) {
      refuse("rest has ", mesh_.rest.size(), " entries, expected three to a vertex, of 1 to 2^26");
    }
    expect_numbers("rest", mesh_.rest);
    if (mesh_.triangles.size() % 3 != 0) refuse("triangles is not of three corners each");
    expect_below("triangles", mesh_.triangles, mesh_.vertex_count());
    expect_size("vertex_anchor", mesh_.vertex_anchor.size(), mesh_.vertex_count());
    expect_below("vertex_anchor", mesh_.vertex_anchor, mesh_.anchors.size());
    expect_offsets("point_begin", mesh_.point_begin, mesh_.anchors.size(), mesh_.points.size());
    for (std::size_t k = 0; k < mesh_.anchors.size(); ++k) {
      const AttachmentAnchor& anchor = mesh_.anchors[k];
      for (const float x : {anchor.x, anchor.y, anchor.z}) expect_number("anchors", k, static_cast<double>(x));
    }
    for (std::size_t k = 0; k < mesh_.points.size(); ++k) check_weights(k);
  }

 private:
  void check_weights(std::size_t k) const {
    const SurfacePoint& point = mesh_.points[k];
    float sum = 0;
    for (const float weight : {point.wa, point.wb, point.wc}) {
      expect_number("points", k, static_cast<double>(weight));
      if (weight < -kWeightTolerance) refuse(element("points", k), " has a weight below 0");
      sum += weight;
    }
    if (std::abs(sum - 1) > kWeightTolerance) {
      refuse(element("points", k), " has weights that add up to ", sum, ", expected 1");
    }
  }

  const AttachedMesh& mesh_;
};

// Checks a mesh against a basis.
class BindingValidator : TableChecks {
 public:
  BindingValidator(const AttachedMesh& mesh, const Basis& basis, const std::string& origin,
                   const std::string& basis_name)
      : TableChecks(origin), mesh_(mesh), basis_(basis), origin_(origin), basis_name_(basis_name) {
    const std::vector<float>& rest = basis.mesh.rest;
    const auto [low, high] = std::minmax_element(rest.begin(), rest.end());
    if (!rest.empty()) tolerance_ = kSamePlace * static_cast<double>(*high - *low);
    shown_.assign(basis.mesh.vertex_count(), false);
    for (const std::uint32_t v : basis.mesh.output_vertex) shown_[v] = true;
  }

  void run() const {
    for (std::size_t k = 0; k < mesh_.points.size(); ++k) {
      const std::array corners = {mesh_.points[k].a, mesh_.points[k].b, mesh_.points[k].c};
      expect_below("points", corners, basis_.mesh.vertex_count());
      for (const std::uint32_t v : corners) {
        if (!shown_[v]) refuse(element("points", k), " is on a vertex that the basis does not put out");
      }
    }
    for (std::size_t k = 0; k < mesh_.anchors.size(); ++k) {
      expect_below("anchors", std::array{mesh_.anchors[k].joint}, basis_.skeleton.size());
      if (mesh_.point_begin[k] < mesh_.point_begin[k + 1]) check_place(k);
    }
  }

 private:
  void check_place(std::size_t k) const {
    const AttachmentAnchor& anchor = mesh_.anchors[k];
    const float centre[3] = {anchor.x, anchor.y, anchor.z};
    const double count = mesh_.point_begin[k + 1] - mesh_.point_begin[k];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto rest = [&](std::uint32_t v) { return static_cast<double>(basis_.mesh.rest[3 * std::size_t{v} + i]); };
      double x = 0;
      for (std::uint32_t p = mesh_.point_begin[k]; p < mesh_.point_begin[k + 1]; ++p) {
        const SurfacePoint& point = mesh_.points[p];
        x += static_cast<double>(point.wa) * rest(point.a) + static_cast<double>(point.wb) * rest(point.b) +
             static_cast<double>(point.wc) * rest(point.c);
      }
      if (std::abs(x / count - static_cast<double>(centre[i])) <= tolerance_) continue;
      refuse_owner(origin_, basis_name_, "its skin stands elsewhere at rest");
    }
  }

  const AttachedMesh& mesh_;
  const Basis& basis_;
  const std::string &origin_, &basis_name_;
  double tolerance_ = 0;     // metres
  std::vector<bool> shown_;  // V: is among the output vertices
};

void expect_owner(const Attachments& attachments, const char* key, std::uint64_t hash, const std::string& what,
                  const std::string& origin, const std::string& basis_name) {
  const auto found = attachments.metadata.find(key);
  if (found == attachments.metadata.end()) {
    throw Error(ErrorKind::file, origin, ": its metadata lack '", key, "' (damaged, or made by a defective program)");
  }
  if (found->second == hexadecimal(hash)) return;
  refuse_owner(origin, basis_name, "the ", what, " is another");
}

std::string origin_of(const AttachedMesh& mesh, const std::string& origin) {
  return origin + ", mesh '" + mesh.name + "'";
}

bool is_refused_by_files(char c) {
  return static_cast<unsigned char>(c) < 32 || c == 127 || std::string("/\\:*?\"<>|").find(c) != std::string::npos;
}

Attachments tables_in(const Safetensors& file, const std::filesystem::path& path) {
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

Attachments load_attachments(const std::filesystem::path& path) { return tables_in(read_safetensors(path), path); }

Attachments load_attachments(const std::filesystem::path& path, const Basis& basis, const std::string& basis_name) {
  Attachments attachments = load_attachments(path);
  validate(attachments, basis, path.string(), basis_name);
  return attachments;
}

Attachments attachments_in(const Safetensors& file, const std::filesystem::path& path, const Basis& basis) {
  Attachments attachments = tables_in(file, path);
  validate(attachments, basis, path.string());
  return attachments;
}

std::filesystem::path attachments_beside(std::filesystem::path basis) {
  return basis.replace_extension(".attached.safetensors");
}

std::string attachment_name(const std::string& name) {
  std::string result = name;
  std::size_t size = std::min(result.size(), kLongestAttachedName);
  while (size < result.size() && size > 0 && (static_cast<unsigned char>(result[size]) & 0xC0) == 0x80) --size;
  result.resize(size);
  std::ranges::replace_if(result, is_refused_by_files, '_');
  return result.empty() ? "_" : result;
}

void validate(const Attachments& attachments, const std::string& origin) {
  if (attachments.meshes.size() > kMostAttachedMeshes) {
    throw Error(ErrorKind::file, origin, ": has ", attachments.meshes.size(), " meshes, expected at most ",
                kMostAttachedMeshes);
  }
  std::set<std::string> names;
  for (const AttachedMesh& mesh : attachments.meshes) {
    MeshValidator(mesh, origin_of(mesh, origin)).run();
    if (names.insert(mesh.name).second) continue;
    throw Error(ErrorKind::file, origin, ": has two meshes called '", mesh.name, "', expected each name once");
  }
}

void validate(const Attachments& attachments, const Basis& basis, const std::string& origin,
              const std::string& basis_name) {
  validate(attachments, origin);
  expect_owner(attachments, "topology_hash", topology_hash(basis.mesh), "mesh", origin, basis_name);
  expect_owner(attachments, "skeleton_hash", skeleton_hash(basis.skeleton), "skeleton", origin, basis_name);
  for (const AttachedMesh& mesh : attachments.meshes) {
    const std::string where = origin_of(mesh, origin);
    BindingValidator(mesh, basis, where, basis_name).run();
  }
}

}  // namespace bodyopt
