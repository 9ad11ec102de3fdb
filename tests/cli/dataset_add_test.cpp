// Shapes from elsewhere, on the command line.
#include <gtest/gtest.h>

#include <fstream>

#include "assets/caches/pc2.h"
#include "dataset/dataset.h"
#include "tests/cli/limb_files.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tests/support/run_verb.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
namespace {

using namespace trainer;

// A limb, its clip of 6 frames, and shapes of them from elsewhere.
class DatasetAdd : public ::testing::Test {
 protected:
  DatasetAdd() : files_(folder_, 1), character_(read_character(files_.character)) {
    clip_ = read_clip(files_.motion, character_.skeleton, {});
    write_shapes("all.pc2", {1, 2, 3, 4, 5, 6});
  }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  void write_shapes(const std::string& name, const std::vector<int>& frames) const {
    Pc2Writer writer(folder_ / name, character_.output_count(), static_cast<std::uint32_t>(frames.size()));
    for (const int frame : frames) {
      const Pose& pose = clip_.poses[static_cast<std::size_t>(frame - 1)];
      writer.append(output_from_welded(character_, skin_linear(character_, pose)));
    }
    writer.close();
  }

  std::string begin() const { return add() + " --character " + files_.character; }
  std::string add() const { return "dataset add " + at("data") + " --clip " + files_.motion; }

  TemporaryFolder folder_;
  LimbFiles files_;
  Character character_;
  Clip clip_;
};

TEST_F(DatasetAdd, BeginsADatasetAndGoesOnWithIt) {
  write_shapes("some.pc2", {2, 5});
  write_shapes("more.pc2", {4, 3});
  ASSERT_EQ(run_verb(begin() + " --frames 2,5 --shapes " + at("some.pc2")).exit_code, 0);
  const ProgramResult added = run_verb("dataset add " + at("data/dataset.json") + " --clip " + files_.motion +
                                       " --frames 4,3 --heldout 3 --shapes " + at("more.pc2") + " --json -");
  ASSERT_EQ(added.exit_code, 0) << added.output;
  EXPECT_NE(added.output.find("\"added\": 2"), std::string::npos) << added.output;
  ASSERT_EQ(run_verb(begin() + " --name again --shapes " + at("all.pc2")).exit_code, 0);
  const Dataset dataset = read_dataset(folder_ / "data/dataset.json");
  ASSERT_EQ(dataset.takes.size(), 2u);
  EXPECT_EQ(dataset.character, "../limb.glb");
  EXPECT_EQ(dataset.takes[0].name, "bend");
  EXPECT_EQ(dataset.takes[0].frames, (std::vector<int>{2, 3, 4, 5}));
  EXPECT_EQ(dataset.takes[0].heldout, std::vector<int>{3});
  EXPECT_EQ(dataset.takes[1].frames.size(), 6u);
  // Its own copies: the dataset goes where its folder, character and clip go.
  for (const char* name : {"all.pc2", "some.pc2", "more.pc2"}) std::filesystem::remove(folder_ / name);
  EXPECT_EQ(run_verb("check " + at("data")).exit_code, 0);
}

TEST_F(DatasetAdd, WhatIsWrongIsNamedAndNothingIsWritten) {
  const auto expect = [&](int exit_code, const std::string& arguments, const std::string& named) {
    const ProgramResult result = run_verb(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << result.output;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "data/dataset.json"));
  };
  const std::string shapes = " --shapes " + at("all.pc2");
  expect(4, add() + shapes, "--character");
  expect(3, begin() + " --frames 1-5" + shapes, "6 samples");
  expect(64, begin() + " --frames 2-7" + shapes, "frame 7");
  expect(64, begin() + " --name a/b" + shapes, "--name");
  expect(64, begin() + " --heldout 7" + shapes, "--heldout");
  expect(64, add() + " --muscles m.json" + shapes, "--character");
  expect(4, begin() + " --shapes " + files_.motion, "POINTCACHE2");
  expect(4, begin() + " --shapes " + at("none.pc2"), "none.pc2");
  expect(4, "dataset add " + at("data") + " --character " + files_.character + " --clip " + at("all.pc2") + shapes,
         "all.pc2");
  expect(4, "dataset add " + at("data") + " --character " + at("all.pc2") + " --clip " + files_.motion + shapes,
         "all.pc2");
  Pc2Writer writer(folder_ / "other.pc2", 3, 6);
  for (int k = 0; k < 6; ++k) writer.append(std::vector<float>(9));
  writer.close();
  expect(3, begin() + " --shapes " + at("other.pc2"), "3 points");
}

