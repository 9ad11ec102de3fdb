#include "trainer/curate/exported_frames.h"

#include <algorithm>

#include "assets/json_file.h"
#include "base/content_hash.h"
#include "runtime/core/error.h"
#include "runtime/core/file_lock.h"
#include "trainer/curate/frame_files.h"
#include "trainer/curate/keep_samples.h"
#include "trainer/curate/sculpted_frames.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;
using Modifiers = std::vector<Modifier>;

constexpr const char* kSchema = "bodyopt-exported-frames-1";
constexpr std::size_t kMost = 200;

fs::path path_of(const Dataset& dataset) { return dataset.folder / "modifiers" / "exported.json"; }

void write_records(const std::vector<ExportRecord>& records, const Dataset& dataset) {
  Json frames = Json::array();
  for (const ExportRecord& record : records) {
    frames.push_back({{"take", record.take},
                      {"frame", record.frame},
                      {"skin", record.skin},
                      {"modifiers", to_json(record.modifiers)}});
  }
  write_json({{"schema", kSchema}, {"frames", frames}}, path_of(dataset));
}

std::string mark_of(const ExportRecord& record) {
  ContentHash hash;
  hash.add(record.take);
  hash.add(static_cast<std::uint64_t>(record.frame));
  hash.add(record.skin);
  hash.add(to_json(record.modifiers).dump());
  return export_mark(hash.value());
}

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

std::vector<ExportRecord> read_export_records(const Dataset& dataset) {
  std::vector<ExportRecord> records;
  const fs::path path = path_of(dataset);
  std::error_code unreadable;
  if (!fs::exists(path, unreadable)) return records;
  const Json json = read_json(path, kSchema);
  const JsonObject top(json, path, "the exported frames");
  top.allow({"schema", "frames"});
  for (const Json& entry : top.array("frames")) {
    const JsonObject record(entry, path, "an exported frame");
    record.allow({"take", "frame", "skin", "modifiers"});
    records.push_back({record.name("take"), record.integer("frame"), record.name("skin"),
                       read_modifiers(record.array("modifiers"), path)});
  }
  return records;
}

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
  std::vector<ExportRecord> records = read_export_records(database.dataset);
  std::erase(records, record);
  records.push_back(record);
  if (records.size() > kMost) records.erase(records.begin());
  write_records(records, database.dataset);
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
  unless_refused([&] { records = read_export_records(database.dataset); });
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

void forget_exports(const Dataset& dataset) {
  std::error_code failure;
  fs::remove(path_of(dataset), failure);
  if (failure) {
    throw Error(ErrorKind::file,
                path_of(dataset).string() + " cannot be removed (" + failure.message() + "): is the folder writable?");
  }
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
