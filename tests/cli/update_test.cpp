// Training again after frames were added.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "runtime/core/json.h"
#include "tests/cli/limb_files.h"
#include "tests/support/run_verb.h"

namespace bodyopt {
namespace {

TEST(Update, AddedFramesAreLearnedWithWhatIsKept) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string(), basis = (folder / "limb.safetensors").string();
  const std::string simulate =
      "simulate " + files.character + " --clip " + files.motion + " --fps 120 --draft --out " + data;
  const std::string train = "train " + data + " --out " + basis + " --surface-curves 2 --json " + basis + ".json";
  ASSERT_EQ(run_verb(simulate + " --frames 1-24").exit_code, 0);
  ASSERT_EQ(run_verb(train).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "limb.training/layout.safetensors"));
  const std::string nothing = "no frame has changed since the earlier training";
  const ProgramResult same = run_verb(train + " --update");
  EXPECT_NE(same.output.find(nothing), std::string::npos) << same.output;
  ASSERT_EQ(run_verb(simulate + " --frames 25,26").exit_code, 0);
  const ProgramResult updated = run_verb(train + " --update");
  ASSERT_EQ(updated.exit_code, 0) << updated.output;
  EXPECT_NE(updated.output.find("un-posing new frames"), std::string::npos) << updated.output;
  EXPECT_EQ(updated.output.find("trained from the start"), std::string::npos) << updated.output;
  EXPECT_EQ(updated.output.find(nothing), std::string::npos) << updated.output;
  EXPECT_EQ(Json::parse(std::ifstream(basis + ".json"))["train_frames"], 26);
  const ProgramResult anew = run_verb(train + " --update --seed 2");
  ASSERT_EQ(anew.exit_code, 0) << anew.output;
  EXPECT_NE(anew.output.find("trained from the start"), std::string::npos) << anew.output;
}

TEST(Update, NeedsFrames) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string();
  ASSERT_EQ(run_verb("simulate " + files.character + " --clip " + files.motion + " --draft --heldout all --out " + data)
                .exit_code,
            0);
  const ProgramResult none = run_verb("train " + data + " --surface-curves 2 --out " + data + "/limb.safetensors");
  EXPECT_EQ(none.exit_code, 3) << none.output;
}

}  // namespace
}  // namespace bodyopt
