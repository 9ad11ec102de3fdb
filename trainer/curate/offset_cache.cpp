#include "trainer/curate/offset_cache.h"

#include <xxhash.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "assets/caches/pc2.h"
#include "dataset/modifier.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "trainer/curate/exported_frames.h"

namespace bodyopt::trainer {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLookEvery = 256;  // files written from one look at how large all are to the next

// Detects one file under the name of another, too.
std::uint64_t check_sum(std::uint64_t key, std::span<const float> offsets) {
  return XXH3_64bits_withSeed(offsets.data(), offsets.size_bytes(), key);
}

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

// Files that are written whole, not the temporary ones.
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

std::string keep_samples(const Dataset& dataset, const std::string& of, std::size_t count,
                         const std::function<std::vector<float>(std::size_t k)>& sample) {
  ContentHash hash;
  std::size_t size = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<float> own = sample(k);
    ContentHash of_sample;
    of_sample.append(own.data(), own.size() * sizeof(float));
    hash.add(of_sample.value());
    size = own.size();
  }
  const std::string name = "modifiers/" + of + "-" + hexadecimal(hash.value()) + ".pc2";
  std::error_code ignored;  // without the folder the writer refuses, naming the file
  std::filesystem::create_directories(dataset.folder / "modifiers", ignored);
  Pc2Writer writer(dataset.folder / name, static_cast<std::uint32_t>(size / 3), static_cast<std::uint32_t>(count));
  for (std::size_t k = 0; k < count; ++k) writer.append(sample(k));
  writer.close();
  return name;
}

OffsetCache::~OffsetCache() {
  if (written_ > 0) bound_cache(folder_, kLargestCache, {});
}

fs::path OffsetCache::path_of(std::uint64_t key) const { return folder_ / (hexadecimal(key) + ".offsets"); }

bool OffsetCache::find(std::uint64_t key, std::span<float> offsets) const {
  const fs::path path = path_of(key);
  std::ifstream file(path, std::ios::binary);
  std::uint64_t sum = 0;
  file.read(reinterpret_cast<char*>(offsets.data()), static_cast<std::streamsize>(offsets.size_bytes()));
  file.read(reinterpret_cast<char*>(&sum), sizeof(sum));
  if (!file || file.peek() != std::ifstream::traits_type::eof() || sum != check_sum(key, offsets)) return false;
  std::error_code ignored;
  fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
  return true;
}

void OffsetCache::keep(std::uint64_t key, std::span<const float> offsets) const {
  std::error_code ignored;
  fs::create_directories(folder_, ignored);
  try {
    const std::uint64_t sum = check_sum(key, offsets);
    AtomicFile file(path_of(key));
    file.write(std::as_bytes(offsets));
    file.write(std::as_bytes(std::span(&sum, 1)));
    file.commit_unflushed();
  } catch (const Error&) {
    return;
  }
  if (++written_ % kLookEvery == 0) bound_cache(folder_, kLargestCache, path_of(key));
}

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

}  // namespace bodyopt::trainer
