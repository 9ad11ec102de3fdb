// A file, whole.
#pragma once

#include <filesystem>
#include <string>

namespace bodyopt::testing {

// Empty where there is none.
std::string read_bytes(const std::filesystem::path& path);

}  // namespace bodyopt::testing
