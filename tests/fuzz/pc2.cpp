#include "assets/caches/pc2.h"

#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() {
  return {written("cache.pc2", [](const auto& path) {
    Pc2Writer writer(path, 2, 3);
    for (int k = 0; k < 3; ++k) writer.append(std::vector<float>{0, 1, 2, 3, 4, 5});
    writer.close();
  })};
}

// Two samples of one point.
std::vector<std::string> mdd_seeds() {
  std::string bytes(8 + 2 * 4 + 2 * 12, '\0');
  bytes[3] = 2;
  bytes[7] = 1;
  return {bytes};
}

void read_cache(const std::filesystem::path& path) {
  const Pc2Reader reader(path);
  require_finite(std::vector{reader.start_frame(), reader.sample_rate()}, "start frame and sample rate");
  for (std::uint32_t k = 0; k < reader.sample_count(); ++k) {
    require_finite(reader.sample(k), "a sample");
  }
}

void read(const std::string& bytes) { read_cache(as_file("cache.pc2", bytes)); }
void read_mdd(const std::string& bytes) { read_cache(as_file("cache.mdd", bytes)); }

const bool added = add_target({"pc2", seeds, read}) && add_target({"mdd", mdd_seeds, read_mdd});

}  // namespace
}  // namespace bodyopt::fuzz
