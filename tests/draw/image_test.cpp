#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <random>

#include "draw/colours.h"
#include "draw/image_decode.h"
#include "draw/renderer.h"
#include "runtime/core/error.h"
#include "tests/support/read_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::draw {
namespace {

Image noise(std::uint32_t width, std::uint32_t height) {
  Image image{width, height, std::vector<std::uint8_t>(std::size_t{width} * height * 4)};
  std::mt19937 random(7);
  for (std::uint8_t& byte : image.rgba) byte = static_cast<std::uint8_t>(random());
  return image;
}

void expect_decodes_to(const std::vector<std::uint8_t>& png, const Image& image) {
  int width = 0, height = 0, channels = 0;
  stbi_uc* pixels = stbi_load_from_memory(png.data(), static_cast<int>(png.size()), &width, &height, &channels, 4);
  ASSERT_NE(pixels, nullptr);
  EXPECT_EQ(static_cast<std::uint32_t>(width), image.width);
  EXPECT_EQ(static_cast<std::uint32_t>(height), image.height);
  EXPECT_EQ(channels, 4);
  EXPECT_EQ(std::vector<std::uint8_t>(pixels, pixels + image.rgba.size()), image.rgba);
  stbi_image_free(pixels);
}

TEST(Png, DecodesToTheSamePixels) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, std::pair{37u, 5u}, std::pair{50u, 129u}}) {
    const Image image = noise(width, height);
    expect_decodes_to(encode_png(image), image);
  }
}

// The head of a lossless WebP that claims so many pixels a side: 14 bits of each, less one.
std::vector<std::byte> claiming(std::uint32_t side) {
  std::string bytes("RIFF\x20\0\0\0WEBPVP8L\x14\0\0\0\x2f", 21);
  const std::uint32_t sides = (side - 1) | (side - 1) << 14;
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(sides >> shift & 255);
  bytes.resize(40);
  const auto* begin = reinterpret_cast<const std::byte*>(bytes.data());
  return {begin, begin + bytes.size()};
}

// A few bytes never make a reader take hundreds of megabytes.
TEST(DecodedImage, OfFewBytesHasBoundedPixels) {
  for (const auto& [side, why] :
       {std::pair{8192u, "8192 x 8192 pixels in 40 bytes"}, std::pair{4096u, "damaged WebP"}}) {
    try {
      decode_image(claiming(side));
      FAIL() << side;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  }
}

TEST(Png, FileIsThereWholeOrNotAtAll) {
  const TemporaryFolder folder;
  const Image image = noise(8, 8);
  write_png(image, folder / "image.png");
  const std::string file = testing::read_bytes(folder / "image.png");
  expect_decodes_to({file.begin(), file.end()}, image);
  EXPECT_THROW(write_png(image, folder / "missing" / "image.png"), Error);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(Png, RefusesWhatIsNoImage) {
  EXPECT_THROW(encode_png({}), Error);
  Image image = noise(4, 4);
  image.rgba.pop_back();
  EXPECT_THROW(encode_png(image), Error);
  EXPECT_THROW(encode_png({4'000'000'000, 4'000'000'000, {}}), Error);
}

TEST(Srgb, IsTheStandardsAndEveryByteComesBack) {
  for (int k = 0; k < 256; ++k) {
    const double c = k / 255.0;
    const float light = linear(static_cast<std::uint8_t>(k));
    EXPECT_NEAR(light, c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4), 1e-6) << k;
    EXPECT_EQ(int{srgb({light, 0, 0})[0]}, k);
  }
  EXPECT_EQ(linear(255), 1);
  EXPECT_NEAR(linear(188), 0.5029, 1e-4);  // about half the light is three quarters of the way up
}

struct Lab {
  double lightness, a, b;
};

// CIE L*a*b* (D65) of linear sRGB: independent of the space in which the map was made.
Lab lab(const std::array<float, 3>& c) {
  const double r = c[0], g = c[1], b = c[2];
  const double xyz[3] = {(0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505, 0.2126 * r + 0.7152 * g + 0.0722 * b,
                         (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089};
  double f[3];
  for (int i = 0; i < 3; ++i) f[i] = xyz[i] > 0.008856 ? std::cbrt(xyz[i]) : 7.787 * xyz[i] + 16.0 / 116;
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

TEST(HeatColour, GetsDarkerAndTurnsOneWay) {
  constexpr int kSteps = 50;
  double hue = 1e9;
  for (int i = 0; i < kSteps; ++i) {
    const Lab now = lab(heat_colour(static_cast<float>(i) / kSteps));
    const Lab next = lab(heat_colour(static_cast<float>(i + 1) / kSteps));
    EXPECT_LT(next.lightness, now.lightness) << i;
    // Equal steps look about equally large.
    const double step = std::hypot(next.lightness - now.lightness, next.a - now.a, next.b - now.b);
    EXPECT_GT(step, 0.8) << i;
    EXPECT_LT(step, 9) << i;
    if (i < kSteps / 6) continue;  // too grey to have a hue
    const double angle = std::atan2(next.b, next.a);
    EXPECT_LT(angle, hue) << i;
    hue = angle;
  }
}

TEST(HeatColour, BeginsNeutralEndsMagentaStaysInRange) {
  const Lab cold = lab(heat_colour(0)), hot = lab(heat_colour(1));
  EXPECT_LT(std::hypot(cold.a, cold.b), 12);
  EXPECT_GT(hot.a, 40);
  EXPECT_GT(hot.lightness, 22);  // still seen on the dark ground
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(heat_colour(-3), heat_colour(0));
  EXPECT_EQ(heat_colour(nan), heat_colour(0));
  EXPECT_EQ(heat_colour(7), heat_colour(1));
}

}  // namespace
}  // namespace bodyopt::draw
