#include "trainer/curate/edit_stack.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "assets/clips/clip.h"
#include "assets/clips/clip_source.h"
#include "base/frame_range.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "runtime/core/error.h"
#include "trainer/curate/frame_sculpting.h"
#include "trainer/curate/offset_cache.h"

namespace bodyopt::trainer {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;
using Modifiers = std::vector<Modifier>;

// Parts of the character's size: no sculpt moves a vertex so far, and files round by less than so little.
constexpr double kTooFar = 0.2, kAsItIs = 1e-6;

Modifiers::iterator modifier_named(const std::string& name, Modifiers& modifiers) {
  const auto found = std::ranges::find(modifiers, name, &Modifier::name);
  if (found != modifiers.end()) return found;
  const std::vector<std::string> names = names_of(modifiers);
  throw Error(ErrorKind::usage, "the dataset has no modifier '", name, "'; ",
              (names.empty() ? "it has none" : "the nearest are " + list_names(nearest_names(names, name))));
}

std::string free_name(const Modifiers& modifiers, const Modifier& modifier) {
  if (!modifier.name.empty() && !find_modifier(modifiers, modifier.name)) return modifier.name;
  if (!modifier.name.empty()) {
    throw Error(ErrorKind::usage, "the dataset has a modifier '", modifier.name, "' already");
  }
  std::string name = modifier.type;
  for (int k = 2; find_modifier(modifiers, name); ++k) name = modifier.type + std::to_string(k);
  return name;
}

void name_sculpt(Modifier& modifier, const std::string& take, int frame, const std::string& offsets, double spread) {
  Json& sculpts = modifier.parameters["sculpts"];
  if (!sculpts.is_array()) sculpts = Json::array();
  const Json entry = {{"take", take}, {"frame", frame}, {"offsets", offsets}};
  const auto same = [&](const Json& there) {
    return there.value("take", "") == take && there.value("frame", 0) == frame;
  };
  const auto found = std::ranges::find_if(sculpts, same);
  if (found == sculpts.end()) {
    sculpts.push_back(entry);
  } else {
    *found = entry;
  }
  modifier.parameters["spread_degrees"] = spread;
}

std::vector<std::string> sculpt_notes(const Character& character, const Positions& before, const Positions& after) {
  std::vector<std::string> notes;
  const Positions was = vertex_normals(before, character.triangles), is = vertex_normals(after, character.triangles);
  const double size = box_diagonal(character.vertices);
  Index far = 0, turned = 0, far_vertex = 0, turned_vertex = 0;
  for (Index v = 0; v < before.rows(); ++v) {
    if ((after.row(v) - before.row(v)).norm() > kTooFar * size && far++ == 0) far_vertex = v;
    if (was.row(v).dot(is.row(v)) < 0 && turned++ == 0) turned_vertex = v;
  }
  const auto output = [&](Index v) { return std::to_string(character.first_output(static_cast<std::uint32_t>(v))); };
  if (far > 0) {
    notes.push_back(count_of(static_cast<std::size_t>(far), "vertex moves", "vertices move") +
                    " by more than a fifth of the character's size, vertex " + output(far_vertex) +
                    " among them: did the sculpt explode, or is it of another pose or unit?");
  }
  if (turned > 0) {
    notes.push_back("around " + count_of(static_cast<std::size_t>(turned), "vertex", "vertices") +
                    " the skin is turned inside out, vertex " + output(turned_vertex) + " among them");
  }
  return notes;
}

// Below all but those of its kind that begin the stack.
void put_over(const Dataset& dataset, const std::string& name, const std::string& take, const std::vector<int>& frames,
              const std::function<std::vector<float>(std::size_t)>& shape, Modifiers& modifiers) {
  Modifier over{.name = name, .type = "blend"};
  over.parameters = {{"take", take}, {"frames", format_frame_range(frames)}};
  over.parameters["cache"] = keep_samples(dataset, "replaced", frames.size(), shape);
  const auto place = std::ranges::find_if(modifiers, [](const Modifier& there) { return there.type != "blend"; });
  modifiers.insert(place, std::move(over));
}

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
  std::ranges::sort(kept, [&](std::size_t a, std::size_t b) { return frames[a].frame < frames[b].frame; });
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
    throw Error(ErrorKind::usage, "take '", take.name, "': controls of mirror images cannot be written");
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

PoseDatabase add_modifier(const fs::path& path, Modifier modifier) {
  PoseDatabase database;
  database.dataset = edit_modifiers(path, [&](const Dataset& dataset, Modifiers& modifiers) {
    modifier.name = free_name(modifiers, modifier);
    database = read_pose_database(dataset);
    check_modifier(database, modifier);
    modifiers.push_back(modifier);
  });
  return database;
}

PoseDatabase change_modifier(const fs::path& path, const std::string& name, const ModifierChange& change,
                             std::chrono::milliseconds patience) {
  PoseDatabase database;
  const auto edit = [&](const Dataset& dataset, Modifiers& modifiers) {
    Modifier& modifier = *modifier_named(name, modifiers);
    if (change.strength) modifier.strength = *change.strength;
    if (change.frames) modifier.frames = *change.frames;
    if (change.mask) modifier.mask = *change.mask;
    for (const auto& [key, value] : change.parameters.items()) {
      modifier.parameters[key] = value;
      if (value.is_null()) modifier.parameters.erase(key);
    }
    if (change.name && *change.name != name) {
      if (find_modifier(modifiers, *change.name)) {
        throw Error(ErrorKind::usage, "the dataset has a modifier '", *change.name, "' already");
      }
      modifier.name = *change.name;
    }
    database = read_pose_database(dataset);
    check_modifier(database, modifier);
  };
  database.dataset = edit_modifiers(path, edit, patience);
  return database;
}

void move_modifier(const fs::path& path, const std::string& name, std::size_t place) {
  edit_modifiers(path, [&](const Dataset&, Modifiers& modifiers) {
    const auto found = modifier_named(name, modifiers);
    if (place < 1 || place > modifiers.size()) {
      throw Error(ErrorKind::usage, "the stack has the places 1 to ", modifiers.size(), ", asked for ", place);
    }
    Modifier moved = *found;
    modifiers.erase(found);
    modifiers.insert(modifiers.begin() + static_cast<std::ptrdiff_t>(place) - 1, std::move(moved));
  });
}

void enable_modifier(const fs::path& path, const std::string& name, bool enabled, std::chrono::milliseconds patience) {
  edit_modifiers(
      path, [&](const Dataset&, Modifiers& modifiers) { modifier_named(name, modifiers)->enabled = enabled; },
      patience);
}

void remove_modifier(const fs::path& path, const std::string& name) {
  edit_modifiers(path, [&](const Dataset&, Modifiers& modifiers) { modifiers.erase(modifier_named(name, modifiers)); });
}

void check_modifier(const PoseDatabase& database, const Modifier& modifier) {
  if (!find_modifier_type(modifier.type)) {
    throw Error(ErrorKind::usage, "there is no type of modifier '", modifier.type, "'; there are ",
                list_names(names_of(modifier_types())));
  }
  PoseDatabase alone = database;
  alone.dataset.modifiers = {modifier};
  alone.dataset.modifiers.front().enabled = true;
  // Modifiers that look at all frames are worked out when they are needed; here parameters and scope are enough.
  if (modifier.type == "consistency") {
    ShapeStack::check_scope(database, modifier);
    alone.dataset.modifiers.front().frames = Json::array();
    alone.frames.clear();
  }
  const ShapeStack stack(std::move(alone));
}

void put_shapes_over(const fs::path& path, const std::string& take, const std::vector<int>& frames,
                     const ShapeReader& shapes, const std::vector<std::uint32_t>& samples) {
  edit_modifiers(path, [&](const Dataset& dataset, Modifiers& modifiers) {
    const std::string name = free_name(modifiers, {.type = "replaced"});
    put_over(
        dataset, name, take, frames, [&](std::size_t k) { return shapes.sample(samples[k]); }, modifiers);
  });
}

void put_shapes_over(const fs::path& path, const std::string& name, const std::string& take,
                     const std::vector<int>& frames, const std::function<std::vector<float>(std::size_t)>& shape) {
  edit_modifiers(path, [&](const Dataset& dataset, Modifiers& modifiers) {
    std::erase_if(modifiers, [&](const Modifier& there) { return there.name == name; });
    put_over(dataset, name, take, frames, shape, modifiers);
  });
}

void require_sculpt(const Modifiers& modifiers, const std::string& name) {
  const Modifier* found = find_modifier(modifiers, name);
  if (!found || found->type == "sculpt") return;
  throw Error(ErrorKind::usage, "the modifier '", name, "' is of the type ", found->type);
}

std::vector<std::string> put_sculpt(const PoseDatabase& database, Modifiers& modifiers, const std::string& name,
                                    std::size_t frame, const Positions& before, const Positions& after,
                                    double spread_degrees) {
  if (!after.allFinite()) throw Error(ErrorKind::mismatch, "the sculpt holds a number that is not finite");
  require_sculpt(modifiers, name);
  if (!find_modifier(modifiers, name)) modifiers.push_back({.name = name, .type = "sculpt"});
  Modifier& modifier = *modifier_named(name, modifiers);
  const Character& character = database.character;
  const std::string offsets = keep_samples(database.dataset, name, 1,
                                           [&](std::size_t) { return output_from_welded(character, after - before); });
  name_sculpt(modifier, database.take_of(frame), database.frames[frame].frame, offsets, spread_degrees);
  return sculpt_notes(character, before, after);
}

std::vector<std::string> add_sculpt(const fs::path& path, const std::string& name, const std::string& take, int frame,
                                    const ExportedFrame& exported, const std::vector<float>& mesh, bool unposed,
                                    double spread_degrees) {
  std::vector<std::string> notes;
  edit_modifiers(path, [&](const Dataset& dataset, Modifiers& modifiers) {
    const ShapeStack stack(read_pose_database(dataset));
    const PoseDatabase& database = stack.database();
    const Character& character = database.character;
    if (mesh.size() != 3 * std::size_t{character.output_count()}) {
      throw Error(ErrorKind::mismatch, "the sculpt has ", mesh.size() / 3, " vertices, the character ",
                  character.output_count(), ": it was subdivided, merged or made of another mesh");
    }
    const std::size_t number = database.find(take, frame, "the sculpt");
    const Positions given = welded_from_output(character, mesh.data());
    const UnposedSpace::Frame space = stack.space().frame(database.frames[number].pose);
    const Positions after = unposed ? given : Positions(character.vertices + space.offsets(given));
    if ((after - exported.skin).rowwise().norm().maxCoeff() < kAsItIs * box_diagonal(character.vertices)) {
      notes = {"the mesh is the frame as it was exported: nothing is changed"};
      return;
    }
    const Positions before = exported.skin - sculpted_by(database, exported.modifiers, name, number);
    notes = put_sculpt(database, modifiers, name, number, before, after, spread_degrees);
  });
  return notes;
}

std::vector<ModifierEffect> measure_modifiers(const ShapeStack& stack, const std::string& name) {
  const PoseDatabase& database = stack.database();
  const std::vector<Modifier>& modifiers = database.dataset.modifiers;
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < modifiers.size(); ++k) {
    if (name.empty() || modifiers[k].name == name) places.push_back(k);
  }
  if (places.empty() && !name.empty()) throw Error(ErrorKind::usage, "the dataset has no modifier '", name, "'");
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
    throw Error(ErrorKind::usage, folder, " has a dataset already: bake into another folder");
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

}  // namespace bodyopt::trainer
