// The caches that `eval` writes of a shot, and what there is to say of its frames.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/results/attachments.h"
#include "cli/results/evaluation_log.h"
#include "farm/task_run.h"
#include "runtime/basis/levels.h"
#include "runtime/core/executor.h"

namespace bodyopt::cli {

// Of which character, where to, in which form.
struct ShotCacheOptions {
  std::string basis, out, attached;
  std::size_t level = 0;
  bool full_skin = false;
  CacheSpace space{};
};

// What a run is made of before its first frame. With dynamics, the deformer jiggles.
struct EvaluatedShot {
  std::unique_ptr<Deformer> deformer;
  CarriedSkin carried;
  Clip clip;
  std::vector<int> frames;
  std::vector<Pose> poses;
};

// Skin and attached meshes, frame by frame. Options and shot must outlive it.
class ShotCaches {
 public:
  ShotCaches(const ShotCacheOptions& options, EvaluatedShot& shot);

  // Frames begin, begin + 1, ...
  void append(const Evaluation& part, std::size_t begin);
  void close();

  // Leaves a checkpoint after the last frame that was appended, where there is none yet, and returns that many frames;
  // nothing more is written here then. 0 where no frame is new, or one was appended to some of the caches only.
  std::size_t put_aside(const TaskRun& task);
  // Goes on from a checkpoint, where there is one, and returns how many frames it holds.
  std::size_t take_up(const TaskRun& task);

  std::uint32_t points() const { return points_; }
  const EvaluationLog& log() const { return log_; }
  Json attached() const { return attached_.written(); }
  const std::vector<std::string>& attached_paths() const { return attached_.paths(); }

 private:
  const ShotCacheOptions& options_;
  EvaluatedShot& shot_;
  AttachedCaches attached_;
  std::unique_ptr<CacheWriter> skin_;
  std::uint32_t points_ = 0;
  EvaluationLog log_;
  std::size_t frames_ = 0, kept_ = 0;  // appended to all; those of a checkpoint
  bool is_whole_ = true;               // all caches hold that many frames, and are still open
  JiggleState state_;                  // after them, for when the device is lost
  std::unique_ptr<Executor> threads_;
};

}  // namespace bodyopt::cli
