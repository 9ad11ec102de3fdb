#include "trainer/curate/exported_frames.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "assets/caches/shape_reader.h"
#include "base/content_hash.h"
#include "base/json_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "trainer/curate/frame_files.h"
#include "trainer/curate/frame_sculpting.h"
#include "trainer/curate/offset_cache.h"

namespace bodyopt::trainer {
namespace {

namespace fs = std::filesystem;
using Modifiers = std::vector<Modifier>;

Positions read_skin(const Character& character, const fs::path& path) {
  const ShapeReader reader(path);
  if (reader.point_count() != character.output_count() || reader.sample_count() != 1) {
    throw Error(ErrorKind::mismatch, path, " has ", reader.sample_count(), " samples of ", reader.point_count(),
                " points; expected one of the ", character.output_count(),
                " vertices of the character: is it of another one?");
  }
  return welded_from_output(character, reader.sample(0).data());
}

constexpr const char* kSchema = "bodyopt-exported-frame-1";
constexpr const char* kOldSchema = "bodyopt-exported-frames-1";
constexpr std::size_t kMost = 200;
constexpr std::size_t kDigits = 6;  // of the numbers that files are sorted by

fs::path folder_of(const Dataset& dataset) { return dataset.folder / "modifiers" / "exported"; }
// All in one file, as they were written before: it does not merge.
fs::path old_path_of(const Dataset& dataset) { return dataset.folder / "modifiers" / "exported.json"; }

ExportRecord read_record(const JsonObject& record, const fs::path& path) {
  return {record.name("take"), record.integer("frame"), record.name("skin"),
          read_modifiers(record.array("modifiers"), path)};
}

// Other files, a copy of one or a conflict's, are none of ours.
bool is_record(std::string_view name) {
  constexpr std::string_view kBefore = "-exported-", kAfter = ".json";
  constexpr std::size_t kHash = 16;
  const std::size_t digits = std::min(name.find_first_not_of("0123456789"), name.size());
  const std::string_view rest = name.substr(digits);
  return digits >= kDigits && rest.size() == kBefore.size() + kHash + kAfter.size() && rest.starts_with(kBefore) &&
         rest.ends_with(kAfter) &&
         rest.substr(kBefore.size(), kHash).find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

// A file each, so that exports of two artists merge: "000007-exported-0123456789abcdef.json". The oldest first.
std::vector<fs::path> record_files(const Dataset& dataset) {
  std::vector<fs::path> files;
  std::error_code none;
  for (fs::directory_iterator entry(folder_of(dataset), none), end; !none && entry != end; entry.increment(none)) {
    if (is_record(entry->path().filename().string())) files.push_back(entry->path());
  }
  std::ranges::sort(files);
  return files;
}

int number_of(const fs::path& file) {
  const std::string name = file.filename();
  int number = 0;
  std::from_chars(name.data(), name.data() + std::min(name.size(), kDigits), number);
  return number;
}

std::string name_of(int number, const std::string& mark) {
  const std::string digits = std::to_string(number);
  return std::string(kDigits - std::min(kDigits, digits.size()), '0') + digits + "-" + mark + ".json";
}

void write_record(const ExportRecord& record, const fs::path& path) {
  std::error_code ignored;  // without the folder the writer refuses, naming the file
  fs::create_directories(path.parent_path(), ignored);
  write_json({{"schema", kSchema},
              {"take", record.take},
              {"frame", record.frame},
              {"skin", record.skin},
              {"modifiers", to_json(record.modifiers)}},
             path);
}

// Removes older files of the export with this mark, and the oldest of too many. `before`: files older than the new one.
void forget_older(const std::vector<fs::path>& before, const std::string& mark) {
  std::vector<fs::path> others = before;
  std::erase_if(others, [&](const fs::path& file) {
    const bool is_same = file.stem().string().ends_with(mark);
    std::error_code ignored;  // one more does no harm
    if (is_same) fs::remove(file, ignored);
    return is_same;
  });
  for (std::size_t k = 0; k + kMost < others.size() + 1; ++k) {
    std::error_code ignored;
    fs::remove(others[k], ignored);
  }
}

// A hash of it, as export_mark() writes it: what its mesh is named by.
std::string mark_of(const ExportRecord& record) {
  ContentHash hash;
  hash.add(record.take);
  hash.add(static_cast<std::uint64_t>(record.frame));
  hash.add(record.skin);
  hash.add(to_json(record.modifiers).dump());
  return export_mark(hash.value());
}

// Writes one down as the latest; 200 stay. The caller holds the dataset's lock. Throws Error(file).
void write_export(const ExportRecord& record, const Dataset& dataset) {
  const std::string mark = mark_of(record);
  const std::vector<fs::path> before = record_files(dataset);
  write_record(record, folder_of(dataset) / name_of(before.empty() ? 1 : number_of(before.back()) + 1, mark));
  forget_older(before, mark);
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
      database.take_of(frame), of.frame,
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
    if (record.take != database.take_of(frame) || record.frame != of.frame) continue;
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
  const Modifier* modifier = find_modifier(modifiers, name);
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
    const Modifier* then = find_modifier(before, modifier.name);
    if (!then || *then != modifier) names.push_back(modifier.name);
  }
  for (const Modifier& modifier : before) {
    if (!find_modifier(now, modifier.name)) names.push_back(modifier.name);
  }
  return names;
}

std::vector<fs::path> export_files(const Dataset& dataset) {
  std::vector<fs::path> files = record_files(dataset);
  std::error_code unreadable;
  if (fs::exists(old_path_of(dataset), unreadable)) files.insert(files.begin(), old_path_of(dataset));
  return files;
}

std::vector<ExportRecord> read_export_file(const fs::path& path) {
  std::vector<ExportRecord> records;
  if (path.filename() == "exported.json") {
    const Json json = read_json(path, kOldSchema);
    const JsonObject top(json, path, "the exported frames");
    top.allow({"schema", "frames"});
    for (const Json& entry : top.array("frames")) {
      const JsonObject record(entry, path, "an exported frame");
      record.allow({"take", "frame", "skin", "modifiers"});
      records.push_back(read_record(record, path));
    }
    return records;
  }
  const Json json = read_json(path, kSchema);
  const JsonObject record(json, path, "the exported frame");
  record.allow({"schema", "take", "frame", "skin", "modifiers"});
  return {read_record(record, path)};
}

void forget_exports(const Dataset& dataset) {
  for (const fs::path& file : export_files(dataset)) {
    std::error_code failure;
    fs::remove(file, failure);
    if (failure) {
      throw Error(ErrorKind::file, file, " cannot be removed (", failure.message(), "): is the folder writable?");
    }
  }
}

}  // namespace bodyopt::trainer
