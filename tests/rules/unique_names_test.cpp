// Two classes of one name in one program are one to the linker, which takes either's destructor for both. Held by
// reading the headers.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>

#include "tests/support/paths.h"

namespace {

namespace fs = std::filesystem;

TEST(UniqueNames, NoTwoHeadersHaveAClassOfOneName) {
  const std::regex definition("^(?:struct|class|enum class) ([A-Z]\\w*)(?: final)?(?: :.*)? \\{.*");
  std::map<std::string, fs::path> headers;
  for (const char* folder : {"runtime", "base", "geometry", "assets", "dataset", "farm", "trainer", "draw", "report",
                             "proxy_viewer", "cli"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(bodyopt::kSourceFolder) / folder)) {
      if (entry.path().extension() != ".h") continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) {
        std::smatch name;
        if (!std::regex_match(line, name, definition)) continue;
        const auto [known, is_new] = headers.emplace(name[1], entry.path());
        EXPECT_TRUE(is_new) << name[1] << " is defined in " << known->second << " and in " << entry.path();
      }
    }
  }
  EXPECT_GT(headers.size(), 200u);
}

}  // namespace
