#include "assets/caches/nodes_cache.h"
#include "assets/caches/shape_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() {
  return {written("draft.nodes", [](const auto& path) {
    const Tets tets{{0, 1, 2, 3}, {1, 2, 3, 4}};
    const std::vector<EmbeddedPoint> skin{{0, {0.25, 0.25, 0.3, 0.2}}, {1, {0.1, 0.2, 0.3, 0.4}}};
    NodesWriter writer(path, tets, skin, 42, {1001, 1003});
    const Positions nodes{{0, 0, 0}, {1, 0, 0}, {0, 1.8, 0}, {0, 0, 0.1}, {1, 1, 1}};
    writer.append(nodes);
    writer.append(2 * nodes);
    writer.close();
  })};
}

void read(const std::string& bytes) {
  const ShapeReader reader(as_file("draft.nodes", with_checksum(bytes)));
  for (std::uint32_t k = 0; k < reader.sample_count(); ++k) require_finite(reader.sample(k), "a sample");
}

const bool added = add_target({"nodes", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
