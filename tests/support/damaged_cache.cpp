#include "tests/support/damaged_cache.h"

#include <fstream>
#include <limits>

#include "assets/caches/pc2.h"

namespace bodyopt {

void put_nan(const std::filesystem::path& cache, std::uint32_t sample, std::size_t k) {
  constexpr std::size_t kHeader = 32;
  const std::size_t place = sample * std::size_t{3} * Pc2Reader(cache).point_count() + k;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::fstream file(cache, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(kHeader + sizeof(float) * place));
  file.write(reinterpret_cast<const char*>(&nan), sizeof(nan));
}

}  // namespace bodyopt
