// A whole file in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace bodyopt {

// Its bytes. Throws Error(file) for what is no file (folders, pipes, devices), for one that cannot be read to its end,
// and for one of more than `most` bytes, which is then perhaps not `expected` ("a muscle model").
std::string read_file(const std::filesystem::path& path, std::uint64_t most, const std::string& expected);

}  // namespace bodyopt
