#include "trainer/check/check.h"

#include <gtest/gtest.h>

#include <functional>

#include "assets/caches/pc2.h"
#include "tests/support/temporary_folder.h"
#include "trainer/builtin/arm.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

// The built-in arm with skinned shapes for some frames of its motion, one of them spoilt in a known way.
class Check : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    arm_ = new BuiltinArm(build_arm());
    clip_ = new Clip(arm_heldout(arm_->character.skeleton, 40));
  }
  static void TearDownTestSuite() {
    delete arm_;
    delete clip_;
  }

  void SetUp() override {
    write_character(arm_->character, folder_ / "arm.glb");
    write_clip(*clip_, arm_->character.skeleton, folder_ / "clip.glb");
    dataset_.folder = folder_.path();
    dataset_.character = "arm.glb";
    DatasetTake take;
    take.name = "take";
    take.clip = "clip.glb";
    take.frames = {1, 8, 15, 22, 29, 36};
    take.shapes = "take.pc2";
    dataset_.takes = {take};
  }

  // Shapes of `shift` frames later, changed by `spoil`.
  void write_shapes(const std::function<void(Positions&)>& spoil, int shift = 0) {
    const auto& frames = dataset_.takes[0].frames;
    Pc2Writer writer(folder_ / "take.pc2", arm_->character.output_count(), static_cast<std::uint32_t>(frames.size()));
    for (const int frame : frames) {
      Positions shape =
          skin_linear(arm_->character, clip_->poses[static_cast<std::size_t>(frame + shift - clip_->first_frame)]);
      spoil(shape);
      writer.append(output_from_welded(arm_->character, shape));
    }
    writer.close();
  }

  std::string problem() const {
    const std::vector<TakeCheck> checks = check_dataset(dataset_);
    return checks[0].problems.empty() ? "" : checks[0].problems[0];
  }

  static BuiltinArm* arm_;
  static Clip* clip_;
  TemporaryFolder folder_;
  Dataset dataset_;
};
BuiltinArm* Check::arm_ = nullptr;
Clip* Check::clip_ = nullptr;

TEST_F(Check, SkinnedShapesBelong) {
  write_shapes([](Positions&) {});
  const TakeCheck check = check_dataset(dataset_)[0];
  EXPECT_TRUE(check.problems.empty()) << check.problems[0];
  EXPECT_LT(check.fit_mm, 0.01);
}

TEST_F(Check, CentimetresAreNamed) {
  write_shapes([](Positions& p) { p *= 100; });
  EXPECT_NE(problem().find("centimetres"), std::string::npos) << problem();
}

TEST_F(Check, AnotherUpAxisIsNamed) {
  write_shapes([](Positions& p) {
    const Positions y_up = p;
    p.col(1) = -y_up.col(2);
    p.col(2) = y_up.col(1);
  });
  EXPECT_NE(problem().find("Z-up"), std::string::npos) << problem();
}

TEST_F(Check, WrongCountsAreNamed) {
  write_shapes([](Positions&) {});
  dataset_.takes[0].frames.pop_back();
  EXPECT_NE(problem().find("6 samples"), std::string::npos) << problem();
  dataset_.takes[0].frames = {1, 8, 15, 22, 29, 99};
  EXPECT_NE(problem().find("frame 99"), std::string::npos) << problem();
}

TEST_F(Check, AnotherMeshIsNamed) {
  Pc2Writer writer(folder_ / "take.pc2", 3, 6);
  for (int k = 0; k < 6; ++k) writer.append(std::vector<float>(9, 0.0f));
  writer.close();
  EXPECT_NE(problem().find("3 points"), std::string::npos) << problem();
}

TEST_F(Check, SurfaceIsDescribed) {
  EXPECT_EQ(describe_surface(arm_->character), "closed, 1 piece");
  Character open = arm_->character;
  open.triangles.conservativeResize(open.triangles.rows() - 1, Eigen::NoChange);
  EXPECT_NE(describe_surface(open).find("open (3 boundary edges)"), std::string::npos);
  // Both sides of a sheet: as open as one.
  const Triangles one = open.triangles;
  open.triangles.resize(2 * one.rows(), 3);
  open.triangles << one, one.rowwise().reverse();
  const std::string twice = ", " + std::to_string(one.rows()) + " triangles there twice, 1 piece";
  EXPECT_EQ(describe_surface(open), "open (3 boundary edges)" + twice);
}

TEST_F(Check, SamplesLeaveOutHeldOutAndUnconvergedFrames) {
  write_shapes([](Positions&) {});
  DatasetTake& take = dataset_.takes[0];
  take.heldout = {8};
  take.shapes_status = "take.status.json";
  std::vector<FrameStatus> status;
  for (const int frame : {1, 8, 15, 22, 29}) {  // nothing is said of 36: it is not vouched for
    FrameStatus entry;
    entry.frame = frame;
    entry.converged = frame != 22;
    entry.residual = entry.converged ? 1e-5 : 1e-2;
    status.push_back(entry);
  }
  write_frame_status(status, folder_ / "take.status.json");
  const SampleSet set = read_samples(dataset_);
  EXPECT_EQ(set.unconverged, 2);
  ASSERT_EQ(set.heldout.size(), 1u);
  EXPECT_EQ(set.heldout[0].frame, 8);
  ASSERT_EQ(set.train.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(set.train[k].place, 2 * k);  // of 1, 15 and 29
}

TEST(HoldOutBlocks, EveryThirdBlockOfTen) {
  Dataset dataset;
  dataset.takes.resize(1);
  for (int frame = 1; frame <= 65; ++frame) dataset.takes[0].frames.push_back(frame);
  hold_out_blocks(dataset, 3);
  std::vector<int> expected;
  for (int frame = 21; frame <= 30; ++frame) expected.push_back(frame);
  for (int frame = 51; frame <= 60; ++frame) expected.push_back(frame);
  EXPECT_EQ(dataset.takes[0].heldout, expected);
}

std::string advice(std::initializer_list<int> frames_of_takes) {
  SampleSet set;
  for (const int frames : frames_of_takes) {
    for (int frame = 1; frame <= frames; ++frame) {
      set.train.emplace_back();
      set.train.back().take = static_cast<int>(set.takes.size());
      set.train.back().frame = frame;
      set.train.back().place = static_cast<std::size_t>(frame - 1);
    }
    set.takes.push_back("take");
  }
  return how_to_hold_out(set);
}

TEST(HowToHoldOut, NamesWhatHoldsOutFramesOfTakesOfThisLength) {
  EXPECT_EQ(advice({60}), "train --heldout-every 5 holds out 10 of the 60 frames");
  EXPECT_EQ(advice({41}), "train --heldout-every 5 holds out 1 of the 41 frames");
  EXPECT_EQ(advice({40}), "train --heldout-every 4 holds out 10 of the 40 frames");
  EXPECT_EQ(advice({15, 15}), "train --heldout-every 2 holds out 10 of the 30 frames");
  // Of 16, ten would be left: too few to train on.
  EXPECT_NE(advice({16}).find("too short for --heldout-every"), std::string::npos);
}

// Blocks are of the frames that were simulated, as hold_out_blocks() counts them.
TEST(HowToHoldOut, FramesThatAreLeftOutHaveTheirPlaces) {
  SampleSet set;
  set.takes = {"take"};
  for (std::size_t place = 0; place < 40; place += 2) {
    set.train.emplace_back();
    set.train.back().place = place;
  }
  EXPECT_EQ(how_to_hold_out(set), "train --heldout-every 4 holds out 5 of the 20 frames");
}

}  // namespace
}  // namespace bodyopt::trainer
