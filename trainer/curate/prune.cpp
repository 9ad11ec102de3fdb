#include "trainer/curate/prune.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "dataset/modifier.h"
#include "dataset/stack_history.h"
#include "trainer/curate/exported_frames.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

// All texts in a modifier's parameters: names of files are among them.
void add_texts(const Json& json, std::set<std::string>& texts) {
  if (json.is_string()) texts.insert(fs::path(json.get<std::string>()).lexically_normal().generic_string());
  if (!json.is_structured()) return;
  for (const Json& inner : json) add_texts(inner, texts);
}

void remove_file(const fs::path& path, PrunedFiles& pruned) {
  std::error_code gone;  // by another process: as well
  const std::uintmax_t size = fs::file_size(path, gone);
  if (gone || !fs::remove(path, gone)) return;
  ++pruned.files;
  pruned.bytes += size;
}

// Those that are written whole: not the temporary ones.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code none;
  for (fs::directory_iterator entry(folder, none), end; !none && entry != end; entry.increment(none)) {
    const std::string kind = entry->path().extension();
    std::error_code gone;
    if ((kind == ".pc2" || kind == ".offsets") && entry->is_regular_file(gone)) files.push_back(entry->path());
  }
  return files;
}

}  // namespace

PrunedFiles prune_modifiers(const fs::path& path, bool history) {
  PrunedFiles pruned;
  look_at_stacks(path, history, [&](const Dataset& dataset, const std::vector<std::vector<Modifier>>& stacks) {
    std::set<std::string> named;
    const auto add_stack = [&](const std::vector<Modifier>& stack) {
      for (const Modifier& modifier : stack) add_texts(modifier.parameters, named);
    };
    std::ranges::for_each(stacks, add_stack);
    if (history) forget_exports(dataset);
    for (const fs::path& file : export_files(dataset)) {
      for (const ExportRecord& record : read_export_file(file)) {
        named.insert(record.skin);
        add_stack(record.modifiers);
      }
    }
    for (const fs::path& file : files_in(dataset.folder / "modifiers")) {
      if (!named.contains("modifiers/" + file.filename().string())) remove_file(file, pruned);
    }
    for (const fs::path& file : files_in(dataset.folder / "modifiers" / "cache")) remove_file(file, pruned);
  });
  return pruned;
}

void bound_cache(const fs::path& folder, std::uint64_t bytes, const fs::path& kept) {
  struct Cache {
    fs::file_time_type used;
    std::uint64_t size;
    fs::path path;
  };
  std::vector<Cache> caches;
  std::uint64_t sum = 0;
  for (const fs::path& file : files_in(folder)) {
    std::error_code gone;
    const Cache cache{fs::last_write_time(file, gone), fs::file_size(file, gone), file};
    if (gone) continue;
    sum += cache.size;
    if (file != kept) caches.push_back(cache);
  }
  std::ranges::sort(caches, {}, &Cache::used);
  PrunedFiles pruned;
  for (std::size_t k = 0; k < caches.size() && sum > bytes; ++k) {
    remove_file(caches[k].path, pruned);
    sum -= caches[k].size;
  }
}

}  // namespace bodyopt
