// Files that an earlier program wrote (tests/old_files) open, and give the bits that they gave then. limb.glb,
// bend.glb, muscles.json and the prop are those of tests/attack/write_stage.cpp; the rest came of
//   simulate limb.glb --clip bend.glb --muscles muscles.json --frames 1-24 --draft --out data
//   train data --out hero.safetensors
//   attach prop0.glb hero.safetensors
//   dynamics data --basis hero.safetensors --dynamics-resolution 100 --out hero.dynamics.safetensors
//   eval hero.safetensors --clip bend.glb --frames 1-4 --device cpu --out static.pc2
//   eval (the same) --jiggle --state-out hero.state, and from there --frames 5-8 --state-in hero.state --out
//   jiggling.pc2 export data/bend.nodes --out nodes.pc2
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "assets/caches/pc2.h"
#include "runtime/core/json.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

class OldFiles : public ::testing::Test {
 protected:
  OldFiles() { fs::copy(kSourceFolder + "/tests/old_files", folder_.path(), fs::copy_options::recursive); }

  void run(const std::string& arguments) {
    const ProgramResult result = run_verb(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments << "\n" << result.output;
  }

  std::string bytes_of(const std::string& file) { return testing::read_bytes(folder_ / file); }

  void expect_same(const std::string& now, const std::string& then) {
    EXPECT_FALSE(bytes_of(then).empty()) << then;
    EXPECT_TRUE(bytes_of(now) == bytes_of(then)) << now << " differs from " << then;
  }

  // Of what the runtime evaluates: its sums have another order since they run in lanes, 6e-8 m off at most.
  void expect_close(const std::string& now, const std::string& then) {
    const Pc2Reader a(folder_ / now), b(folder_ / then);
    ASSERT_EQ(a.sample_count(), b.sample_count());
    ASSERT_EQ(a.point_count(), b.point_count());
    EXPECT_EQ(a.start_frame(), b.start_frame());
    for (std::uint32_t k = 0; k < a.sample_count(); ++k) {
      const auto x = a.sample(k), y = b.sample(k);
      for (std::size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(x[i], y[i], 2e-7) << now << ", sample " << k;
    }
  }

  TemporaryFolder folder_;
  const WorkingFolder here_{folder_.path()};
};

TEST_F(OldFiles, ABasisAndWhatIsAttachedToItGiveTheSame) {
  run("eval hero.safetensors --clip bend.glb --frames 1-4 --device cpu --out now.pc2");
  expect_close("now.pc2", "static.pc2");
  expect_close("now.prop0.pc2", "static.prop0.pc2");
}

TEST_F(OldFiles, DynamicsGoOnFromAStateToTheSame) {
  run("eval hero.safetensors --clip bend.glb --frames 5-8 --device cpu --jiggle --state-in hero.state --out now.pc2");
  expect_close("now.pc2", "jiggling.pc2");
  expect_close("now.prop0.pc2", "jiggling.prop0.pc2");
}

TEST_F(OldFiles, WhatAskedForAModeThatIsGoneRuns) {
  const std::string eval =
      "eval hero.safetensors --clip bend.glb --frames 5-8 --device cpu --jiggle --state-in hero.state";
  run(eval + " --out plain.pc2");
  const ProgramResult asked =
      run_program("env -C " + folder_.path().string() + " " + kProgram + " " + eval + " --iterations 8 --out now.pc2");
  EXPECT_EQ(asked.exit_code, 0) << asked.output;
  EXPECT_EQ(asked.count("--iterations has no effect any more: the jiggle has one way to solve\n"), 1u) << asked.output;
  expect_same("now.pc2", "plain.pc2");
}

// As the program said that wrote the basis, with coverage among the metadata.
TEST_F(OldFiles, ABasisExpectsTheSameError) {
  run("coverage hero.safetensors --clip bend.glb --frames 1-4 --json now.json");
  std::ifstream stream(folder_ / "now.json");
  const auto frames = Json::parse(stream).at("per_frame");
  const double then[] = {0.06611640876956965, 0.09364107652589872, 0.1566561812578565, 0.09364107652588065};
  ASSERT_EQ(frames.size(), std::size(then));
  for (std::size_t k = 0; k < frames.size(); ++k) EXPECT_NEAR(frames[k].at("expected_rms_mm"), then[k], 1e-6) << k;
}

TEST_F(OldFiles, ADraftsNodesGiveTheSameBits) {
  run("export data/bend.nodes --out now.pc2");
  expect_same("now.pc2", "nodes.pc2");
}

TEST_F(OldFiles, ADatasetIsSoundAndFramesAreAddedToIt) {
  run("check data");
  run("simulate limb.glb --clip bend.glb --muscles muscles.json --frames 24-25 --draft --out data");
  // A draft of before was in another cage: its frames were solved again beside the new ones, in the tets of now.
  run("check data");
  run("export data/bend.nodes --out now.pc2");
  const Pc2Reader now(folder_ / "now.pc2"), then(folder_ / "nodes.pc2");
  EXPECT_EQ(now.sample_count(), then.sample_count() + 1);
  EXPECT_EQ(now.point_count(), then.point_count());
}

}  // namespace
}  // namespace bodyopt
