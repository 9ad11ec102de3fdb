// Damages files in every way a disk, a network or a person does, and holds readers to a clear refusal.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>

#include "runtime/core/error.h"
#include "tests/support/read_bytes.h"

namespace bodyopt::testing {

// Removed first: cutting a file to nothing makes some file systems wait for the disk.
inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::remove(path);
  std::ofstream(path, std::ios::binary | std::ios::trunc).write(bytes.data(), std::ssize(bytes));
}

using Reader = std::function<void(const std::filesystem::path&)>;

// Runs `read`; true when it refused by Error(file) or Error(mismatch) with a message. Any other exception fails.
inline bool refuses(const Reader& read, const std::filesystem::path& path, const std::string& what) {
  try {
    read(path);
    return false;
  } catch (const Error& error) {
    EXPECT_TRUE(error.kind() == ErrorKind::file || error.kind() == ErrorKind::mismatch) << what << ": " << error.what();
    EXPECT_GT(std::string(error.what()).size(), 20u) << what;
  } catch (const std::exception& error) {
    ADD_FAILURE() << what << " escaped as another exception: " << error.what();
  }
  return true;
}

inline void expect_refused(const Reader& read, const std::filesystem::path& path, const std::string& bytes,
                           const std::string& named) {
  write_bytes(path, bytes);
  try {
    read(path);
    ADD_FAILURE() << "not refused; expected a message with '" << named << "'";
  } catch (const Error& error) {
    EXPECT_TRUE(error.kind() == ErrorKind::file || error.kind() == ErrorKind::mismatch) << error.what();
    EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
  }
}

// Every proper prefix of the file must be refused, but those that end inside its last `spare` bytes.
inline void expect_every_truncation_refused(const Reader& read, const std::filesystem::path& path,
                                            const std::string& bytes, std::size_t spare = 0) {
  write_bytes(path, bytes);
  for (std::size_t size = bytes.size(); size-- > 0;) {
    std::filesystem::resize_file(path, size);
    const bool refused = refuses(read, path, "the first " + std::to_string(size) + " bytes");
    EXPECT_TRUE(refused || size + spare >= bytes.size()) << "the first " << size << " bytes were accepted";
  }
}

// `count` files with one to three bytes changed. What is not refused is given to `accepted` by having been read.
inline std::size_t damage_bytes(const Reader& read, const std::filesystem::path& path, const std::string& bytes,
                                int count) {
  std::mt19937 random(7);
  std::size_t refused = 0;
  for (int k = 0; k < count; ++k) {
    std::string damaged = bytes;
    for (std::size_t n = 1 + random() % 3; n > 0; --n) {
      damaged[random() % damaged.size()] ^= static_cast<char>(1 + random() % 255);
    }
    write_bytes(path, damaged);
    refused += refuses(read, path, "damage " + std::to_string(k)) ? 1 : 0;
  }
  return refused;
}

}  // namespace bodyopt::testing
