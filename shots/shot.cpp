#include "shots/shot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <numeric>
#include <sstream>

#include "assets/clips/shot_modifiers.h"
#include "base/progress.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/deformer/evaluate_together.h"
#include "runtime/deformer/evaluation.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "runtime/threads/tbb_executor.h"
#include "shots/bound_attachments.h"
#include "shots/clip_choice.h"

namespace bodyopt::shots {
namespace {

// `part` keeps its memory from part to part: to get pages anew costs more than to write them.
void evaluate_part(Shot& shot, std::span<const Pose> poses, std::span<const int> frames, Evaluation& part) {
  DeformerCall call{.deformer = shot.deformer.get(), .poses = poses, .evaluation = &part};
  if (shot.jiggles) call.frames = frames;
  evaluate_together({&call, 1});
  try {
    if (call.error) std::rethrow_exception(call.error);
  } catch (const Error& error) {
    if (!shot.checks) throw;
    throw Error(error.kind(), "frame ", frames.front(), ": ", error.what());
  }
}

void preroll(Shot& shot) {
  if (shot.preroll == 0) return;
  Progress progress("pre-roll", static_cast<std::size_t>(shot.preroll));
  const int first = shot.frames.front();
  for (int frame = first - shot.preroll; frame < first; ++frame) {
    shot.deformer->jiggle(poses_of(shot.clip, {frame}), {&frame, 1});
    progress.advance();
  }
}

namespace fs = std::filesystem;

fs::path stem_in(const fs::path& folder, std::size_t writer) {
  return writer == 0 ? folder / "skin" : folder / ("attached" + std::to_string(writer - 1));
}

}  // namespace

std::vector<Pose> Shot::poses(std::size_t begin, std::size_t count) const {
  const auto first = frames.begin() + static_cast<std::ptrdiff_t>(begin);
  return poses_of(clip, {first, first + static_cast<std::ptrdiff_t>(count)});
}

Clip Shot::played_clip() const {
  const auto [first, last] = std::ranges::minmax(frames);
  std::vector<int> all(static_cast<std::size_t>(last - first) + 1);
  std::iota(all.begin(), all.end(), first);
  Clip played = clip;
  played.poses = poses_of(clip, all);
  played.first_frame = first;
  return played;
}

std::string problem_of_rate(const Dynamics& dynamics, const Clip& clip) {
  const double rate = static_cast<double>(dynamics.jiggle.step.frames_per_second);
  if (clip.poses.size() < 2 || std::abs(clip.fps - rate) <= 1e-3 * rate) return "";  // a pose has no rate of its own
  std::ostringstream text;
  text << "the dynamics step " << rate << " frames a second, the clip has " << clip.fps << ": sample it with --fps "
       << rate << ", or make the dynamics anew with 'bodyopt dynamics --fps " << clip.fps << "'";
  return text.str();
}

int usual_preroll(const Clip& clip, int first) {
  return std::min(static_cast<int>(clip.fps), first - clip.first_frame);
}

void pose_shot(const ShotPosing& posing, Shot& shot, const Tell& tell) {
  const Basis& basis = shot.basis();
  shot.deformer->set_weights({.correction = static_cast<float>(posing.pose.correction), .jiggle = posing.jiggle});
  shot.clip = posed_clip(std::move(shot.clip), basis.skeleton, posing.turning, posing.pose);
  std::vector<std::string> known = basis.residual.controls;
  for (const std::string& name : modifier_channels(basis.modifiers)) known.push_back(name);
  set_channels(posing.channels, known, shot.clip);
  for (const std::string& note : apply_channels(basis, shot.clip)) tell(note);
  const std::string problem = shot.jiggles ? problem_of_rate(*shot.deformer->dynamics(), shot.clip) : "";
  if (!problem.empty()) throw Error(ErrorKind::mismatch, problem);
}

void evaluate(Shot& shot, SkinSink& sink, const std::string& label, std::size_t begin, const std::string& kept) {
  if (begin == 0) preroll(shot);
  Progress progress(label, shot.frames.size() - begin, kept);
  // Frames held in memory at once: a few batches, of which a device runs one while another is taken. Of the jiggle each
  // is measured, and it may be slow; a check names the one it stops at.
  const std::size_t batches = 4 * std::size_t{shot.deformer->batch_limit()};
  const std::size_t step = shot.jiggles || shot.checks ? 1 : std::clamp<std::size_t>(batches, 32, 256);
  struct Part {
    std::vector<Pose> poses;
    Evaluation evaluation;
  };
  std::array<Part, 2> parts;  // one is written while the next is evaluated
  std::future<void> written;  // ends before they do
  for (std::size_t k = 0; begin < shot.frames.size(); ++k) {
    Part& part = parts[k % parts.size()];
    const std::size_t count = std::min(step, shot.frames.size() - begin);
    part.poses = shot.poses(begin, count);
    evaluate_part(shot, part.poses, std::span(shot.frames).subspan(begin, count), part.evaluation);
    if (written.valid()) written.get();
    written = std::async(std::launch::async, [&sink, &progress, &part = part, begin, count] {
      sink.append(part.evaluation, part.poses, begin);
      progress.advance(count);
    });
    if (shot.jiggles) written.get();
    begin += count;
  }
  if (written.valid()) written.get();
}

void require_form(const CacheChoice& choice) {
  if (!holds_triangles(choice.out)) return;
  if (!(choice.space == CacheSpace())) {
    throw Error(ErrorKind::usage,
                "--unit-out and --axis are for .pc2 and .mdd: a .usda or .glb says itself that it is in metres, Y up");
  }
  if (choice.full_skin) {
    throw Error(
        ErrorKind::usage,
        "--full-skin writes .pc2 or .mdd: the topology of the full skin, which .usda and .glb hold, is not in a proxy");
  }
}

ShotCaches::ShotCaches(const CacheChoice& choice, Shot& shot)
    : choice_(choice), shot_(shot), threads_(make_tbb_executor()) {
  const CarriedSkin& full_skin = shot.following.full_skin();
  if (choice.full_skin && full_skin.empty()) {
    throw Error(ErrorKind::usage, shot.name, " is no proxy: --full-skin has nothing to carry; leave it out");
  }
  const MeshTable& mesh = shot.basis().mesh;
  points_ = choice.full_skin ? static_cast<std::uint32_t>(full_skin.size()) : mesh.output_count();
  skin_ = write_cache(choice.out, {shot.name, points_, mesh.output_triangles, shot.frames, shot.clip.fps, choice.space,
                                   shot.surface, shot.bound ? &*shot.bound : nullptr});
  const fs::path out = choice.out;
  for (const AttachedMesh& worn : shot.following.attached().meshes) {
    attached_paths_.push_back(fs::path(out).replace_extension("." + worn.name + out.extension().string()).string());
    const SkinSurface surface = shot.surfaces.empty() ? SkinSurface() : shot.surfaces[attached_.size()];
    if (shot.bound) bound_.push_back(std::make_unique<const BoundSkin>(bind_attached(*shot.bound, mesh, worn)));
    attached_.push_back(
        write_cache(attached_paths_.back(), {worn.name, worn.vertex_count(), worn.triangles, shot.frames, shot.clip.fps,
                                             choice.space, surface, shot.bound ? bound_.back().get() : nullptr}));
  }
  shot.deformer->set_normals(holds_normals(choice.out) || choice.full_skin || shot.checks);
}

void ShotCaches::append(const Evaluation& part, std::span<const Pose> poses, std::size_t) {
  const std::size_t own = 3 * std::size_t{shot_.basis().mesh.output_count()}, written = 3 * std::size_t{points_};
  const FollowingMeshes& following = shot_.following;
  const std::span<const float> skins =
      choice_.full_skin ? following.carry_full_skin(part.positions, part.normals, following_, *threads_)
                        : part.positions;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    std::span<const float> normals;
    if (!choice_.full_skin && !part.normals.empty()) normals = std::span(part.normals).subspan(k * own, own);
    skin_->append(skins.subspan(k * written, written), normals);
  }
  following.carry_each(
      part.positions, poses, following_,
      [&](std::size_t, std::size_t m, const std::vector<float>& points) { attached_[m]->append(points, {}); });
  frames_ += poses.size();
}

std::vector<CacheWriter*> ShotCaches::writers() const {
  std::vector<CacheWriter*> all{skin_.get()};
  for (const auto& writer : attached_) all.push_back(writer.get());
  return all;
}

// The skin is closed last: where it is in place, all others are.
void ShotCaches::close() {
  for (const auto& writer : attached_) writer->close();
  skin_->close();
}

std::vector<fs::path> ShotCaches::put_aside(const fs::path& folder) {
  std::vector<fs::path> files;
  const std::vector<CacheWriter*> all = writers();
  for (std::size_t w = 0; w < all.size(); ++w) {
    for (const fs::path& file : all[w]->put_aside(stem_in(folder, w))) files.push_back(file);
  }
  return files;
}

void ShotCaches::take_up(const fs::path& folder, std::size_t frames) {
  const std::vector<CacheWriter*> all = writers();
  for (std::size_t w = 0; w < all.size(); ++w) all[w]->take_up(stem_in(folder, w), frames);
  frames_ = frames;
}

}  // namespace bodyopt::shots
