#include "draw/animation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "runtime/core/error.h"
#include "tests/support/decoded_animation.h"

namespace bodyopt::draw {
namespace {

// A soft grey disc on a dark ground, as a shaded skin is.
Image disc(double x, double y) {
  Image image{64, 48, {}};
  for (int row = 0; row < 48; ++row) {
    for (int column = 0; column < 64; ++column) {
      const double distance = std::hypot(column - x, row - y);
      const auto grey = static_cast<std::uint8_t>(std::lround(30 + 170 * std::exp(-distance * distance / 120)));
      image.rgba.insert(image.rgba.end(), {grey, grey, grey, 255});
    }
  }
  return image;
}

TEST(Animation, DecodesToItsFramesInTime) {
  const std::vector<Image> frames{disc(12, 20), disc(24, 24), disc(36, 28), disc(52, 20)};
  const DecodedAnimation decoded = decode_animation(encode_animation(frames, 1000.0 / 24));
  EXPECT_EQ(decoded.width, 64u);
  EXPECT_EQ(decoded.height, 48u);
  EXPECT_EQ(decoded.loops, 0u);  // for ever
  EXPECT_EQ(decoded.ends, (std::vector<int>{42, 83, 125, 167}));
  ASSERT_EQ(decoded.frames.size(), frames.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    int largest = 0;
    for (std::size_t i = 0; i < frames[k].rgba.size(); ++i) {
      largest = std::max(largest, std::abs(int{decoded.frames[k][i]} - int{frames[k].rgba[i]}));
    }
    EXPECT_LE(largest, 6) << k;
  }
}

TEST(Animation, HeldFramesBecomeOneThatLasts) {
  const Image held = disc(20, 20), moved = disc(44, 20);
  const DecodedAnimation decoded = decode_animation(encode_animation(std::vector{held, held, held, moved}, 40));
  EXPECT_EQ(decoded.ends, (std::vector<int>{120, 160}));
}

TEST(Animation, RefusesWhatIsNone) {
  const Image whole = disc(20, 20);
  Image torn = whole, wide = whole;
  torn.rgba.pop_back();
  std::swap(wide.width, wide.height);
  EXPECT_THROW(encode_animation({}, 40), Error);
  EXPECT_THROW(encode_animation(std::vector{whole, torn}, 40), Error);
  EXPECT_THROW(encode_animation(std::vector{whole, wide}, 40), Error);
  EXPECT_THROW(encode_animation(std::vector{Image{20000, 1, std::vector<std::uint8_t>(80000)}}, 40), Error);
  EXPECT_THROW(encode_animation(std::vector{whole}, 0.5), Error);
  EXPECT_THROW(encode_animation(std::vector{whole}, std::numeric_limits<double>::quiet_NaN()), Error);
}

}  // namespace
}  // namespace bodyopt::draw
