// The verb that makes dynamics.
#include "runtime/basis/dynamics.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "runtime/basis/safetensors.h"
#include "runtime/core/json.h"
#include "tests/cli/limb_files.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/run_verb.h"

namespace bodyopt {
namespace {

// A limb in centimetres with its basis of Direct Delta Mush.
struct LimbBasis {
  LimbBasis() : files(folder, 100) {
    const ProgramResult made = run_verb("train --ddm-only " + files.character + " --unit 0.01 --out " + basis);
    EXPECT_EQ(made.exit_code, 0) << made.output;
  }
  ProgramResult dynamics(const std::string& more) const {
    return run_verb("dynamics " + files.character + " --basis " + basis + " --out " + out + more);
  }
  TemporaryFolder folder;
  LimbFiles files;
  std::string basis = (folder / "limb.safetensors").string(), out = (folder / "limb.dynamics.safetensors").string();
};

TEST(DynamicsVerb, WritesWhatTheOptionsSayAndInfoReadsIt) {
  const LimbBasis limb;
  testing::write_bytes(limb.folder / "jiggle.json",
                       R"({"schema": "bodyopt-jiggle-1", "regions": [{"joint": "lower", "amount": 0}]})");
  const ProgramResult made = limb.dynamics(" --jiggle " + (limb.folder / "jiggle.json").string() +
                                           " --fps 30 --substeps 2 --integrator euler --json " + limb.out + ".json");
  ASSERT_EQ(made.exit_code, 0) << made.output;
  EXPECT_EQ(made.count("--integrator has no effect any more: all dynamics step by TR-BDF2\n"), 1u);
  const Dynamics dynamics = load_dynamics(limb.out, load_basis(limb.basis));
  EXPECT_EQ(dynamics.jiggle.step.frames_per_second, 30);
  EXPECT_EQ(dynamics.jiggle.step.substeps, 2u);
  EXPECT_FALSE(dynamics.jiggle.step.implicit_euler);
  float least = 1, most = 0;
  for (const TetPoint& point : dynamics.tets.skin) {
    least = std::min(least, point.amount);
    most = std::max(most, point.amount);
  }
  EXPECT_EQ(least, 0);
  EXPECT_EQ(most, 1);
  const auto json = Json::parse(std::ifstream(limb.out + ".json"));
  EXPECT_EQ(json["tets"], dynamics.tets.tet_count());
  EXPECT_EQ(json["bytes"]["jiggle"], table_bytes(dynamics).at("jiggle"));
  EXPECT_GT(json["bone_springs"], 0);
  const ProgramResult info = run_verb("info " + limb.out + " --json -");
  ASSERT_EQ(info.exit_code, 0) << info.output;
  const auto told = Json::parse(info.output);
  EXPECT_EQ(told["kind"], "dynamics");
  EXPECT_EQ(told["nodes"], dynamics.tets.node_count());
  EXPECT_EQ(told["frames_per_second"], 30);
  EXPECT_EQ(told["substeps"], 2);
  EXPECT_EQ(told["integrator"], "tr-bdf2");
  EXPECT_EQ(told["quality"], json["quality"]);
  EXPECT_EQ(told["inverted_tets"]["poses"], 0);
  EXPECT_EQ(told["provenance"]["regions"], Json::parse(R"([{"joint": "lower", "amount": 0}])"));
}

TEST(DynamicsVerb, InfoNamesATensorOfOneNumber) {
  const LimbBasis limb;
  ASSERT_EQ(limb.dynamics("").exit_code, 0);
  Safetensors file = read_safetensors(limb.out);
  file.tensors.at("tets.surface") = {"U32", {}, std::vector<std::byte>(4)};
  file.metadata["checksum"] = content_checksum(file);
  write_safetensors(file, limb.out);
  const ProgramResult info = run_verb("info " + limb.out);
  EXPECT_EQ(info.exit_code, 4) << info.output;
  EXPECT_NE(info.output.find(limb.out + ": tensor 'tets.surface' is a single number"), std::string::npos)
      << info.output;
}

TEST(DynamicsVerb, MistakesEndWithTheCauseAndWriteNothing) {
  const LimbBasis limb;
  const std::string jiggle = (limb.folder / "jiggle.json").string();
  const auto expect = [&](const std::string& content, int code, const char* named) {
    testing::write_bytes(jiggle, content);
    const ProgramResult result = limb.dynamics(" --jiggle " + jiggle);
    EXPECT_EQ(result.exit_code, code) << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << result.output;
    EXPECT_NE(result.output.find(jiggle), std::string::npos) << result.output;
  };
  expect(R"({"schema": "bodyopt-jiggle-1", "poisson": 0.5})", 4, "'poisson' is 0.5");
  expect(R"({"schema": "bodyopt-jiggle-1", "regions": [{"joint": "tail", "softness": 2}]})", 3, "'upper', 'lower'");
  EXPECT_EQ(limb.dynamics(" --fps 0").exit_code, 64);
  EXPECT_EQ(limb.dynamics(" --fps nan").exit_code, 64);
  EXPECT_EQ(limb.dynamics(" --substeps 0").exit_code, 64);
  EXPECT_FALSE(std::filesystem::exists(limb.out));
  EXPECT_EQ(run_verb("dynamics " + limb.files.character + " --basis " + limb.basis + " --out " + limb.basis).exit_code,
            64);
}

TEST(DynamicsVerb, SettingsTakeThePlaceOfNoInputAndNoOtherFile) {
  const LimbBasis limb;
  const std::string jiggle = (limb.folder / "jiggle.json").string(), other = (limb.folder / "other.json").string();
  const auto expect_kept = [&](int code, const ProgramResult& result, const std::string& file, const std::string& was) {
    EXPECT_EQ(result.exit_code, code) << result.output;
    EXPECT_NE(result.output.find(file), std::string::npos) << result.output;
    EXPECT_EQ(testing::read_bytes(file), was);
    EXPECT_FALSE(std::filesystem::exists(limb.out));
  };
  const std::string settings = R"({"schema": "bodyopt-jiggle-1"})", muscles = R"({"schema": "bodyopt-muscles-1"})";
  testing::write_bytes(jiggle, settings);
  testing::write_bytes(other, muscles);
  expect_kept(64, limb.dynamics(" --jiggle " + jiggle + " --jiggle-out " + jiggle), jiggle, settings);
  expect_kept(4, limb.dynamics(" --jiggle-out " + other), other, muscles);
  const std::string dataset = (limb.folder / "dataset.json").string();
  testing::write_bytes(dataset, "{}");
  expect_kept(64,
              run_verb("dynamics " + limb.folder.path().string() + " --basis " + limb.basis + " --out " + limb.out +
                       " --jiggle-out " + dataset),
              dataset, "{}");
  EXPECT_EQ(limb.dynamics(" --dynamics-resolution 600 --jiggle-out " + jiggle).exit_code, 0);  // it is of their kind
}

}  // namespace
}  // namespace bodyopt
