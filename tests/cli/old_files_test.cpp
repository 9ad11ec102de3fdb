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
#include <string>

#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

class OldFiles : public ::testing::Test {
 protected:
  OldFiles() { fs::copy(kSourceFolder + "/tests/old_files", folder_.path(), fs::copy_options::recursive); }

  void run(const std::string& arguments) {
    const ProgramResult result = run_program("env -C " + folder_.path().string() + " " + kProgram + " " + arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments << "\n" << result.output;
  }

  std::string bytes_of(const std::string& file) {
    std::ifstream stream(folder_ / file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  void expect_same(const std::string& now, const std::string& then) {
    EXPECT_FALSE(bytes_of(then).empty()) << then;
    EXPECT_TRUE(bytes_of(now) == bytes_of(then)) << now << " differs from " << then;
  }

  TemporaryFolder folder_;
};

TEST_F(OldFiles, ABasisAndWhatIsAttachedToItGiveTheSameBits) {
  run("eval hero.safetensors --clip bend.glb --frames 1-4 --device cpu --out now.pc2");
  expect_same("now.pc2", "static.pc2");
  expect_same("now.prop0.pc2", "static.prop0.pc2");
}

TEST_F(OldFiles, DynamicsGoOnFromAStateToTheSameBits) {
  run("eval hero.safetensors --clip bend.glb --frames 5-8 --device cpu --jiggle --state-in hero.state --out now.pc2");
  expect_same("now.pc2", "jiggling.pc2");
  expect_same("now.prop0.pc2", "jiggling.prop0.pc2");
}

TEST_F(OldFiles, ADraftsNodesGiveTheSameBits) {
  run("export data/bend.nodes --out now.pc2");
  expect_same("now.pc2", "nodes.pc2");
}

TEST_F(OldFiles, ADatasetIsSoundAndFramesAreAddedToIt) {
  run("check data");
  run("simulate limb.glb --clip bend.glb --muscles muscles.json --frames 24-25 --draft --out data");
  run("export data/bend.nodes --out now.pc2");
  // Those that were there are first, and were not solved again: their bits are the same.
  const std::string now = bytes_of("now.pc2"), then = bytes_of("nodes.pc2");
  ASSERT_GT(now.size(), then.size());
  EXPECT_TRUE(now.substr(32, then.size() - 32) == then.substr(32));
}

}  // namespace
}  // namespace bodyopt
