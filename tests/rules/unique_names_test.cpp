// Two classes of one name in one program are one to the linker, which takes either's destructor for both; and sources
// of a folder are compiled several at a time, so that what two of them call alike breaks a build some day, when a third
// is added. Held by reading the sources.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/paths.h"

namespace {

namespace fs = std::filesystem;

const char* const kTopFolders[] = {"runtime", "base",   "geometry", "assets", "dataset", "farm",    "trainer",
                                   "draw",    "report", "viewport", "cli",    "shots",   "include", "bindings"};

TEST(UniqueNames, NoTwoHeadersHaveAClassOfOneName) {
  const std::regex definition(
      "^(?:struct|class|enum class) (?:\\[\\[nodiscard\\]\\] )?([A-Z]\\w*)(?: final)?(?: :.*)? \\{.*");
  std::map<std::string, fs::path> headers;
  for (const char* folder : kTopFolders) {
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

// Constants, types and functions that a source has in an unnamed namespace, each after the namespaces around it; of a
// function with its parameters, as far as they stand on its first line.
class LocalNames {
 public:
  explicit LocalNames(const fs::path& source) {
    std::ifstream file(source);
    for (std::string line; std::getline(file, line);) look_at(line);
  }
  const std::vector<std::string>& names() const { return names_; }

 private:
  void look_at(const std::string& line) {
    static const std::regex opening("^namespace ?([\\w:]*) ?\\{$"),
        constant("\\b(k[A-Z]\\w*)(?:\\[\\w*\\])? ?(?:=(?!=)|\\{)"),
        type("^(?:struct|class|enum class|union) (\\w+)(?: final)?(?: : .*)? \\{"),
        function("^(?:\\[\\[\\w+\\]\\] )?[A-Za-z_][^=;(]*[ *&](\\w+\\((?:.*?\\)(?= \\{)|.*,$))");
    std::smatch found;
    if (std::regex_search(line, found, opening)) return namespaces_.push_back(found[1].str() + "::");
    if (line.starts_with("}  // namespace")) return namespaces_.pop_back();
    if (std::ranges::find(namespaces_, "::") == namespaces_.end()) return;
    in_constants_ = in_constants_ || line.starts_with("constexpr ") || line.starts_with("const ");
    if (in_constants_) {
      for (std::sregex_iterator each(line.begin(), line.end(), constant), end; each != end; ++each) add((*each)[1]);
      in_constants_ = line.find(';') == std::string::npos && line.find(" {") == std::string::npos;
    }
    if (std::regex_search(line, found, type) || std::regex_search(line, found, function)) add(found[1]);
  }

  void add(const std::string& name) {
    std::string whole;
    for (const std::string& outer : namespaces_) whole += outer;
    names_.push_back(whole + name);
  }

  std::vector<std::string> namespaces_, names_;
  bool in_constants_ = false;  // between the first word of their definition and its end
};

TEST(UniqueNames, NoTwoSourcesOfAFolderDefineOneLocalName) {
  std::map<fs::path, std::map<std::string, fs::path>> sources;  // of each folder, by the names in them
  std::size_t count = 0;
  const auto look_into = [&](const char* top, const char* ending) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(bodyopt::kSourceFolder) / top)) {
      const fs::path& path = entry.path();
      if (!path.string().ends_with(ending)) continue;
      const LocalNames local(path);
      for (const std::string& name : local.names()) {
        const auto [known, is_new] = sources[path.parent_path()].emplace(name, path);
        EXPECT_TRUE(is_new || known->second == path)
            << name << " is defined in " << known->second << " and in " << path;
        ++count;
      }
    }
  };
  for (const char* top : kTopFolders) look_into(top, ".cpp");
  look_into("tests", "_test.cpp");
  EXPECT_GT(count, 3000u);
}

}  // namespace
