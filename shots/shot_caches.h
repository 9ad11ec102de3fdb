// The caches of a shot: PC2, USD or glTF of its skin, and one of each attached mesh.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "assets/cache_writer.h"
#include "runtime/core/executor.h"
#include "runtime/host/attachments.h"
#include "shots/shot.h"

namespace bodyopt {

// Where to, and in which form.
struct CacheChoice {
  std::string out;         // .pc2, .usda or .glb
  bool full_skin = false;  // of a proxy: the skin of the full character
  CacheSpace space{};      // of .pc2
};

// Throws Error(usage) for what the format that `out` names cannot hold.
void require_form(const CacheChoice& choice);

class ShotCaches : public SkinSink {
 public:
  // The shot must outlive it, and stay where it is. Attached meshes get shot.<mesh>.pc2 beside shot.pc2. Throws
  // Error(usage) where there is no full skin to carry, and as write_cache().
  ShotCaches(const CacheChoice& choice, Shot& shot);

  void append(const Evaluation& part, std::span<const Pose> poses, std::size_t begin) override;
  // Puts them in place. Throws Error(file) where frames are missing.
  void close();

  std::size_t frames() const { return frames_; }  // that all of them hold
  std::uint32_t points() const { return points_; }
  // Of the attached meshes, in the order of the shot's.
  const std::vector<std::string>& attached_paths() const { return attached_paths_; }

  // Puts the frames so far aside in a folder, instead of close(), where no append() has failed; nothing more can be
  // written then. Returns the files.
  std::vector<std::filesystem::path> put_aside(const std::filesystem::path& folder);
  // Before any frame: the first `frames` are those that put_aside() left.
  void take_up(const std::filesystem::path& folder, std::size_t frames);

 private:
  std::vector<CacheWriter*> writers() const;  // of the skin, then of what is attached

  CacheChoice choice_;
  Shot& shot_;
  AttachmentCarrier carrier_;
  std::unique_ptr<CacheWriter> skin_;
  std::vector<std::unique_ptr<CacheWriter>> attached_;
  std::vector<std::string> attached_paths_;
  std::uint32_t points_ = 0;
  std::size_t frames_ = 0;
  std::unique_ptr<Executor> threads_;
};

}  // namespace bodyopt
