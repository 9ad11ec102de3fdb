#include "assets/clips/controls.h"

#include <gtest/gtest.h>

#include "runtime/core/error.h"
#include "tests/support/error_kind.h"
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

TEST(Controls, AreReadFromATableAndWrittenBack) {
  const TemporaryFolder folder;
  write_bytes(folder / "c.csv", "frame,biceps,breath.rate\r\n12,0,14\n14,1,20\n");
  Clip clip = clip_of(4);
  read_controls(folder / "c.csv", clip);
  EXPECT_EQ(clip.controls, (std::vector<std::string>{"biceps", "breath.rate"}));
  EXPECT_EQ(values(clip, 0), (std::vector<float>{0, 0, 0.5f, 1}));
  EXPECT_EQ(values(clip, 1), (std::vector<float>{14, 14, 17, 20}));
  write_controls(clip, folder / "written.json");
  Clip again = clip_of(4);
  read_controls(folder / "written.json", again);
  EXPECT_EQ(again.controls, clip.controls);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(again.poses[k].controls, clip.poses[k].controls);
  EXPECT_TRUE(clip.notes.empty());
  Clip other = clip_of(4);
  other.first_frame = 1001;
  read_controls(folder / "c.csv", other);
  ASSERT_EQ(other.notes.size(), 1u);  // of both channels
  for (const char* told : {"'biceps', 'breath.rate'", "frame 12 to 14", "1001 to 1004", "they are held all along"}) {
    EXPECT_NE(other.notes[0].find(told), std::string::npos) << other.notes[0];
  }
  // Keys on both sides, so that the frames of all of them would hold the clip's.
  write_bytes(folder / "sides.json",
              R"({"schema": "bodyopt-controls-1", "fps": 24,
                  "controls": {"early": [[1, 0], [5, 1]], "late": [[2001, 0], [2005, 1]]}})");
  Clip between = clip_of(4);
  between.first_frame = 1001;
  read_controls(folder / "sides.json", between);
  ASSERT_EQ(between.notes.size(), 1u);
  EXPECT_NE(
      between.notes[0].find("the keys of 'early', from frame 1 to 5, and of 'late', from frame 2001 to 2005, are"),
      std::string::npos)
      << between.notes[0];
  for (const char* table : {"", "frame\n1\n", "time,a\n1,2\n", "frame,a,a\n1,2,3\n", "frame,a\n", "frame,a\n1\n",
                            "frame,a\n1,2,3\n", "frame,a\n1,x\n", "frame,a\n1,nan\n", "frame,a\n2,0\n1,0\n"}) {
    write_bytes(folder / "bad.csv", table);
    EXPECT_EQ(kind_of([&] { read_controls(folder / "bad.csv", clip); }), ErrorKind::file) << table;
  }
}

TEST(Controls, OfAnotherRateAreRefused) {
  const TemporaryFolder folder;
  write_bytes(folder / "c.json", R"({"schema": "bodyopt-controls-1", "fps": 30, "controls": {"breath": 1}})");
  Clip clip = clip_of(2);
  EXPECT_EQ(kind_of([&] { read_controls(folder / "c.json", clip); }), ErrorKind::mismatch);
  clip.fps = 30;
  read_controls(folder / "c.json", clip);
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
