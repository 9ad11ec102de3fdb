// The list of stages, and what tells of it.
#include "runtime/host/stages.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "runtime/cpu/cpu_backend.h"
#include "tests/support/paths.h"
#include "tests/support/random_basis.h"
#include "tests/support/read_bytes.h"
#include "tests/support/stage_seconds.h"

namespace bodyopt::testing {
namespace stages_test {

namespace fs = std::filesystem;

std::string page(const std::string& path) { return read_bytes(fs::path(kSourceFolder) / path); }

std::vector<std::string> names(const std::vector<Stage>& stages) {
  std::vector<std::string> names;
  for (const Stage stage : stages) names.emplace_back(name_of(stage));
  return names;
}

TEST(Stages, StandWhereTheirIndexIs) {
  for (std::size_t k = 0; k < kStages.size(); ++k) EXPECT_EQ(index_of(kStages[k].stage), k) << kStages[k].name;
}

TEST(Stages, ThoseOfABatch) {
  const Basis plain = random_basis(20, 70);
  Batch batch;
  EXPECT_EQ(names(stages_of(plain, batch)), (std::vector<std::string>{"strain", "residual", "pose", "output"}));
  batch.jiggle.resize(1);
  EXPECT_EQ(names(stages_of(with_random_modifiers(plain, 7), batch)),
            (std::vector<std::string>{"strain", "residual", "modify", "pose", "diffuse", "jiggle", "output"}));
}

TEST(Stages, TheCpuTimesThoseOfTheBatch) {
  const Basis basis = with_random_modifiers(random_basis(20, 70), 7);
  const Batch batch = random_batch(basis, 9);
  expect_times(make_cpu_backend(model_of(basis))->run(batch).stage_seconds, stages_of(basis, batch));
}

TEST(Stages, SecondsAddUpAndNoneAreOfAStageThatDidNotRun) {
  StageSeconds seconds, more;
  seconds.add(Stage::pose, 1);
  more.add(Stage::pose, 2);
  more.add(Stage::output, 0);
  seconds.add(more);
  EXPECT_EQ(seconds.of(Stage::pose), 3);
  EXPECT_EQ(seconds.of(Stage::output), 0);
  EXPECT_EQ(seconds.of(Stage::strain), std::nullopt);
  EXPECT_EQ(seconds.sum(), 3);
}

TEST(Stages, ThePagesListThemInOrder) {
  std::string sentence;
  for (const StageDescription& stage : kStages) {
    const std::string name = stage.name;
    sentence += (sentence.empty() ? "" : ", ") + name;
    const std::string row =
        "| [" + name + "](" + name + ".md) | " + stage.applies + " | " + stage.reads + " | " + stage.writes + " | ";
    EXPECT_NE(page("docs/pipeline/README.md").find(row), std::string::npos) << row;
  }
  EXPECT_NE(page("README.md").find("**" + sentence + "**"), std::string::npos) << sentence;
}

TEST(Stages, EveryKernelIsOfOne) {
  const std::string table = page("docs/pipeline/README.md");
  for (const auto& entry : fs::directory_iterator(fs::path(kSourceFolder) / "shaders/kernels")) {
    const std::string kernel = entry.path().stem();
    EXPECT_NE(table.find("`" + kernel + "`"), std::string::npos) << kernel;
  }
}

}  // namespace stages_test
}  // namespace bodyopt::testing
