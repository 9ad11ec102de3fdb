#include "assets/pc2.h"

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

void read(const std::string& bytes) {
  const Pc2Reader reader(as_file("cache.pc2", bytes));
  require_finite(std::vector{reader.start_frame(), reader.sample_rate()}, "start frame and sample rate");
  for (std::uint32_t k = 0; k < reader.sample_count(); ++k) {
    require_finite(reader.sample(k), "a sample");
  }
}

const bool added = add_target({"pc2", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
