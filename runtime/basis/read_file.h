// A whole file in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace bodyopt {

// Reads all bytes. Throws Error(file) for folders, pipes and devices, and for what cannot be read to its end. A file of
// more than `most` bytes is refused likewise: it is perhaps not `expected` ("a muscle model").
std::string read_file(const std::filesystem::path& path, std::uint64_t most, const std::string& expected);

}  // namespace bodyopt
