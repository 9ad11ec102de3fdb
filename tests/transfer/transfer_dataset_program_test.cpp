// bodyopt transfer dataset and refine, as they are run.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "dataset/modifier.h"
#include "geometry/mesh.h"
#include "tests/support/run_verb.h"
#include "tests/support/temporary_folder.h"
#include "tests/transfer/limb_dataset.h"

namespace bodyopt::trainer {
namespace {

class TransferDatasetProgram : public ::testing::Test {
 protected:
  void SetUp() override { testing::write_limb_dataset(folder_ / "source", 40); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ProgramResult transfer(const std::string& arguments) const { return run_verb("transfer dataset " + arguments); }
  void expect_runs(const std::string& arguments) const {
    const ProgramResult result = run_verb(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments << "\n" << result.output;
  }
  Positions first_shape(const std::string& dataset) const {
    const Pc2Reader reader(path(dataset + "/bend.pc2"));
    return rows_of(reader.sample(reader.sample_count() / 2));
  }

  TemporaryFolder folder_;
};

// The same limb, in a file of decimetres.
Character in_decimetres() {
  Character limb = limb_character();
  limb.vertices *= 10;
  for (Joint& joint : limb.skeleton.joints) {
    for (double& x : joint.bind.translation) x *= 10;
    joint.default_local = joint.bind;
    for (auto& row : joint.inverse_bind.m) row[3] *= 10;
  }
  return limb;
}

TEST_F(TransferDatasetProgram, WhatIsInAnotherUnitIsADatasetAsAnyOther) {
  write_character(in_decimetres(), path("limb10.glb"));
  expect_runs("transfer dataset " + path("source") + " " + path("limb10.glb") + " --unit 0.1 --out " + path("there"));
  expect_runs("check " + path("there"));
  expect_runs("train " + path("there") + " --out " + path("there.safetensors"));
  // And back, from a source that has a unit to a target that has none.
  expect_runs("transfer dataset " + path("there") + " " + path("source/limb.glb") + " --out " + path("back"));
  expect_runs("check " + path("back"));
  // Clips that baking writes are in that unit, too.
  expect_runs("curate add " + path("there") + " symmetry");
  expect_runs("curate bake " + path("there") + " --out " + path("baked"));
  EXPECT_TRUE(std::filesystem::exists(path("baked/bend mirrored.glb")));
  expect_runs("check " + path("baked"));
  EXPECT_LT((first_shape("there") - first_shape("source")).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((first_shape("back") - first_shape("source")).cwiseAbs().maxCoeff(), 1e-5);
}

TEST_F(TransferDatasetProgram, RegionsMusclesAndHeldOutFramesGoWithIt) {
  expect_runs("transfer dataset " + path("source") + " " + path("source/limb.glb") + " --out " + path("copy"));
  const Dataset before = read_dataset(path("source/dataset.json")), after = read_dataset(path("copy/dataset.json"));
  EXPECT_EQ(after.takes.at(0).heldout, before.takes.at(0).heldout);
  EXPECT_TRUE(after.takes.at(0).carried);
  const Character limb = read_character(path("source/limb.glb"));
  EXPECT_EQ(read_muscles(path("copy/muscles.json"), limb.skeleton).size(), 2u);
  const std::vector<RegionWeights> painted = read_regions(before, limb), carried = read_regions(after, limb);
  ASSERT_EQ(carried.size(), painted.size());
  for (std::size_t r = 0; r < painted.size(); ++r) {
    EXPECT_EQ(carried[r].name, painted[r].name);
    EXPECT_EQ(carried[r].vertices, painted[r].vertices);
    for (std::size_t k = 0; k < painted[r].weights.size(); ++k) {
      ASSERT_NEAR(carried[r].weights[k], painted[r].weights[k], 1e-6);
    }
  }
}

TEST_F(TransferDatasetProgram, ATakeOfTheTargetsOwnIsNotReplaced) {
  testing::write_limb_dataset(folder_ / "own", 12);
  const Positions before = first_shape("own");
  Dataset own = read_dataset(path("own/dataset.json"));
  own.regions.clear();
  write_dataset(own, path("own/dataset.json"));
  const std::string arguments = path("source") + " " + path("own/limb.glb") + " --out " + path("own");
  const ProgramResult refused = transfer(arguments);
  EXPECT_EQ(refused.exit_code, 3) << refused.output;
  EXPECT_NE(refused.output.find("'bend'"), std::string::npos) << refused.output;
  EXPECT_EQ(read_dataset(path("own/dataset.json")).takes.at(0).frames.size(), 12u);
  EXPECT_EQ(first_shape("own"), before);
  // What a transfer wrote, another replaces.
  expect_runs("transfer dataset " + path("source") + " " + path("source/limb.glb") + " --out " + path("copy"));
  expect_runs("transfer dataset " + path("source") + " " + path("source/limb.glb") + " --out " + path("copy"));
}

TEST_F(TransferDatasetProgram, WhatTheTargetsOwnTakesGoWithStays) {
  testing::write_limb_dataset(folder_ / "own", 12, "mine");
  std::vector<Muscle> muscles = limb_muscles();
  muscles.pop_back();
  write_muscles(muscles, limb_skeleton(), path("own/muscles.json"));
  const ProgramResult result = transfer(path("source") + " " + path("own/limb.glb") + " --out " + path("own"));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("its own muscles.json is kept"), std::string::npos) << result.output;
  EXPECT_EQ(read_muscles(path("own/muscles.json"), limb_skeleton()).size(), 1u);
  EXPECT_EQ(read_dataset(path("own/dataset.json")).takes.size(), 2u);
}

// What 'refine' made of shapes is of these alone.
TEST_F(TransferDatasetProgram, WhatIsCarriedAgainIsNotCoveredByWhatWasRefinedBefore) {
  expect_runs("transfer dataset " + path("source") + " " + path("source/limb.glb") + " --out " + path("copy"));
  testing::write_limb_take(folder_ / "source", "own", 15, false);
  expect_runs("dataset add " + path("copy") + " --clip " + path("source/own.glb") + " --name own --shapes " +
              path("source/own.pc2"));
  expect_runs("transfer refine " + path("copy") + " --carried bend --json " + path("r.json"));
  const auto told = Json::parse(std::ifstream(path("r.json")));
  EXPECT_EQ(told.at("own_frames").get<int>(), 15);
  const auto refinement = [&] { return read_dataset(path("copy/dataset.json")).modifiers.at(0); };
  EXPECT_EQ(refinement().name, "refined bend");
  EXPECT_TRUE(refinement().enabled);
  const ProgramResult again = transfer(path("source") + " " + path("source/limb.glb") + " --out " + path("copy"));
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_FALSE(refinement().enabled);
  EXPECT_NE(again.output.find("'refined bend'"), std::string::npos) << again.output;
  expect_runs("transfer refine " + path("copy") + " --carried bend");
  EXPECT_TRUE(refinement().enabled);
}

// Held-out frames of what was carried are the source's: they judge how near to it the basis is.
TEST_F(TransferDatasetProgram, RefiningSaysOfHeldOutFramesThatTheyAreCarried) {
  Dataset source = read_dataset(path("source/dataset.json"));
  source.takes.front().heldout = {3, 4, 5};
  write_dataset(source, path("source/dataset.json"));
  expect_runs("transfer dataset " + path("source") + " " + path("source/limb.glb") + " --out " + path("copy"));
  testing::write_limb_take(folder_ / "source", "own", 15, false);
  expect_runs("dataset add " + path("copy") + " --clip " + path("source/own.glb") +
              " --name own --heldout 7 --shapes " + path("source/own.pc2"));
  const ProgramResult refined = run_verb("transfer refine " + path("copy") + " --carried bend");
  EXPECT_EQ(refined.exit_code, 0) << refined.output;
  EXPECT_NE(refined.output.find("3 of the 4 frames held out are carried from the source"), std::string::npos)
      << refined.output;
}

}  // namespace
}  // namespace bodyopt::trainer
