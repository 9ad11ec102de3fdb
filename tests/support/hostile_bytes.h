// Damages files in every way a disk, a network or a person does, and holds readers to a clear refusal.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tests/support/read_bytes.h"

namespace bodyopt::testing {

// Removed first: cutting a file to nothing makes some file systems wait for the disk.
void write_bytes(const std::filesystem::path& path, const std::string& bytes);

using Reader = std::function<void(const std::filesystem::path&)>;

// Runs `read`; true when it refused by Error(file) or Error(mismatch) with a message. Any other exception fails.
bool refuses(const Reader& read, const std::filesystem::path& path, const std::string& what);

void expect_refused(const Reader& read, const std::filesystem::path& path, const std::string& bytes,
                    const std::string& named);

// Every proper prefix of the file must be refused, but those that end inside its last `spare` bytes.
void expect_every_truncation_refused(const Reader& read, const std::filesystem::path& path, const std::string& bytes,
                                     std::size_t spare = 0);

// `count` files with one to three bytes changed. What is not refused is given to `accepted` by having been read.
std::size_t damage_bytes(const Reader& read, const std::filesystem::path& path, const std::string& bytes, int count);

}  // namespace bodyopt::testing
