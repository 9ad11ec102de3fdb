// Images behind the characters.
#include "viewport/image_plane.h"

#include <fstream>

#include "tests/support/read_bytes.h"
#include "tests/viewport/played_viewport.h"

namespace bodyopt::testing {
namespace image_plane_test {

using namespace draw;
using namespace viewport;

using Colour = std::array<std::uint8_t, 3>;
constexpr Colour kRed{200, 30, 20}, kGreen{20, 190, 40};

class ImagePlaneTest : public PlayedTest {
 protected:
  static void write_image(const std::string& file, const Colour& colour, std::uint32_t width, std::uint32_t height) {
    Image image{width, height, {}};
    for (std::uint32_t k = 0; k < width * height; ++k) {
      image.rgba.insert(image.rgba.end(), {colour[0], colour[1], colour[2], 255});
    }
    write_png(image, file);
  }
  static Colour at(const Image& image, std::uint32_t x, std::uint32_t y) {
    const std::uint8_t* p = image.rgba.data() + 4 * (std::size_t{y} * image.width + x);
    return {p[0], p[1], p[2]};
  }
};

// Of 320 x 180 pixels a square fills the 180 in the middle, and what it leaves is as it was.
TEST_F(ImagePlaneTest, FillsTheViewBehindTheBodies) {
  write_image("square.png", kRed, 20, 20);
  const auto viewport = open();
  const Image before = still(*viewport);
  viewport->prompt("image-plane square.png");
  const Image behind = still(*viewport);
  std::size_t body = 0, plane = 0, other = 0;
  for (std::uint32_t y = 0; y < 180; ++y) {
    for (std::uint32_t x = 0; x < 320; ++x) {
      const bool is_within = x >= 71 && x < 249;
      if (x < 69 || x > 250) {
        EXPECT_EQ(at(behind, x, y), at(before, x, y)) << x << " " << y;
      } else if (is_within) {
        const bool is_red = at(behind, x, y) == kRed, is_same = at(behind, x, y) == at(before, x, y);
        ++(is_red ? plane : is_same ? body : other);
      }
    }
  }
  EXPECT_GT(plane, 20000u);
  EXPECT_GT(body, 1000u);
  EXPECT_LT(other, 1000u) << "edges of the body alone";
  viewport->prompt("image-plane square.png 0.5");
  const Colour half = at(still(*viewport), 80, 5), bare = at(before, 80, 5);
  EXPECT_GT(half[0], bare[0] + 30);
  EXPECT_LT(half[0], kRed[0]);
  viewport->prompt("image-plane none");
  EXPECT_TRUE(still(*viewport).rgba == before.rgba);
}

TEST_F(ImagePlaneTest, ANameThatCannotBeIsToldOnceAndTheRestIsDrawn) {
  const auto viewport = open();
  const Image before = still(*viewport);
  viewport->prompt("image-plane a.#.b.#.png");
  ASSERT_EQ(viewport->controls().messages.size(), 1u);
  EXPECT_NE(viewport->controls().messages[0].text.find("more than one place"), std::string::npos);
  EXPECT_TRUE(still(*viewport).rgba == before.rgba);
  viewport->keys({"Right", "Left"});
  EXPECT_TRUE(viewport->controls().messages.empty());
}

// A file that cannot be read is named once, as is one that holds no image.
TEST_F(ImagePlaneTest, WhatIsNoImageIsNamedOnce) {
  std::filesystem::create_directory("folder.png");
  std::ofstream("text.png") << "no image";
  const auto viewport = open();
  for (const std::string file : {"folder.png", "text.png"}) {
    viewport->prompt("image-plane " + file);
    ASSERT_FALSE(viewport->controls().messages.empty()) << file;
    const std::string& told = viewport->controls().messages.back().text;
    EXPECT_NE(told.find(file + ": "), std::string::npos) << told;
    EXPECT_EQ(told.find(file), told.rfind(file)) << told;
  }
}

TEST_F(ImagePlaneTest, ASequenceFollowsTheFramesAndTheSessionKeepsIt) {
  std::filesystem::create_directory("plates");
  write_image("plates/p.0001.png", kRed, 32, 18);
  write_image("plates/p.0002.png", kGreen, 32, 18);
  std::ofstream("plates/p.0005.png") << "no image";
  const auto viewport = open();
  viewport->prompt("image-plane " + (folder_ / "plates/p.####.png").string());
  EXPECT_EQ(at(still(*viewport), 5, 5), kRed);
  viewport->key("Right");
  EXPECT_EQ(at(still(*viewport), 5, 5), kGreen);
  viewport->key("Right");
  ASSERT_EQ(viewport->controls().messages.size(), 1u);
  EXPECT_NE(viewport->controls().messages[0].text.find("p.0003.png"), std::string::npos);
  EXPECT_NE(at(still(*viewport), 5, 5), kGreen);
  viewport->keys({"Right", "Left", "Right"});
  EXPECT_TRUE(viewport->controls().messages.empty()) << "once is enough";
  viewport->key("Right");
  ASSERT_EQ(viewport->controls().messages.size(), 1u);
  EXPECT_NE(viewport->controls().messages[0].text.find("p.0005.png: is neither PNG"), std::string::npos);
  viewport->prompt("frame 2");
  viewport->prompt("save shot.json");
  EXPECT_EQ(read_bytes("shot.json").find(folder_.path().string()), std::string::npos) << "relative";
  ViewerOptions options = small();
  options.files = {"shot.json"};
  EXPECT_EQ(at(headless(options, "legend on"), 5, 5), kGreen);
  std::filesystem::remove_all("plates");
  const auto without = open(options, kBarePicture);
  EXPECT_EQ(without->session().scene.cast().size(), 1u) << "the rest is open";
}

}  // namespace image_plane_test
}  // namespace bodyopt::testing
