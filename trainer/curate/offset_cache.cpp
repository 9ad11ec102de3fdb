#include "trainer/curate/offset_cache.h"

#include <xxhash.h>

#include <fstream>

#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/hexadecimal.h"
#include "trainer/curate/prune.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLookEvery = 256;  // files written from one look at how large all are to the next

// Of one file under the name of another, too.
std::uint64_t check_sum(std::uint64_t key, std::span<const float> offsets) {
  return XXH3_64bits_withSeed(offsets.data(), offsets.size_bytes(), key);
}

}  // namespace

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

}  // namespace bodyopt
