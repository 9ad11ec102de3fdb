// What a dataset keeps for its modifiers and needs no longer.
#pragma once

#include <cstdint>
#include <filesystem>

namespace bodyopt {

struct PrunedFiles {
  std::size_t files = 0;
  std::uint64_t bytes = 0;
};

// Removes from modifiers/ beside a dataset.json what can be worked out again, and what neither the stack nor any that
// undo leads to names; with `history` the stacks that there were are forgotten first. Throws Error(file).
PrunedFiles prune_modifiers(const std::filesystem::path& path, bool history);

constexpr std::uint64_t kLargestCache = std::uint64_t{4} << 30;  // bytes of all that a dataset's modifiers cache

// Removes the files of a folder of caches that were not used the longest until the others are this large together;
// never `kept`.
void bound_cache(const std::filesystem::path& folder, std::uint64_t bytes, const std::filesystem::path& kept);

}  // namespace bodyopt
