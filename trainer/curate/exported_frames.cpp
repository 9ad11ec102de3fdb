#include "trainer/curate/exported_frames.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "assets/json_file.h"
#include "assets/shape_reader.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "runtime/core/file_lock.h"
#include "trainer/curate/keep_samples.h"
#include "trainer/curate/sculpted_frames.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;
using Modifiers = std::vector<Modifier>;

Positions read_skin(const Character& character, const fs::path& path) {
  const ShapeReader reader(path);
  if (reader.point_count() != character.output_count() || reader.sample_count() != 1) {
    throw Error(ErrorKind::mismatch, path.string() + " has " + std::to_string(reader.sample_count()) + " samples of " +
                                         std::to_string(reader.point_count()) + " points; expected one of the " +
                                         std::to_string(character.output_count()) +
                                         " vertices of the character: is it of another one?");
  }
  return welded_from_output(character, reader.sample(0).data());
}

const Modifier* find(const Modifiers& modifiers, const std::string& name) {
  const auto found = std::ranges::find(modifiers, name, &Modifier::name);
  return found == modifiers.end() ? nullptr : &*found;
}

}  // namespace

ExportedFrame exported_now(const ShapeStack& stack, std::size_t frame) {
  const PoseDatabase& database = stack.database();
  const Modifiers& modifiers = database.dataset.modifiers;
  return {database.character.vertices + stack.offsets(frame, modifiers.size()), modifiers};
}

std::string keep_exported(const fs::path& path, const ShapeStack& stack, std::size_t frame,
                          const ExportedFrame& exported) {
  const PoseDatabase& database = stack.database();
  const DatabaseFrame& of = database.frames[frame];
  const FileLock lock = lock_to_change(path);
  const ExportRecord record{
      database.takes[static_cast<std::size_t>(of.take)], of.frame,
      keep_samples(database.dataset, "exported", 1,
                   [&](std::size_t) { return output_from_welded(database.character, exported.skin); }),
      exported.modifiers};
  write_export(record, database.dataset);
  return mark_of(record);
}

KeptExports kept_exports(const ShapeStack& stack, std::size_t frame, const std::string& name) {
  const PoseDatabase& database = stack.database();
  const DatabaseFrame& of = database.frames[frame];
  KeptExports kept;
  const auto unless_refused = [&](const auto& read) {
    try {
      read();
    } catch (const Error& error) {
      kept.notes.push_back(std::string("an export is left out of what the mesh may be of: ") + error.what());
    }
  };
  std::vector<ExportRecord> records;
  for (const fs::path& file : export_files(database.dataset)) {
    unless_refused([&] { std::ranges::copy(read_export_file(file), std::back_inserter(records)); });
  }
  for (const ExportRecord& record : records) {
    if (record.take != database.takes[static_cast<std::size_t>(of.take)] || record.frame != of.frame) continue;
    unless_refused([&] {
      const Positions skin = read_skin(database.character, database.dataset.folder / record.skin);
      sculpted_by(database, record.modifiers, name, frame);  // refuses files that are gone
      kept.frames.push_back({skin, record.modifiers, mark_of(record)});
    });
  }
  std::ranges::reverse(kept.frames);
  return kept;
}

Positions sculpted_by(const PoseDatabase& database, const Modifiers& modifiers, const std::string& name,
                      std::size_t frame) {
  const Modifier* modifier = find(modifiers, name);
  if (!modifier || modifier->type != "sculpt" || !modifier->enabled) {
    return Positions::Zero(database.character.vertices.rows(), 3);
  }
  const std::string place = "modifier '" + name + "'";
  return SculptedFrames(database, JsonObject(modifier->parameters, database.dataset.folder / "dataset.json", place),
                        place)
      .sum(frame);
}

std::vector<std::string> names_that_differ(const Modifiers& before, const Modifiers& now) {
  std::vector<std::string> names;
  for (const Modifier& modifier : now) {
    const Modifier* then = find(before, modifier.name);
    if (!then || *then != modifier) names.push_back(modifier.name);
  }
  for (const Modifier& modifier : before) {
    if (!find(now, modifier.name)) names.push_back(modifier.name);
  }
  return names;
}

}  // namespace bodyopt
