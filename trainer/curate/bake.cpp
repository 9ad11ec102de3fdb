#include "trainer/curate/bake.h"

#include <algorithm>
#include <cmath>

#include "assets/clip.h"
#include "assets/clip_source.h"
#include "assets/pc2.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

ModifierEffect summary(const std::string& name, std::vector<FrameEffect> frames) {
  ModifierEffect effect;
  effect.name = name;
  double sum = 0;
  for (const FrameEffect& frame : frames) {
    if (!(frame.max_mm > 0)) continue;
    effect.frames.push_back(frame);
    sum += frame.rms_mm * frame.rms_mm;
    if (frame.max_mm > effect.max_mm) {
      effect.max_mm = frame.max_mm;
      effect.worst = frame.frame;
    }
  }
  if (!effect.frames.empty()) effect.rms_mm = std::sqrt(sum / static_cast<double>(effect.frames.size()));
  return effect;
}

// Frames of a take that are not dropped, by rising number.
std::vector<std::size_t> kept_frames(const ShapeStack& stack, int take) {
  const std::vector<DatabaseFrame>& frames = stack.database().frames;
  std::vector<std::size_t> kept;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    if (frames[n].take == take && !stack.is_dropped(n)) kept.push_back(n);
  }
  std::sort(kept.begin(), kept.end(), [&](std::size_t a, std::size_t b) { return frames[a].frame < frames[b].frame; });
  return kept;
}

std::string elsewhere(const fs::path& from, const std::string& name) {
  return name.empty() ? name : fs::absolute(from / name).lexically_normal().string();
}

// The poses of a take that no file has: a frame that is left out is as the one before it.
std::string write_poses(const ShapeStack& stack, const std::vector<std::size_t>& kept, const DatasetTake& take,
                        const fs::path& folder) {
  const PoseDatabase& database = stack.database();
  Clip clip;
  clip.name = take.name;
  clip.fps = take.fps;
  clip.first_frame = take.frames.front();
  for (const std::size_t n : kept) {
    while (clip.last_frame() + 1 < database.frames[n].frame) clip.poses.push_back(clip.poses.back());
    clip.poses.push_back(database.frames[n].pose);
    clip.poses.back().controls.clear();
  }
  const std::string name = take.name + ".glb";
  write_clip(clip, database.character.skeleton, database.dataset.unit, folder / name);
  return name;
}

DatasetTake baked_take(const ShapeStack& stack, int number, const std::vector<std::size_t>& kept,
                       const fs::path& folder) {
  const PoseDatabase& database = stack.database();
  const std::vector<DatasetTake>& takes = database.dataset.takes;
  const bool mirrored = static_cast<std::size_t>(number) >= takes.size();
  DatasetTake take = takes[static_cast<std::size_t>(number) % takes.size()];
  const fs::path& from = database.dataset.folder;
  take.name = database.takes[static_cast<std::size_t>(number)];
  take.frames.clear();
  take.heldout.clear();
  for (const std::size_t n : kept) {
    take.frames.push_back(database.frames[n].frame);
    if (database.frames[n].heldout) take.heldout.push_back(database.frames[n].frame);
  }
  take.shapes = take.name + ".pc2";
  take.shapes_status.clear();
  if (mirrored && !take.controls.empty()) {
    throw Error(ErrorKind::usage, "take '" + take.name + "': controls of mirror images cannot be written");
  }
  take.controls = elsewhere(from, take.controls);
  take.joint_map = mirrored ? "" : elsewhere(from, take.joint_map);
  if (mirrored) {
    take.up.clear();
    take.clip = write_poses(stack, kept, take, folder);
    take.first_frame = take.frames.front();
  } else {
    const ClipSource source = split_source(take.clip);
    take.clip = elsewhere(from, source.path.string()) + (source.name.empty() ? "" : "#" + source.name);
  }
  return take;
}

void write_shapes(const ShapeStack& stack, const std::vector<std::size_t>& kept, const DatasetTake& take,
                  const fs::path& folder, Progress& progress) {
  const Character& character = stack.database().character;
  Pc2Writer writer(folder / take.shapes, character.output_count(), static_cast<std::uint32_t>(kept.size()),
                   static_cast<float>(take.frames.front()), frame_spacing(take.frames));
  constexpr std::size_t kTogether = 16;  // frames in memory
  for (std::size_t begin = 0; begin < kept.size(); begin += kTogether) {
    const std::size_t count = std::min(kTogether, kept.size() - begin);
    std::vector<std::vector<float>> shapes(count);
    parallel_for(count, [&](std::size_t k) {
      shapes[k] = output_from_welded(character, stack.shape(kept[begin + k]));
      progress.advance();
    });
    for (const std::vector<float>& shape : shapes) writer.append(shape);
  }
  writer.close();
}

}  // namespace

std::vector<ModifierEffect> measure_modifiers(const ShapeStack& stack, const std::string& name) {
  const PoseDatabase& database = stack.database();
  const std::vector<Modifier>& modifiers = database.dataset.modifiers;
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < modifiers.size(); ++k) {
    if (name.empty() || modifiers[k].name == name) places.push_back(k);
  }
  if (places.empty() && !name.empty()) throw Error(ErrorKind::usage, "the dataset has no modifier '" + name + "'");
  std::vector<std::vector<FrameEffect>> effects(places.size(), std::vector<FrameEffect>(database.frames.size()));
  Progress progress("curate: what modifiers do", database.frames.size());
  parallel_for(database.frames.size(), [&](std::size_t n) {
    for (std::size_t k = 0; stack.is_changed(n) && k < places.size(); ++k) {
      const Eigen::VectorXd apart =
          1e3 * (stack.offsets(n, places[k] + 1) - stack.offsets(n, places[k])).rowwise().norm();
      effects[k][n] = {n, std::sqrt(apart.squaredNorm() / static_cast<double>(apart.size())), apart.maxCoeff()};
    }
    progress.advance();
  });
  std::vector<ModifierEffect> result;
  for (std::size_t k = 0; k < places.size(); ++k) result.push_back(summary(modifiers[places[k]].name, effects[k]));
  return result;
}

Dataset bake_dataset(const ShapeStack& stack, const fs::path& folder) {
  const PoseDatabase& database = stack.database();
  if (fs::exists(folder / "dataset.json")) {
    throw Error(ErrorKind::usage, folder.string() + " has a dataset already: bake into another folder");
  }
  Dataset baked = database.dataset;
  const fs::path& from = database.dataset.folder;
  baked.folder = folder;
  for (std::string* file : {&baked.character, &baked.muscles, &baked.materials, &baked.corrections, &baked.regions}) {
    *file = elsewhere(from, *file);
  }
  baked.modifiers.clear();
  baked.selections.clear();
  baked.takes.clear();
  Progress progress("curate: baking", database.frames.size(), "no dataset is written");
  for (std::size_t k = 0; k < database.takes.size(); ++k) {
    const std::vector<std::size_t> kept = kept_frames(stack, static_cast<int>(k));
    if (kept.empty()) continue;
    baked.takes.push_back(baked_take(stack, static_cast<int>(k), kept, folder));
    write_shapes(stack, kept, baked.takes.back(), folder, progress);
  }
  write_dataset(baked, folder / "dataset.json");
  return baked;
}

}  // namespace bodyopt
