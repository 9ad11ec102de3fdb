#include "assets/controls.h"

#include <gtest/gtest.h>

#include "runtime/core/error.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

using namespace testing;

const char* const kFlex = R"({"schema": "bodyopt-controls-1", "controls": {
  "biceps": [[12, 0], [14, 1], [15, 0.5]],
  "breath": 0.25}})";

Clip clip_of(int frames) {
  Clip clip;
  clip.first_frame = 11;
  clip.poses.resize(static_cast<std::size_t>(frames));
  return clip;
}

std::vector<float> values(const Clip& clip, std::size_t control) {
  std::vector<float> result;
  for (const Pose& pose : clip.poses) result.push_back(pose.controls.at(control));
  return result;
}

TEST(Controls, AreLinearBetweenKeysAndConstantBeyond) {
  const TemporaryFolder folder;
  write_bytes(folder / "c.json", kFlex);
  Clip clip = clip_of(6);
  read_controls(folder / "c.json", clip);
  EXPECT_EQ(clip.controls, (std::vector<std::string>{"biceps", "breath"}));
  EXPECT_EQ(values(clip, 0), (std::vector<float>{0, 0, 0.5f, 1, 0.5f, 0.5f}));
  EXPECT_EQ(values(clip, 1), std::vector<float>(6, 0.25f));
  read_controls(folder / "c.json", clip);  // again: replaced, not added
  EXPECT_EQ(clip.poses[0].controls.size(), 2u);
}

TEST(Controls, AreArrangedByName) {
  const TemporaryFolder folder;
  write_bytes(folder / "c.json", kFlex);
  Clip clip = clip_of(4);
  read_controls(folder / "c.json", clip);
  EXPECT_EQ(arrange_controls({"breath", "triceps"}, clip), std::vector<std::string>{"biceps"});
  EXPECT_EQ(clip.controls, (std::vector<std::string>{"breath", "triceps"}));
  EXPECT_EQ(clip.poses[3].controls, (std::vector<float>{0.25f, 0}));
  Clip bare = clip_of(2);
  EXPECT_TRUE(arrange_controls({"breath"}, bare).empty());
  EXPECT_EQ(bare.poses[1].controls, std::vector<float>{0});
}

TEST(Controls, RefuseWhatIsNoCurve) {
  const TemporaryFolder folder;
  for (const char* curve : {"[]", "\"x\"", "[1, 2]", "[[1]]", "[[1, 2, 3]]", "[[1, null]]", "[[2, 0], [1, 0]]",
                            "[[1, 0], [1, 1]]", "1e300", "[[1e300, 0]]", "{}", "true"}) {
    write_bytes(folder / "c.json",
                std::string(R"({"schema": "bodyopt-controls-1", "controls": {"biceps": )") + curve + "}}");
    Clip clip = clip_of(2);
    try {
      read_controls(folder / "c.json", clip);
      ADD_FAILURE() << curve;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
      EXPECT_NE(std::string(error.what()).find("biceps"), std::string::npos) << error.what();
    }
  }
}

TEST(Controls, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  const auto read = [](const std::filesystem::path& path) {
    Clip clip = clip_of(2);
    read_controls(path, clip);
  };
  expect_every_truncation_refused(read, folder / "c.json", kFlex);
}

}  // namespace
}  // namespace bodyopt
