// The loop of coverage, simulation and training in one command, and what it says of other motion.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "runtime/core/json.h"
#include "tests/cli/limb_files.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"

namespace bodyopt {
namespace {

class Improve : public ::testing::Test {
 protected:
  Json json(const std::string& name) const { return Json::parse(std::ifstream(folder_ / (name + ".json"))); }
  ProgramResult run(const std::string& arguments) const { return run_verb(arguments); }

  TemporaryFolder folder_;
  LimbFiles files_{folder_, 1};
  std::string data_ = (folder_ / "data").string(), basis_ = (folder_ / "limb.safetensors").string();
  std::string simulate_ = "simulate " + files_.character + " --clip " + files_.motion + " --fps 120 --draft --out ";
};

// Learned from half of the bend; the shot goes on.
TEST_F(Improve, LearnsWhatAShotLacksAndStopsWithoutAGain) {
  ASSERT_EQ(run(simulate_ + data_ + " --name half --frames 1-13").exit_code, 0);
  ASSERT_EQ(run("train " + data_ + " --surface-curves 2 --out " + basis_).exit_code, 0);
  ASSERT_EQ(run(simulate_ + (folder_ / "shot").string() + " --frames 2-26x4").exit_code, 0);
  const std::string test = "test " + basis_ + " " + (folder_ / "shot").string() + " --json " + folder_.path().string();
  ASSERT_EQ(run(test + "/before.json").exit_code, 0);
  const std::string improve = "improve " + data_ + " --basis " + basis_ + " --clip " + files_.motion +
                              " --fps 120 --json " + (folder_ / "improved.json").string();
  // Of so few none is held out: the gain is that on what is trained on.
  const ProgramResult little = run(improve + " --frames 2");
  ASSERT_EQ(little.exit_code, 0) << little.output;
  EXPECT_NE(little.output.find("2 frames more: of these shots none is held out; on the 15 trained on"),
            std::string::npos)
      << little.output;
  EXPECT_EQ(json("improved")["rounds"][0]["heldout_frames"], 0);
  const ProgramResult improved = run(improve + " --frames 10");
  ASSERT_EQ(improved.exit_code, 0) << improved.output;
  ASSERT_EQ(run(test + "/after.json").exit_code, 0);
  const auto before = json("before")["takes"][0], after = json("after")["takes"][0];
  EXPECT_LT(after["full_mm"], 0.7 * before["full_mm"].get<double>());
  EXPECT_EQ(after["ddm_mm"], before["ddm_mm"]);
  const auto rounds = json("improved")["rounds"];
  ASSERT_EQ(rounds.size(), 1u);
  EXPECT_EQ(rounds[0]["frames"], 10);
  EXPECT_EQ(rounds[0]["heldout_frames"], 2);
  EXPECT_LT(rounds[0]["after_mm"], rounds[0]["before_mm"]);
  // Once every frame is there, there is nothing left to do.
  const ProgramResult rest = run(improve + " --frames 100");
  ASSERT_EQ(rest.exit_code, 0) << rest.output;
  const bool ended = rest.output.find("every frame of the shots is simulated") != std::string::npos ||
                     rest.output.find("gain nothing") != std::string::npos;
  EXPECT_TRUE(ended) << rest.output;
}

// What was simulated for nothing would stay in the dataset.
TEST_F(Improve, ABasisOfAnotherCharacterIsRefusedBeforeAnythingIsSimulated) {
  ASSERT_EQ(run(simulate_ + data_ + " --frames 1-13").exit_code, 0);
  ASSERT_EQ(run("train " + data_ + " --surface-curves 2 --out " + basis_).exit_code, 0);
  const TemporaryFolder folder;
  const LimbFiles larger(folder, 2);
  const std::string data = (folder / "data").string();
  ASSERT_EQ(run("simulate " + larger.character + " --clip " + larger.motion + " --draft --frames 1-2 --out " + data)
                .exit_code,
            0);
  const std::string before = testing::read_bytes(data + "/dataset.json");
  const ProgramResult refused =
      run("improve " + data + " --basis " + basis_ + " --clip " + larger.motion + " --fps 120 --frames 3");
  EXPECT_EQ(refused.exit_code, 3) << refused.output;
  EXPECT_NE(refused.output.find(basis_), std::string::npos) << refused.output;
  EXPECT_NE(refused.output.find("is not of this character"), std::string::npos) << refused.output;
  EXPECT_EQ(testing::read_bytes(data + "/dataset.json"), before);
}

TEST_F(Improve, NeedsABasisThatWasTrainedOnShapes) {
  ASSERT_EQ(run(simulate_ + data_ + " --frames 1-3").exit_code, 0);
  ASSERT_EQ(run("train --ddm-only " + files_.character + " --out " + basis_).exit_code, 0);
  const ProgramResult refused = run("improve " + data_ + " --basis " + basis_ + " --clip " + files_.motion);
  EXPECT_EQ(refused.exit_code, 3) << refused.output;
  EXPECT_NE(refused.output.find("was not trained on shapes"), std::string::npos) << refused.output;
}

}  // namespace
}  // namespace bodyopt
