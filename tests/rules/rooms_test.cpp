// Dependencies point one way: CMake says which rooms (folders) a room uses, and what its sources include is held to
// that here, as is the drawing in README.md. That there is no circle CMake sees to: a room uses those named before it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/read_bytes.h"

namespace {

namespace fs = std::filesystem;

struct Room {
  std::string folder;
  std::set<std::string> uses;
};

struct Include {
  fs::path file;
  std::string name;
};

// As CMake wrote them, each after those it uses.
std::vector<Room> rooms() {
  std::ifstream file(fs::path(bodyopt::kBuildFolder) / "rooms.txt");
  std::vector<Room> rooms;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    Room& room = rooms.emplace_back();
    words >> room.folder;
    for (std::string used; words >> used;) room.uses.insert(used);
  }
  return rooms;
}

std::vector<Include> includes_of(const fs::path& path) {
  std::vector<Include> includes;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("#include")) continue;
    const std::size_t begin = line.find_first_of("\"<");
    const std::size_t end = line.find_last_of("\">");
    includes.push_back({path, line.substr(begin + 1, end - begin - 1)});
  }
  return includes;
}

bool is_source(const fs::path& path) { return path.extension() == ".h" || path.extension() == ".cpp"; }

std::vector<Include> includes_in(const std::string& folder) {
  std::vector<Include> includes;
  for (const auto& entry : fs::directory_iterator(fs::path(bodyopt::kSourceFolder) / folder)) {
    if (!is_source(entry.path())) continue;
    const std::vector<Include> more = includes_of(entry.path());
    includes.insert(includes.end(), more.begin(), more.end());
  }
  return includes;
}

std::set<std::string> folders_of(const std::vector<Room>& rooms) {
  std::set<std::string> folders;
  for (const Room& room : rooms) folders.insert(room.folder);
  return folders;
}

TEST(Rooms, IncludeWhatTheyUseAndNoOther) {
  const std::vector<Room> all = rooms();
  ASSERT_GT(all.size(), 30u);
  const std::set<std::string> folders = folders_of(all);
  for (const Room& room : all) {
    std::set<std::string> unused = room.uses;
    for (const Include& include : includes_in(room.folder)) {
      const std::string folder = fs::path(include.name).parent_path();
      if (folder == room.folder || !folders.contains(folder)) continue;
      EXPECT_TRUE(room.uses.contains(folder)) << include.file << " includes " << include.name << ", but CMake does not "
                                              << "say that " << room.folder << " uses " << folder;
      unused.erase(folder);
    }
    for (const std::string& folder : unused) ADD_FAILURE() << room.folder << " includes nothing of " << folder;
  }
}

TEST(Rooms, HoldEverySource) {
  const std::set<std::string> folders = folders_of(rooms());
  std::set<std::string> tops;
  for (const std::string& folder : folders) tops.insert(folder.substr(0, folder.find('/')));
  for (const std::string& top : tops) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(bodyopt::kSourceFolder) / top)) {
      if (!is_source(entry.path())) continue;
      const fs::path folder = fs::relative(entry.path().parent_path(), bodyopt::kSourceFolder);
      EXPECT_TRUE(folders.contains(folder)) << entry.path() << " is in no room";
    }
  }
}

// What must stay out of a room, be it a library's header.
TEST(Rooms, KnowNoLibraryThatIsNotTheirs) {
  const std::map<std::string, std::vector<std::string>> strangers = {
      {"runtime", {"Eigen", "GLFW", "imgui", "CLI", "spdlog", "tiny_gltf"}},
      {"runtime/cpu", {"vulkan"}},
      {"runtime/host", {"vulkan"}},
      {"geometry", {"tiny_gltf", "nlohmann", "GLFW", "CLI"}},
      {"assets", {"GLFW", "CLI", "spdlog"}},
      {"trainer", {"GLFW", "imgui", "CLI", "spdlog"}},
      {"draw", {"Eigen", "GLFW", "CLI", "spdlog"}},
      {"shots", {"GLFW", "imgui", "CLI", "spdlog"}},
      {"viewport", {"CLI"}},
  };
  for (const Room& room : rooms()) {
    for (const auto& [folder, names] : strangers) {
      if (room.folder != folder && !room.folder.starts_with(folder + "/")) continue;
      for (const Include& include : includes_in(room.folder)) {
        for (const std::string& name : names) {
          EXPECT_FALSE(include.name.starts_with(name)) << include.file << " includes " << include.name;
        }
      }
    }
  }
}

// A use that another use brings along is not drawn.
std::string drawing() {
  std::map<std::string, std::set<std::string>> reached;
  std::ostringstream text;
  for (const Room& room : rooms()) {
    std::set<std::string> indirect;
    for (const std::string& used : room.uses) indirect.insert(reached[used].begin(), reached[used].end());
    text << room.folder;
    const char* separator = " -> ";
    for (const std::string& used : room.uses) {
      if (indirect.contains(used)) continue;
      text << separator << used;
      separator = ", ";
    }
    text << '\n';
    reached[room.folder] = room.uses;
    reached[room.folder].insert(indirect.begin(), indirect.end());
  }
  return text.str();
}

TEST(Rooms, AreThoseOfTheDrawingInReadme) {
  const std::string readme = bodyopt::testing::read_bytes(fs::path(bodyopt::kSourceFolder) / "README.md");
  EXPECT_NE(readme.find("```\n" + drawing() + "```\n"), std::string::npos) << "README.md should draw:\n" << drawing();
}

}  // namespace
