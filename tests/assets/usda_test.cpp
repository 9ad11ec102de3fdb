// Samples of USD as text: every number reads back, whatever part of a frame it is in.
#include "assets/caches/usda.h"

#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <random>

#include "runtime/core/error.h"
#include "tests/support/read_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

// Finite floats of all sizes and both signs, the longest texts among them.
std::vector<float> numbers_of(std::size_t points) {
  std::mt19937 random(11);
  std::vector<float> numbers = {0.0f, -0.0f, 1.0f, -1.17549435e-38f, 3.40282347e38f, -1.40129846e-45f};
  while (numbers.size() < 3 * points) {
    const auto number = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (std::isfinite(number)) numbers.push_back(number);
  }
  numbers.resize(3 * points);
  for (std::size_t k = numbers.size() / 2; k < numbers.size(); ++k) numbers[k] = -1.17549435e-38f;
  return numbers;
}

// One number after the other.
std::string sample_of(const std::vector<float>& numbers) {
  std::string text;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof(digits), numbers[k]).ptr;
    text += std::string(k % 3 != 0 ? ", " : k == 0 ? "(" : ", (") + std::string(digits, end) + (k % 3 == 2 ? ")" : "");
  }
  return text;
}

CacheLayout layout_of(std::size_t points) {
  CacheLayout layout;
  layout.name = "skin";
  layout.points = static_cast<std::uint32_t>(points);
  layout.frames = {7};
  layout.fps = 24;
  return layout;
}

TEST(Usda, ASampleHoldsItsPointsInOrder) {
  const TemporaryFolder folder;
  // Less than what a thread prints at a time, as much, and parts of which the last holds one point.
  for (const std::size_t points : {1, 2, 1023, 1024, 1025, 4097}) {
    const std::vector<float> numbers = numbers_of(points);
    UsdaWriter writer(folder / "skin.usda", layout_of(points));
    writer.append(numbers, numbers);
    writer.close();
    const std::string text = testing::read_bytes(folder / "skin.usda"), sample = sample_of(numbers);
    const std::string line = "{\n        7: [" + sample + "],\n    }\n";
    const std::size_t first = text.find(line);
    ASSERT_NE(first, std::string::npos) << points;
    EXPECT_NE(text.find(line, first + 1), std::string::npos) << points;
  }
}

TEST(Usda, TheFirstPointThatIsNoNumberIsNamed) {
  const TemporaryFolder folder;
  std::vector<float> numbers = numbers_of(5000);
  numbers[3 * 4321 + 1] = numbers[3 * 4990] = std::nanf("");
  UsdaWriter writer(folder / "skin.usda", layout_of(5000));
  try {
    writer.append(numbers, {});
    ADD_FAILURE() << "it was written";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("frame 7, point 4321 is not a finite number"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace bodyopt
