// Real characters and motion for tests, kept beside the checkout; tests that need them say "skipped" without.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/paths.h"

namespace bodyopt {

// The path of a file of the shared data, or nothing when it is not there. BODYOPT_SHARED_DATA overrides the folder.
inline std::optional<std::filesystem::path> shared_data(const std::string& file) {
  const char* folder = std::getenv("BODYOPT_SHARED_DATA");
  const std::filesystem::path path =
      std::filesystem::path(folder != nullptr ? folder : kSourceFolder + "/../shared/data") / file;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

}  // namespace bodyopt
