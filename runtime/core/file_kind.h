// Guesses the kind of a file, for messages about files of the wrong kind.
#pragma once

#include <filesystem>
#include <string>

namespace bodyopt {

// "; it looks like a BVH file", by its first bytes; empty where they tell nothing.
std::string looks_like(const std::filesystem::path& path);

}  // namespace bodyopt
