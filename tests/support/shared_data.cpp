#include "tests/support/shared_data.h"

#include <cstdlib>

namespace bodyopt {

std::optional<std::filesystem::path> shared_data(const std::string& file) {
  const char* folder = std::getenv("BODYOPT_SHARED_DATA");
  const std::filesystem::path path =
      std::filesystem::path(folder != nullptr ? folder : kSourceFolder + "/../shared/data") / file;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

}  // namespace bodyopt
