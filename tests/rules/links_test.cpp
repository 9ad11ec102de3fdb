// What the pages of the manual link to is there, and every page is found.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/read_bytes.h"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> pages() {
  const fs::path source = bodyopt::kSourceFolder;
  std::vector<fs::path> pages{source / "README.md", source / "CONTRIBUTING.md"};
  for (const auto& entry : fs::recursive_directory_iterator(source / "docs")) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  return pages;
}

// A heading's anchor, as code hosts make it: lower case, spaces as hyphens, punctuation left out.
bool has_heading(const std::string& page, const std::string& anchor) {
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) continue;
    std::string made;
    for (const char c : line.substr(line.find_first_not_of("# "))) {
      if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_') {
        made += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      } else if (c == ' ') {
        made += '-';
      }
    }
    if (made == anchor) return true;
  }
  return false;
}

TEST(Links, LeadToFilesAndHeadings) {
  static const std::regex link(R"(\]\(([^)#]*)(#([^)]*))?\))");
  int checked = 0;
  for (const fs::path& page : pages()) {
    const std::string text = bodyopt::testing::read_bytes(page);
    for (std::sregex_iterator found(text.begin(), text.end(), link), end; found != end; ++found) {
      const std::string file = (*found)[1], anchor = (*found)[3];
      if (file.starts_with("http")) continue;
      const fs::path target = file.empty() ? page : page.parent_path() / file;
      EXPECT_TRUE(fs::exists(target)) << page << " links to " << file;
      EXPECT_TRUE(anchor.empty() || has_heading(bodyopt::testing::read_bytes(target), anchor))
          << page << ": " << file << "#" << anchor;
      ++checked;
    }
  }
  EXPECT_GT(checked, 100);
}

TEST(Links, TheReadmeLeadsToEveryPageOfTheManual) {
  const fs::path source = bodyopt::kSourceFolder;
  const std::string readme = bodyopt::testing::read_bytes(source / "README.md");
  for (const auto& entry : fs::directory_iterator(source / "docs")) {
    if (entry.path().extension() != ".md") continue;
    EXPECT_NE(readme.find("(docs/" + entry.path().filename().string() + ")"), std::string::npos) << entry.path();
  }
}

}  // namespace
