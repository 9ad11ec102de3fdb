// Sound MDD and PC2 files of points at random, put together byte by byte, and the points that are read of them.
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <random>

#include "assets/caches/pc2.h"
#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() { return {"bodyopt!", "a number"}; }

void append(std::string& bytes, std::uint32_t word, bool is_big_endian) {
  for (int k = 0; k < 4; ++k) bytes += static_cast<char>(word >> 8 * (is_big_endian ? 3 - k : k));
}

void read(const std::string& bytes) {
  std::mt19937_64 random(XXH3_64bits(bytes.data(), bytes.size()));
  const bool is_mdd = random() % 2 == 0;
  const auto samples = static_cast<std::uint32_t>(1 + random() % 4),
             points = static_cast<std::uint32_t>(1 + random() % 9);
  const auto put = [&](std::string& file, std::uint32_t word) { append(file, word, is_mdd); };
  std::string file;
  if (is_mdd) {
    put(file, samples);
    put(file, points);
    for (std::uint32_t k = 0; k < samples; ++k) put(file, std::bit_cast<std::uint32_t>(static_cast<float>(k) / 24));
  } else {
    file = std::string("POINTCACHE2\0", 12);
    for (const std::uint32_t word :
         {1u, points, std::bit_cast<std::uint32_t>(1.0f), std::bit_cast<std::uint32_t>(1.0f), samples}) {
      put(file, word);
    }
  }
  std::uniform_real_distribution<float> number(-3, 3);
  std::vector<float> numbers(std::size_t{3} * samples * points);
  for (float& x : numbers) put(file, std::bit_cast<std::uint32_t>(x = number(random)));
  const Pc2Reader reader(as_file(is_mdd ? "random.mdd" : "random.pc2", file));
  bool is_right = reader.sample_count() == samples && reader.point_count() == points && reader.start_frame() == 1;
  for (std::uint32_t k = 0; is_right && k < samples; ++k) {
    is_right = std::ranges::equal(reader.sample(k),
                                  std::span(numbers).subspan(std::size_t{3} * points * k, std::size_t{3} * points));
  }
  if (is_right) return;
  std::cerr << "WRONG: " << samples << " samples of " << points << " points\n";
  std::abort();
}

const bool added = add_target({"random_shapes", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
