// What `muscles import` refuses to write, before it reads anything.
#include <gtest/gtest.h>

#include "tests/support/hostile_bytes.h"
#include "tests/support/run_verb.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

TEST(MusclesImport, AnOutputTakesThePlaceOfNoInputAndIsCheckedFirst) {
  const TemporaryFolder folder;
  const auto at = [&](const std::string& name) { return (folder / name).string(); };
  testing::write_bytes(folder / "mapping.json", "{}");
  const std::string import = "muscles import none.glb --from none.osim " + at("mapping.json") + " --out ";
  const auto expect = [&](int exit_code, const std::string& options, const std::string& named) {
    const ProgramResult result = run_verb(import + options);
    EXPECT_EQ(result.exit_code, exit_code) << options << "\n" << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << result.output;
  };
  expect(64, at("mapping.json"), "would write over the input");
  EXPECT_EQ(testing::read_bytes(folder / "mapping.json"), "{}");
  expect(4, at("no/muscles.json"), at("no/muscles.json"));
  expect(4, at("muscles.json") + " --picture " + at("no/muscles.png"), at("no/muscles.png"));
  expect(64, at("muscles.json") + " --picture " + at("muscles.jpg"), "does not end in .png");
}

}  // namespace
}  // namespace bodyopt
