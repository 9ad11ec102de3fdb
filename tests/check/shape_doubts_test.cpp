// Shapes that belong to their character, and are odd all the same.
#include "trainer/check/shape_doubts.h"

#include <gtest/gtest.h>

#include "tests/support/capsule_limb.h"
#include "tests/support/temporary_folder.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

TEST(ShapeDoubts, NoneOfASoundTake) { EXPECT_TRUE(shape_doubts(limb_samples(60, 0)).empty()); }

// The end of the limb stays as the joint above has it, as when a lattice glued it.
TEST(ShapeDoubts, NameThePartThatDoesNotFollowItsJoint) {
  SampleSet set = limb_samples(40, 0);
  for (Sample& sample : set.train) {
    Pose stiff = sample.pose;
    stiff.joints[1] = set.character.skeleton.joints[1].bind;
    sample.shape = skin_linear(set.character, stiff);
  }
  const std::vector<std::string> doubts = shape_doubts(set);
  ASSERT_FALSE(doubts.empty());
  EXPECT_NE(doubts[0].find("'joint1' follows its joint by 0 %"), std::string::npos) << doubts[0];
}

// By more than tissue lags behind, and by no more.
TEST(ShapeDoubts, NameThePartThatIsHeldBackInPart) {
  const auto doubts_of = [](double following) {
    SampleSet set = limb_samples(40, 0);
    for (Sample& sample : set.train) {
      Pose stiff = sample.pose;
      stiff.joints[1] = set.character.skeleton.joints[1].bind;
      sample.shape = Positions(following * skin_linear(set.character, sample.pose) +
                               (1 - following) * skin_linear(set.character, stiff));
    }
    return shape_doubts(set);
  };
  const std::vector<std::string> glued = doubts_of(0.6);
  ASSERT_FALSE(glued.empty());
  EXPECT_NE(glued[0].find("'joint1' follows its joint by 60 %"), std::string::npos) << glued[0];
  EXPECT_TRUE(doubts_of(0.8).empty());
}

TEST(ShapeDoubts, NameAVertexThatFliesAwayByItsFrame) {
  SampleSet set = limb_samples(40, 0);
  Sample& sample = set.train[12];
  Positions shape = sample.shape.read();
  shape(100, 0) += 0.3;
  sample.shape = shape;
  const std::vector<std::string> doubts = shape_doubts(set);
  ASSERT_EQ(doubts.size(), 1u);
  const std::string place = "frame " + std::to_string(sample.frame) + ": vertex 100 flies ";
  EXPECT_NE(doubts[0].find(place), std::string::npos) << doubts[0];
}

TEST(ShapeDoubts, FindEveryVertexThatFliesAwayInALongTake) {
  SampleSet set = limb_samples(200, 0);
  const std::vector<std::size_t> off = {3, 58, 59, 131};
  for (const std::size_t n : off) {
    Positions shape = set.train[n].shape.read();
    shape(100, 0) += 0.4;
    set.train[n].shape = shape;
  }
  const std::vector<std::string> doubts = shape_doubts(set);
  ASSERT_EQ(doubts.size(), off.size());
  for (std::size_t k = 0; k < off.size(); ++k) {
    const std::string place = "frame " + std::to_string(set.train[off[k]].frame) + ": vertex 100 flies ";
    EXPECT_NE(doubts[k].find(place), std::string::npos) << doubts[k];
  }
}

TEST(ShortTakes, AreThoseOfWhichNothingCanBeHeldOut) {
  Dataset dataset;
  for (const int frames : {10, 11, 5}) {
    DatasetTake& take = dataset.takes.emplace_back();
    take.name = "take " + std::to_string(frames);
    take.frames.resize(static_cast<std::size_t>(frames));
  }
  dataset.takes.back().heldout = {1};
  const std::vector<std::string> sentences = short_takes(dataset);
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_NE(sentences[0].find("'take 10' has 10 frames"), std::string::npos);
}

TEST(CoarseTakes, AreThoseThatTrainingComesNearerToThanTheyAreToTheTruth) {
  const TemporaryFolder folder;
  Dataset dataset;
  dataset.folder = folder.path();
  for (const double error : {0.4e-3, 1.24e-3}) {
    DatasetTake& take = dataset.takes.emplace_back();
    take.name = take.shapes_status = "take" + std::to_string(dataset.takes.size());
    std::vector<FrameStatus> status(3);
    for (int k = 0; k < 3; ++k) status[static_cast<std::size_t>(k)].frame = k;
    status[1].discretisation_error = error;
    write_frame_status(status, folder / take.shapes_status);
  }
  dataset.takes.emplace_back().name = "without a side-car";
  const std::vector<std::string> sentences = coarse_takes(dataset);
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_NE(sentences[0].find("'take2': finer tets would move the skin by about 1.2 mm"), std::string::npos);
}

}  // namespace
}  // namespace bodyopt::trainer
