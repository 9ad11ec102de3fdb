// bodyopt curate, as it is run.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/curate/curated_limb.h"
#include "tests/support/png_file.h"
#include "tests/support/run_program.h"
#include "trainer/curate/edit_stack.h"

namespace bodyopt {
namespace {

class CurateProgram : public ::testing::Test {
 protected:
  ProgramResult curate(const std::string& verb, const std::string& options) const {
    return run_bodyopt("curate " + verb + " " + limb_.folder().string() + " " + options);
  }
  std::string at(const std::string& name) const { return (limb_.folder() / name).string(); }

  CuratedLimb limb_;
};

// Where the middle of a third of the picture lies, its red less its blue: clay is less red than heat.
int warmth(const Image& image, std::uint32_t third) {
  int most = -255;
  const std::uint32_t width = image.width / 3;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = third * width; x < (third + 1) * width; ++x) {
      const std::uint8_t* pixel = image.rgba.data() + 4 * (std::size_t{y} * image.width + x);
      most = std::max(most, int{pixel[0]} - int{pixel[2]});
    }
  }
  return most;
}

TEST_F(CurateProgram, DiffDrawsTheFrameThatAModifierMovesMost) {
  add_modifier(limb_.path(), {.type = "inflate",
                              .frames = {{{"take", "one"}, {"frames", "7"}}},
                              .mask = {{"joints", {limb_.character().skeleton.joints[1].name}}},
                              .parameters = {{"distance_mm", 5}}});
  const ProgramResult drawn = curate("diff", "inflate --picture " + at("p.png"));
  ASSERT_EQ(drawn.exit_code, 0) << drawn.output;
  EXPECT_NE(drawn.output.find("one 7 before 'inflate'"), std::string::npos) << drawn.output;
  // What is darkest in the picture is the table's largest.
  EXPECT_NE(drawn.output.find("darkest at 5.00 mm"), std::string::npos) << drawn.output;
  EXPECT_NE(drawn.output.find(" 5.000   one 7"), std::string::npos) << drawn.output;
  const Image image = testing::read_png(at("p.png"));
  EXPECT_GT(warmth(image, 2), warmth(image, 0) + 60);
  EXPECT_LT(std::abs(warmth(image, 1) - warmth(image, 0)), 30);
}

TEST_F(CurateProgram, DiffDrawsNothingOfWhatMovesNothing) {
  add_modifier(limb_.path(), {.type = "drop", .frames = {{{"take", "one"}, {"frames", "7"}}}});
  EXPECT_EQ(curate("diff", "drop --picture " + at("p.png")).exit_code, 64);
  EXPECT_EQ(curate("diff", "--picture " + at("p.png")).exit_code, 64);
  EXPECT_FALSE(std::filesystem::exists(at("p.png")));
}

TEST_F(CurateProgram, AnExportedFrameComesBackAsItIs) {
  const std::string frame = "--take one --frame 5 ";
  ASSERT_EQ(curate("export-frame", frame + "--out " + at("frame.obj")).exit_code, 0);
  std::stringstream text;
  text << std::ifstream(at("frame.obj")).rdbuf();
  EXPECT_NE(text.str().find("usemtl " + limb_.character().skeleton.joints[1].name), std::string::npos);
  const ProgramResult back = curate("import-frame", frame + "--mesh " + at("frame.obj") + " --name s");
  ASSERT_EQ(back.exit_code, 0) << back.output;
  EXPECT_NE(back.output.find("nothing is changed"), std::string::npos) << back.output;
  EXPECT_TRUE(read_dataset(limb_.path()).modifiers.empty());
  EXPECT_EQ(limb_.stack().shape(4), limb_.stack().database().raw_shape(4));
}

}  // namespace
}  // namespace bodyopt
