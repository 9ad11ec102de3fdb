// Attached geometry as the verbs share it: its file beside the basis, and what is put into it.
#pragma once

#include "cli/arguments/common.h"
#include "runtime/basis/attachments.h"
#include "trainer/attach/bind_mesh.h"

namespace bodyopt::cli {

// Reads a file's attachments; none where it does not exist yet. Throws as load_attachments, of which see `basis_name`.
Attachments attachments_in(const std::filesystem::path& path, const Basis& basis, const std::string& basis_name);

std::vector<AttachedMesh> bind_meshes(const std::vector<trainer::LooseMesh>& meshes, const Basis& basis,
                                      const trainer::AttachOptions& options);

// Puts the meshes into a file, each in the place of one of its name, and returns all that is in it then. Alone: what
// other processes put there meanwhile stays. Throws as attachments_in().
Attachments attach(const std::vector<AttachedMesh>& meshes, const std::filesystem::path& path, const Basis& basis,
                   const std::string& basis_name);

// One line, and one JSON object, per mesh.
std::string describe(const std::vector<AttachedMesh>& meshes);
Json to_json(const std::vector<AttachedMesh>& meshes);

// After a training: attaches the character's further meshes, where its file has any, and writes them beside the basis.
// The basis is there by then: whatever is wrong is a warning. `unit`: that of the character, 0 for metres.
// `skin_vertices`: of the character's own skin, by which it is known, for a proxy has fewer.
std::vector<AttachedMesh> attach_own_meshes(const std::filesystem::path& character, double unit,
                                            std::size_t skin_vertices, const Basis& basis,
                                            const std::filesystem::path& basis_path);

}  // namespace bodyopt::cli
