// From key to key of a clip, through the program.
#include <gtest/gtest.h>

#include "assets/clips/clip.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/png_file.h"
#include "tests/support/run_verb.h"
#include "tests/viewport/small_character.h"

namespace bodyopt::testing {
namespace {

using namespace draw;

class KeyJumpTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { test_device(); }  // the driver, for the program

  // A clip with a key at every fourth frame of 24 a second.
  void SetUp() override {
    Clip clip = bending_clip(small_.made.skeleton);
    clip.fps = 6;
    write_clip(clip, small_.made.skeleton, sparse_);
  }

  ProgramResult view(const std::string& clip, const std::string& script) const {
    const char* device = std::getenv("BODYOPT_TEST_DEVICE");
    return run_verb("view " + small_.basis + " '" + clip + "' --size 320 180 --headless -o '" +
                    (folder_ / "last.png").string() + "' --do '" + script + "'" +
                    (device ? " --device " + std::string(device) : ""));
  }
  Image picture(const std::string& script) const {
    const std::string out = (folder_ / "picture.png").string();
    const ProgramResult result = view(sparse_, script + "; screenshot " + out);
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return read_png(out);
  }

  TemporaryFolder folder_;
  SmallCharacter small_{folder_};
  std::string sparse_ = (folder_ / "SPARSE.GLB").string();
};

TEST_F(KeyJumpTest, GoesToTheKeysOfTheClip) {
  const Image fifth = picture("frame 5");
  EXPECT_TRUE(picture("next-key").rgba == fifth.rgba);
  EXPECT_TRUE(picture("frame 12; previous-key; previous-key").rgba == fifth.rgba);
  EXPECT_FALSE(picture("frame 6").rgba == fifth.rgba);
}

TEST_F(KeyJumpTest, SaysThatABakedClipHasNone) {
  for (const char* command : {"next-key", "previous-key"}) {
    const ProgramResult result = view(small_.clip, command);
    EXPECT_EQ(result.exit_code, 64);
    EXPECT_NE(result.output.find("no keys"), std::string::npos) << result.output;
  }
}

TEST_F(KeyJumpTest, AFolderMayHaveAHashInItsName) {
  const std::filesystem::path folder = folder_ / "shot#3";
  std::filesystem::create_directory(folder);
  std::filesystem::copy(sparse_, folder / "a.Glb");
  EXPECT_EQ(view((folder / "a.Glb").string(), "next-key").exit_code, 0);
}

TEST_F(KeyJumpTest, KeysAreThoseOfTheFile) {
  std::vector<int> expected;
  for (int k = 0; k < kClipFrames; ++k) expected.push_back(1001 + 4 * k);
  EXPECT_EQ(clip_keys(sparse_, {.fps = 24, .first_frame = 1001}), expected);
}

}  // namespace
}  // namespace bodyopt::testing
