// The figures of README.md and docs/benchmarks.md are those of docs/figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "tests/support/paths.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using bodyopt::kSourceFolder;

// Of a project's folder.
bodyopt::ProgramResult figures(const fs::path& project, const std::string& arguments) {
  return bodyopt::run_program("python3 " + (project / "scripts/figures").string() + " " + arguments);
}

std::string without_blocks(const std::string& page) {
  std::string text;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t begin = page.find("<!-- figures:", at), end = page.find("<!-- end -->", begin);
    text += page.substr(at, begin - at);
    at = end;
  }
  return text;
}

// What scripts/figures reads and writes, in a folder of its own.
struct FigurePages {
  bodyopt::TemporaryFolder folder;

  FigurePages() {
    const fs::path source = kSourceFolder;
    fs::create_directories(folder.path() / "scripts");
    fs::create_directories(folder.path() / "docs");
    fs::copy(source / "scripts/figures", folder.path() / "scripts/figures");
    fs::copy(source / "docs/figures", folder.path() / "docs/figures");
    fs::copy(source / "docs/benchmarks.md", folder.path() / "docs/benchmarks.md");
    fs::copy(source / "README.md", folder.path() / "README.md");
  }

  void replace(const std::string& file, const std::regex& what, const std::string& by) const {
    const std::string before = bodyopt::testing::read_bytes(folder.path() / file);
    const std::string after = std::regex_replace(before, what, by, std::regex_constants::format_first_only);
    ASSERT_NE(before, after) << file;
    std::ofstream(folder.path() / file) << after;
  }
};

TEST(Figures, OfThePagesAreThoseOfTheData) {
  const bodyopt::ProgramResult result = figures(kSourceFolder, "tables --check");
  EXPECT_EQ(result.exit_code, 0) << result.output;
}

TEST(Figures, StandInBlocksAlone) {
  const std::string text = without_blocks(bodyopt::testing::read_bytes(fs::path(kSourceFolder) / "docs/benchmarks.md"));
  static const std::regex figure(R"([0-9][0-9.]* ?(mm|ms|us|s|min|MB|MiB|GiB|%|x)(?![a-z0-9]))");
  std::smatch found;
  EXPECT_FALSE(std::regex_search(text, found, figure)) << found.str() << " is written by hand";
}

TEST(Figures, READMEClaimsTwentyThingsAtMost) {
  const std::string readme = bodyopt::testing::read_bytes(fs::path(kSourceFolder) / "README.md");
  const std::size_t begin = readme.find("<!-- figures: claims -->"), end = readme.find("<!-- end -->", begin);
  ASSERT_NE(end, std::string::npos);
  const std::string block = readme.substr(begin, end - begin);
  const auto rows = std::count(block.begin(), block.end(), '\n') - 5;  // blank lines, head
  EXPECT_GE(rows, 1);
  EXPECT_LE(rows, 20);
}

TEST(Figures, AnEditedPageOrFileIsNamedAndMadeAgain) {
  const FigurePages pages;
  pages.replace("docs/benchmarks.md", std::regex("<!-- figures: demo -->\n\n"), "$&by hand\n");
  EXPECT_NE(figures(pages.folder.path(), "tables --check").output.find("benchmarks.md, demo."), std::string::npos);
  ASSERT_EQ(figures(pages.folder.path(), "tables").exit_code, 0);
  EXPECT_EQ(figures(pages.folder.path(), "tables --check").exit_code, 0);
  pages.replace("docs/figures/demo.json", std::regex(R"("rms": [0-9])"), R"("rms": 9)");
  const bodyopt::ProgramResult result = figures(pages.folder.path(), "tables --check");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("README.md, claims; benchmarks.md, demo."), std::string::npos) << result.output;
}

}  // namespace
