// Dependencies point one way: shaders/include -> runtime/basis -> runtime/cpu, runtime/vulkan -> deformer -> trainer,
// cli, proxy_viewer. Held by reading the includes of every source file.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/paths.h"

namespace {

namespace fs = std::filesystem;

struct Include {
  fs::path file;
  std::string name;
};

std::vector<Include> includes_below(const std::string& folder) {
  std::vector<Include> includes;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(bodyopt::kSourceFolder) / folder)) {
    const std::string extension = entry.path().extension();
    if (extension != ".h" && extension != ".cpp") continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      if (line.rfind("#include", 0) != 0) continue;
      const std::size_t begin = line.find_first_of("\"<");
      const std::size_t end = line.find_last_of("\">");
      includes.push_back({entry.path(), line.substr(begin + 1, end - begin - 1)});
    }
  }
  return includes;
}

void expect_none(const std::string& folder, const std::vector<std::string>& forbidden) {
  const std::vector<Include> includes = includes_below(folder);
  EXPECT_FALSE(includes.empty()) << folder << " holds no source file";
  for (const Include& include : includes) {
    for (const std::string& prefix : forbidden) {
      EXPECT_NE(include.name.rfind(prefix, 0), 0u) << include.file << " includes " << include.name;
    }
  }
}

TEST(DependencyArrow, RuntimeKnowsNoEigenTrainerOrWindow) {
  expect_none("runtime", {"Eigen", "trainer/", "cli/", "proxy_viewer/", "GLFW", "imgui", "CLI"});
}

TEST(DependencyArrow, TablesKnowNoBackend) {
  expect_none("runtime/basis", {"runtime/cpu/kernels", "runtime/vulkan", "runtime/deformer", "vulkan"});
}

TEST(DependencyArrow, BackendsDoNotKnowEachOther) { expect_none("runtime/cpu", {"runtime/vulkan", "vulkan"}); }

TEST(DependencyArrow, TrainerKnowsNoProgramOrWindow) {
  expect_none("trainer", {"cli/", "proxy_viewer/", "GLFW", "CLI"});
}

TEST(DependencyArrow, RendererKnowsNoTrainerOrProgram) {
  expect_none("proxy_viewer/render", {"trainer/", "cli/", "Eigen"});
}

TEST(DependencyArrow, ViewerKnowsNoProgram) { expect_none("proxy_viewer", {"cli/", "CLI"}); }

}  // namespace
