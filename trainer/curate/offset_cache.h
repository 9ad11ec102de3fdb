// Un-posed offsets that take longer to work out than to read, in files beside the dataset. Each is named by a hash of
// all that it comes from. They are never the only copy of anything: the folder may be removed at any time.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/content_hash.h"
#include "dataset/dataset.h"
#include "geometry/mesh.h"

namespace bodyopt::trainer {

// Hashes of what modifiers are given.

inline std::uint64_t hash_of(double number) { return XXH3_64bits(&number, sizeof(number)); }

inline std::uint64_t hash_of(const Positions& positions) {
  return XXH3_64bits(positions.data(), static_cast<std::size_t>(positions.size()) * sizeof(double));
}

// Samples (all of one size, points x 3) in a PC2 cache that is called "modifiers/OF-HASH.pc2" by what is in it. Returns
// its name, relative to the dataset's folder. Throws Error(file).
std::string keep_samples(const Dataset& dataset, const std::string& of, std::size_t count,
                         const std::function<std::vector<float>(std::size_t k)>& sample);

class OffsetCache {
 public:
  explicit OffsetCache(std::filesystem::path folder) : folder_(std::move(folder)) {}
  ~OffsetCache();
  OffsetCache(const OffsetCache&) = delete;
  OffsetCache& operator=(const OffsetCache&) = delete;

  // Reads what is kept under a key, as many numbers as there are. False: nothing, or a file that is damaged; the
  // numbers then mean nothing. On any thread.
  bool find(std::uint64_t key, std::span<float> offsets) const;
  // Keeps nothing where nothing can be written (a folder of others, a full disk). What was not asked for the longest
  // goes first. On any thread.
  void keep(std::uint64_t key, std::span<const float> offsets) const;

 private:
  std::filesystem::path path_of(std::uint64_t key) const;

  std::filesystem::path folder_;
  mutable std::atomic<std::size_t> written_{0};
};

struct PrunedFiles {
  std::size_t files = 0;
  std::uint64_t bytes = 0;
};

// Removes from modifiers/ beside a dataset.json what can be worked out again, and what is no longer named. The stack,
// stacks that undo leads to, and exports name files; `history` forgets the latter two first. Throws Error(file).
PrunedFiles prune_modifiers(const std::filesystem::path& path, bool history);

constexpr std::uint64_t kLargestCache = std::uint64_t{4} << 30;  // bytes of all that a dataset's modifiers cache

// Removes the files of a folder of caches that were not used the longest until the others are this large together;
// never `kept`.
void bound_cache(const std::filesystem::path& folder, std::uint64_t bytes, const std::filesystem::path& kept);

}  // namespace bodyopt::trainer
