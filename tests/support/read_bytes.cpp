#include "tests/support/read_bytes.h"

#include <fstream>
#include <iterator>

namespace bodyopt::testing {

std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace bodyopt::testing
