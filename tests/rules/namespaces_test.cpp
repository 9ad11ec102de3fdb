// The rooms above the datasets have a namespace each, so that the compiler holds them apart; below them all is bodyopt.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <string>

#include "tests/support/paths.h"
#include "tests/support/read_bytes.h"

namespace {

namespace fs = std::filesystem;

const char* const kOwn[] = {"trainer", "shots", "farm", "draw", "report", "viewport", "cli"};
const char* const kShared[] = {"runtime", "base", "geometry", "assets", "dataset", "include", "bindings"};

template <class Take>
void for_each_source(const std::string& folder, const Take& take) {
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(bodyopt::kSourceFolder) / folder)) {
    const fs::path& path = entry.path();
    if (path.extension() == ".h" || path.extension() == ".cpp") take(path, bodyopt::testing::read_bytes(path));
  }
}

TEST(Namespaces, EachSourceOpensThatOfItsRoom) {
  for (const std::string folder : kOwn) {
    for_each_source(folder, [&](const fs::path& path, const std::string& text) {
      if (text.find("\nnamespace bodyopt") == std::string::npos) return;  // a main function
      EXPECT_NE(text.find("\nnamespace bodyopt::" + folder), std::string::npos) << path;
    });
  }
}

// To the linker two of one name are one: it takes either's destructor for both.
TEST(Namespaces, NoTwoHeadersHaveAClassOfOneName) {
  const std::regex line(
      "(?:^|\n)(?:namespace ([\\w:]+) \\{|"
      "(?:struct|class|enum class) (?:\\[\\[nodiscard\\]\\] )?([A-Z]\\w*)(?: final)?(?: :[^\n]*)? \\{)");
  std::map<std::string, fs::path> headers;
  const auto look_into = [&](const fs::path& path, const std::string& text) {
    if (path.extension() != ".h") return;
    std::string space;
    for (std::sregex_iterator found(text.begin(), text.end(), line), end; found != end; ++found) {
      if ((*found)[1].matched) space = (*found)[1];
      if (!(*found)[2].matched) continue;
      const auto [known, is_new] = headers.emplace(space + "::" + (*found)[2].str(), path);
      EXPECT_TRUE(is_new) << known->first << " is defined in " << known->second << " and in " << path;
    }
  };
  for (const char* folder : kOwn) for_each_source(folder, look_into);
  for (const char* folder : kShared) for_each_source(folder, look_into);
  EXPECT_GT(headers.size(), 200u);
}

}  // namespace
