#include "cli/results/shot_caches.h"

#include "runtime/deformer/evaluation.h"
#include "runtime/host/carry_skin.h"
#include "runtime/threads/tbb_executor.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

}  // namespace

ShotCaches::ShotCaches(const ShotCacheOptions& options, EvaluatedShot& shot)
    : options_(options),
      shot_(shot),
      attached_(options.attached, options.level == 0 ? options.basis : "", shot.deformer->basis()),
      threads_(make_tbb_executor()) {
  const MeshTable& mesh = shot.deformer->basis().mesh;
  points_ = options.full_skin ? static_cast<std::uint32_t>(shot.carried.size()) : mesh.output_count();
  skin_ = write_cache(options.out, {fs::path(options.basis).stem().string(), points_, mesh.output_triangles,
                                    shot.frames, shot.clip.fps, options.space});
  attached_.open(options.out, shot.frames, shot.clip.fps, options.space);
}

void ShotCaches::append(const Evaluation& part, std::size_t begin) {
  const Basis& basis = shot_.deformer->basis();
  const std::size_t own = 3 * std::size_t{basis.mesh.output_count()}, count = part.outside.size();
  std::vector<float> carried;
  if (options_.full_skin) {
    carried = carry_skin(basis.mesh, shot_.carried, part.positions, part.normals, *threads_);
  }
  const std::span<const float> skin = options_.full_skin ? carried : part.positions;
  const JiggleState state = shot_.deformer->state();
  is_whole_ = false;
  for (std::size_t k = 0; k < count; ++k) {
    std::span<const float> normals;
    if (!options_.full_skin && !part.normals.empty()) normals = std::span(part.normals).subspan(k * own, own);
    skin_->append(skin.subspan(3 * k * points_, 3 * std::size_t{points_}), normals);
    attached_.append(std::span(part.positions).subspan(k * own, own), shot_.poses[begin + k]);
    log_.add(*shot_.deformer, part, k, shot_.frames[begin + k], state.motion);
  }
  log_.add_times(part);
  state_ = state;
  frames_ += count;
  is_whole_ = true;
}

void ShotCaches::close() {
  is_whole_ = false;
  attached_.close();
  skin_->close();
  log_.expect(shot_.deformer->basis(), shot_.poses);
}

std::size_t ShotCaches::put_aside(const TaskRun& task) {
  if (!is_whole_ || frames_ == kept_) return 0;
  is_whole_ = false;
  const fs::path folder = task.checkpoint_folder();
  make_folder(folder);
  std::vector<fs::path> files = skin_->aside(folder / "skin");
  for (const fs::path& file : attached_.aside(folder / "attached")) files.push_back(file);
  skin_->put_aside(folder / "skin");
  attached_.put_aside(folder / "attached");
  if (shot_.deformer->dynamics() != nullptr) {
    files.push_back(folder / "jiggle.state");
    save_state(state_, *shot_.deformer->dynamics(), files.back());
  }
  task.write_checkpoint({frames_, log_.kept()}, files);
  return kept_ = frames_;
}

std::size_t ShotCaches::take_up(const TaskRun& task) {
  const std::optional<Checkpoint> checkpoint = task.read_checkpoint();
  if (!checkpoint || checkpoint->frames > shot_.frames.size()) return 0;
  const fs::path folder = task.checkpoint_folder();
  if (shot_.deformer->dynamics() != nullptr) {
    state_ = load_state(folder / "jiggle.state", *shot_.deformer->dynamics());
    shot_.deformer->set_state(state_);
  }
  skin_->take_up(folder / "skin", checkpoint->frames);
  attached_.take_up(folder / "attached", checkpoint->frames);
  log_.take_up(checkpoint->log);
  return frames_ = kept_ = checkpoint->frames;
}

}  // namespace bodyopt::cli
