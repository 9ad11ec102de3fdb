#include "base/disjoint_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace bodyopt {
namespace {

// Beside a list of the set of each, which every joining goes through.
TEST(DisjointSets, AreThoseOfAListThatIsRelabelled) {
  constexpr std::size_t kCount = 60;
  std::mt19937 random(5);
  std::uniform_int_distribution<std::size_t> element(0, kCount - 1);
  DisjointSets sets(kCount);
  std::vector<std::size_t> lowest(kCount);
  std::iota(lowest.begin(), lowest.end(), std::size_t{0});
  for (int joined = 0; joined < 50; ++joined) {
    const std::size_t a = element(random), b = element(random);
    sets.join(a, b);
    const std::size_t lower = std::min(lowest[a], lowest[b]), higher = std::max(lowest[a], lowest[b]);
    std::replace(lowest.begin(), lowest.end(), higher, lower);
    for (std::size_t k = 0; k < kCount; ++k) ASSERT_EQ(sets.lowest(k), lowest[k]) << joined;
  }
  EXPECT_NE(*std::max_element(lowest.begin(), lowest.end()), 0u);  // more than one is left
}

}  // namespace
}  // namespace bodyopt
