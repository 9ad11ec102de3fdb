// The program as `cmake --install` gives it to users, and what bash completes of it.
#include <gtest/gtest.h>

#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace installed_program_test {

class InstalledProgram : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const ProgramResult installed =
        run_program("cmake --install " + kBuildFolder + " --component program --prefix " + prefix());
    ASSERT_EQ(installed.exit_code, 0) << installed.output;
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string prefix() { return *folder_ / "prefix"; }

  // What bash offers for the last of these words, a line each.
  static std::string completed(const std::string& words) {
    const std::string script =
        ". " + prefix() + "/share/bash-completion/completions/bodyopt; PATH=" + prefix() + "/bin:$PATH; COMP_WORDS=(" +
        words + "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _bodyopt; printf \"%s\\n\" \"${COMPREPLY[@]}\"";
    const ProgramResult result = run_program("bash -c '" + script + "'");
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return result.output;
  }

  static inline std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(InstalledProgram, RunsAndHasTheRigsBesideIt) {
  const ProgramResult version = run_program(prefix() + "/bin/bodyopt --version");
  EXPECT_EQ(version.exit_code, 0) << version.output;
  EXPECT_EQ(version.output, run_bodyopt("--version").output);
  for (const char* file : {"materials.json", "human/muscle_volumes.json", "arm"}) {
    EXPECT_TRUE(std::filesystem::exists(prefix() + "/share/bodyopt/rigs/" + file)) << file;
  }
}

TEST_F(InstalledProgram, CompletesVerbsOptionsAndNothingElse) {
  EXPECT_EQ(completed("bodyopt ev"), "eval\n");
  EXPECT_EQ(completed("bodyopt farm s"), "submit\nstatus\n");
  EXPECT_EQ(completed("bodyopt eval hero.safetensors --cl"), "--clip\n");
  EXPECT_EQ(completed("bodyopt farm submit plan --cp"), "--cpus\n");
  EXPECT_EQ(completed("bodyopt view hero.safetensors --o"), "--out\n");
  EXPECT_EQ(completed("bodyopt eval hero"), "\n");  // a file
}

}  // namespace installed_program_test
}  // namespace bodyopt::testing
