// One command from a bare character to a trained one.
#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "dataset/dataset.h"
#include "dataset/modifier.h"
#include "runtime/core/json.h"
#include "tests/cli/limb_files.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;
using testing::read_bytes;

class RangeDataset : public ::testing::Test {
 protected:
  // With the least of minutes: as many drafts as every range of motion gets.
  ProgramResult train(const std::string& more) const {
    return run_verb("train " + files_.character + " --minutes 0.1 --surface-curves 2 --out " + basis_ + " " + more);
  }
  const DatasetTake& take(const Dataset& dataset, const std::string& name) const {
    const auto found = std::ranges::find(dataset.takes, name, &DatasetTake::name);
    EXPECT_NE(found, dataset.takes.end()) << name;
    return *found;
  }

  TemporaryFolder folder_;
  LimbFiles files_{folder_, 1};
  std::string basis_ = (folder_ / "limb.safetensors").string();
  fs::path data_ = folder_ / "limb.data";
};

// A second run adds clips to what is there: drafts are not made again, and limits stay as somebody has edited them.
TEST_F(RangeDataset, LearnsABareCharacterAndThenItsClips) {
  const ProgramResult bare = train("");
  ASSERT_EQ(bare.exit_code, 0) << bare.output;
  EXPECT_EQ(read_dataset(data_ / "dataset.json").takes.size(), 1u);
  const std::string range = read_bytes(data_ / "range_of_motion.glb"),
                    drafts = read_bytes(data_ / "range_of_motion.nodes");
  Json limits = Json::parse(std::ifstream(data_ / "limits.json"));
  limits["source"] = "edited";
  std::ofstream(data_ / "limits.json") << limits;

  const ProgramResult with_clip = train("--clip " + files_.motion + " --fps 120");
  ASSERT_EQ(with_clip.exit_code, 0) << with_clip.output;
  const Dataset dataset = read_dataset(data_ / "dataset.json");
  EXPECT_EQ(dataset.takes.size(), 2u);
  // How many drafts fit into the time depends on the machine: every one, every second, every fourth ... of 26.
  const std::vector<int>& frames = take(dataset, "bend").frames;
  ASSERT_FALSE(frames.empty());
  const int step = frames.size() > 1 ? frames[1] - frames[0] : 32;
  EXPECT_TRUE(std::has_single_bit(static_cast<unsigned>(step))) << step;
  EXPECT_EQ(frames.size(), static_cast<std::size_t>((26 + step - 1) / step));
  EXPECT_GE(take(dataset, "range_of_motion").frames.size(), 100u);
  EXPECT_TRUE(read_bytes(data_ / "range_of_motion.glb") == range);
  EXPECT_TRUE(read_bytes(data_ / "range_of_motion.nodes") == drafts);
  EXPECT_EQ(Json::parse(std::ifstream(data_ / "limits.json"))["source"], "edited");
}

// A capsule is its own mirror image, and the clip is short. What somebody takes off the stack stays off.
TEST_F(RangeDataset, LearnsFewDraftsForBothSidesUntilTheStackIsEdited) {
  const Character capsule = limb_character();
  Clip twist;
  twist.name = "twist";
  for (int k = 0; k < 12; ++k) twist.poses.push_back(limb_pose(capsule.skeleton, 0.1 * k, 0.05 * k, 0));
  files_.character = (folder_ / "capsule.glb").string();
  const fs::path clip = folder_ / "twist.glb", path = data_ / "dataset.json", report = folder_ / "report.json";
  write_character(capsule, files_.character);
  write_clip(twist, capsule.skeleton, clip);
  const std::string few = "--no-range --clip " + clip.string();
  const ProgramResult trained = train(few + " --json " + report.string());
  ASSERT_EQ(trained.exit_code, 0) << trained.output;
  const std::vector<Modifier> modifiers = read_dataset(path).modifiers;
  ASSERT_EQ(modifiers.size(), 1u);
  EXPECT_EQ(modifiers[0].type, "symmetry");
  const Json told = Json::parse(std::ifstream(report));
  EXPECT_EQ(told["train_frames"].get<std::size_t>(), 2 * read_dataset(path).takes.at(0).frames.size());
  ASSERT_EQ(run_verb("curate remove " + data_.string() + " symmetry").exit_code, 0);
  ASSERT_EQ(train(few).exit_code, 0);
  EXPECT_TRUE(read_dataset(path).modifiers.empty());
}

TEST_F(RangeDataset, RefusesWhatHasNothingToLearn) {
  const ProgramResult no_clips = train("--no-range");
  EXPECT_EQ(no_clips.exit_code, 64) << no_clips.output;
  EXPECT_NE(no_clips.output.find("has no clips of its own"), std::string::npos) << no_clips.output;
  const ProgramResult twice =
      train("--clip " + files_.motion + " --clip other/" + fs::path(files_.motion).filename().string());
  EXPECT_EQ(twice.exit_code, 64) << twice.output;
  EXPECT_NE(twice.output.find("would both be the take 'bend'"), std::string::npos) << twice.output;
  const ProgramResult compared = train("--ablate");
  EXPECT_EQ(compared.exit_code, 64) << compared.output;
  EXPECT_NE(compared.output.find("give --heldout-every"), std::string::npos) << compared.output;
  EXPECT_FALSE(fs::exists(data_));
  const ProgramResult without = run_verb("train --ddm-only " + files_.character + " --minutes 3 --out " + basis_);
  EXPECT_EQ(without.exit_code, 64) << without.output;
  EXPECT_NE(without.output.find("--ddm-only simulates nothing"), std::string::npos) << without.output;
  std::ofstream(folder_ / "dataset.json") << R"({"schema": "bodyopt-dataset-1", "character": "limb.glb", "takes": []})";
  const ProgramResult dataset = run_verb("train " + folder_.path().string() + " --minutes 3 --out " + basis_);
  EXPECT_EQ(dataset.exit_code, 64) << dataset.output;
  EXPECT_NE(dataset.output.find("go with a character"), std::string::npos) << dataset.output;
}

// Options of a character do not make a dataset of anything else.
TEST_F(RangeDataset, ThatThereIsNoDatasetIsSaid) {
  for (const auto& [given, named] :
       {std::pair(folder_.path().string(), "no dataset.json in it"), {"/dev/zero", "/dev/zero"}}) {
    const ProgramResult result = run_verb("train " + given + " --minutes 3 --out " + basis_);
    EXPECT_EQ(result.exit_code, 4) << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << result.output;
    EXPECT_EQ(result.output.find("is a dataset"), std::string::npos) << result.output;
  }
}

// Takes have the names of their clips here: the way out is another folder.
TEST_F(RangeDataset, ASecondRunIsToldToNameAnotherFolder) {
  fs::create_directory(data_);
  const TakeLock another_run(data_ / "bend.nodes");
  const ProgramResult refused = train("--no-range --clip " + files_.motion);
  EXPECT_EQ(refused.exit_code, 4) << refused.output;
  EXPECT_NE(refused.output.find("or name another --data"), std::string::npos) << refused.output;
}

}  // namespace
}  // namespace bodyopt
