// Attached geometry as the verbs share it: its file beside the basis, what is put into it, the caches of `eval`.
#pragma once

#include <memory>

#include "assets/cache_writer.h"
#include "cli/arguments/common.h"
#include "runtime/host/attachments.h"
#include "trainer/attach/bind_mesh.h"

namespace bodyopt::cli {

// Those of a file, or none yet where it is not there. Throws as load_attachments, of which see `basis_name`.
Attachments attachments_in(const std::filesystem::path& path, const Basis& basis, const std::string& basis_name);

std::vector<AttachedMesh> bind_meshes(const std::vector<LooseMesh>& meshes, const Basis& basis,
                                      const AttachOptions& options);

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

// What rides on the skin, frame by frame, as one cache per mesh, of the skin's format: shot.pc2, shot.<mesh>.pc2.
class AttachedCaches {
 public:
  // `file`: the attachments, empty for those beside the basis, where there are any. `basis_path`: empty where what lies
  // beside the file is not of this basis.
  AttachedCaches(const std::string& file, const std::filesystem::path& basis_path, const Basis& basis);

  void open(const std::filesystem::path& skin_cache, const std::vector<int>& frames, double fps,
            const CacheSpace& space);
  void append(std::span<const float> skin, const Pose& pose);
  void close();
  Json written() const;                                             // per mesh: name, points, cache
  const std::vector<std::string>& paths() const { return paths_; }  // of the caches

  // As CacheWriter, with files of all meshes.
  void put_aside(const std::filesystem::path& stem);
  void take_up(const std::filesystem::path& stem, std::size_t frames);
  std::vector<std::filesystem::path> aside(const std::filesystem::path& stem) const;

 private:
  Attachments attachments_;
  AttachmentCarrier carrier_;
  std::vector<std::string> paths_;
  std::vector<std::unique_ptr<CacheWriter>> writers_;
};

}  // namespace bodyopt::cli
