// Frames of a simulation that was killed.
#include "trainer/simulate/partial_shapes.h"

#include <xxhash.h>

#include <cstring>

#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

using namespace trainer;

constexpr std::uint64_t kInputs = 42;
constexpr int kMostIterations = 1000;  // a frame that is given up after fewer is not there
constexpr std::size_t kValues = 6, kHeader = 24, kRecord = 48 + 4 * kValues + 8;

void ignore(const std::string&) {}

std::vector<std::string> seeds() {
  return {written("shapes.partial", [](const auto& path) {
    PartialShapes shapes(path, kInputs, kValues, kMostIterations, ignore);
    for (std::uint64_t key = 1; key <= 3; ++key) shapes.append(key, {}, std::vector<float>(kValues, 1.5f));
  })};
}

// Every whole record with the checksum that it has.
std::string with_record_checksums(std::string bytes) {
  for (std::size_t at = kHeader; at + kRecord <= bytes.size(); at += kRecord) {
    const std::uint64_t sum = XXH3_64bits(bytes.data() + at, kRecord - sizeof(sum));
    std::memcpy(bytes.data() + at + kRecord - sizeof(sum), &sum, sizeof(sum));
  }
  return bytes;
}

void read(const std::string& bytes) {
  const PartialShapes shapes(as_file("shapes.partial", with_record_checksums(bytes)), kInputs, kValues, kMostIterations,
                             ignore);
  for (std::uint64_t key = 0; key < 256; ++key) {
    FrameStatus status;
    if (shapes.has(key)) shapes.read(key, status);
  }
}

const bool added = add_target({"partial_shapes", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