TEST_F(DatasetAdd, ShapesElsewhereAreTakenWhereThatIsMeant) {
  Pc2Writer writer(folder_ / "moved.pc2", character_.output_count(), 6);
  for (const Pose& pose : clip_.poses) {
    Positions shape = skin_linear(character_, pose);
    shape.col(1).array() += 0.03;
    writer.append(output_from_welded(character_, shape));
  }
  writer.close();
  const ProgramResult refused = run_verb(begin() + " --shapes " + at("moved.pc2"));
  EXPECT_EQ(refused.exit_code, 3) << refused.output;
  EXPECT_NE(refused.output.find("moved by 0 0.03 0 m in all frames"), std::string::npos) << refused.output;
  EXPECT_EQ(run_verb(begin() + " --as-given --shapes " + at("moved.pc2")).exit_code, 0);
  EXPECT_EQ(run_verb("check " + at("data")).exit_code, 0);
}

// A file larger than allowed kills the program while it writes the new cache.
// Kills at any moment are the matter of scripts/attack.
TEST_F(DatasetAdd, EndedHalfWayTheOldDatasetIsThere) {
  write_shapes("five.pc2", {1, 2, 3, 4, 5});
  write_shapes("last.pc2", {6});
  ASSERT_EQ(run_verb(begin() + " --frames 1-5 --shapes " + at("five.pc2")).exit_code, 0);
  const std::string before = testing::read_bytes(folder_ / "data/dataset.json");
  const std::string add_last = add() + " --frames 6 --shapes " + at("last.pc2");
  EXPECT_EQ(run_program("ulimit -f 16; " + kProgram + " " + add_last).exit_code, 4);  // the cache grows beyond it
  EXPECT_EQ(testing::read_bytes(folder_ / "data/dataset.json"), before);
  EXPECT_EQ(run_verb("check " + at("data")).exit_code, 0);
  ASSERT_EQ(run_verb(add_last).exit_code, 0);
  EXPECT_EQ(read_dataset(folder_ / "data/dataset.json").takes[0].frames.size(), 6u);
  EXPECT_EQ(run_verb("check " + at("data")).exit_code, 0);
}

// A sculpted correction of a simulated frame stays, over what is simulated.
TEST_F(DatasetAdd, SimulateDoesNotReplaceWhatWasGiven) {
  const std::string simulate =
      "simulate " + files_.character + " --clip " + files_.motion + " --out " + at("data") + " --frames ";
  ASSERT_EQ(run_verb(simulate + "1,3").exit_code, 0);
  write_shapes("sculpted.pc2", {3});
  ASSERT_EQ(run_verb(add() + " --frames 3 --shapes " + at("sculpted.pc2")).exit_code, 64);
  const ProgramResult added = run_verb(add() + " --frames 3 --replace --shapes " + at("sculpted.pc2"));
  ASSERT_EQ(added.exit_code, 0) << added.output;
  EXPECT_EQ(run_verb(simulate + "5").exit_code, 0);
  EXPECT_EQ(run_verb("compare " + at("data") + "#bend " + at("data/bend.pc2")).exit_code, 0);
  write_shapes("given.pc2", {6});
  ASSERT_EQ(run_verb(add() + " --frames 6 --shapes " + at("given.pc2")).exit_code, 0);
  const ProgramResult refused = run_verb(simulate + "4");  // no side-car could tell them apart
  EXPECT_EQ(refused.exit_code, 3) << refused.output;
  EXPECT_NE(refused.output.find("--name"), std::string::npos) << refused.output;
  EXPECT_EQ(run_verb(simulate + "4 --name more").exit_code, 0);
  EXPECT_EQ(run_verb("check " + at("data")).exit_code, 0);
}

// The skin of a draft, as it is or corrected.
TEST_F(DatasetAdd, ADraftsNodesAreShapes) {
  ASSERT_EQ(run_verb("simulate " + files_.character + " --clip " + files_.motion + " --draft --frames 2,4 --out " +
                     at("draft"))
                .exit_code,
            0);
  ASSERT_EQ(run_verb(begin() + " --frames 2,4 --shapes " + at("draft/bend.nodes")).exit_code, 0);
  ASSERT_EQ(run_verb("export " + at("draft/bend.nodes") + " --out " + at("draft.pc2")).exit_code, 0);
  EXPECT_EQ(testing::read_bytes(folder_ / "data/bend.pc2"), testing::read_bytes(folder_ / "draft.pc2"));
}

}  // namespace
}  // namespace bodyopt
