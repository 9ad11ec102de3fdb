#include "cli/results/attachments.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/core/transformed.h"

namespace bodyopt::cli {

namespace fs = std::filesystem;

Attachments attachments_in(const fs::path& path, const Basis& basis, const std::string& basis_name) {
  if (fs::exists(path)) return load_attachments(path, basis, basis_name);
  Attachments none;
  none.metadata["topology_hash"] = hexadecimal(topology_hash(basis.mesh));
  none.metadata["skeleton_hash"] = hexadecimal(skeleton_hash(basis.skeleton));
  return none;
}

std::vector<AttachedMesh> bind_meshes(const std::vector<trainer::LooseMesh>& meshes, const Basis& basis,
                                      const trainer::AttachOptions& options) {
  const trainer::RestSkin skin(basis);
  return transformed(meshes, [&](const trainer::LooseMesh& mesh) { return trainer::bind_mesh(mesh, skin, options); });
}

Attachments attach(const std::vector<AttachedMesh>& meshes, const fs::path& path, const Basis& basis,
                   const std::string& basis_name) {
  const FileLock lock = lock_to_change(path);
  Attachments attachments = attachments_in(path, basis, basis_name);
  for (const AttachedMesh& mesh : meshes) {
    const auto same = std::ranges::find(attachments.meshes, mesh.name, &AttachedMesh::name);
    if (same == attachments.meshes.end()) {
      attachments.meshes.push_back(mesh);
    } else {
      *same = mesh;
    }
  }
  save_attachments(attachments, path);
  return attachments;
}

std::string describe(const std::vector<AttachedMesh>& meshes) {
  std::string text;
  for (const AttachedMesh& mesh : meshes) {
    text += format("attached {}, {} vertices: {}\n", mesh.name, mesh.vertex_count(), mesh.bound);
  }
  return text;
}

Json to_json(const std::vector<AttachedMesh>& meshes) {
  return transformed(meshes, [&](const AttachedMesh& mesh) {
    return Json{{"name", mesh.name},
                {"vertices", mesh.vertex_count()},
                {"triangles", mesh.triangle_count()},
                {"bound", mesh.bound}};
  });
}

std::vector<AttachedMesh> attach_own_meshes(const fs::path& character, double unit, std::size_t skin_vertices,
                                            const Basis& basis, const fs::path& basis_path) {
  try {
    std::vector<std::string> notes;
    const std::vector<trainer::LooseMesh> meshes =
        trainer::read_loose_meshes(GltfFile(character), basis.skeleton, skin_vertices, unit > 0 ? unit : 1, notes);
    std::vector<AttachedMesh> bound = trainer::bind_own_meshes(meshes, basis, notes);
    say(notes);
    if (bound.empty()) return {};
    attach(bound, attachments_beside(basis_path), basis, basis_path.string());
    return bound;
  } catch (const Error& error) {
    spdlog::warn("the character's other meshes are not attached: {}", error.what());
    return {};
  }
}

}  // namespace bodyopt::cli
