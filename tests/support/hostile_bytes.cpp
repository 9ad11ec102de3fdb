#include "tests/support/hostile_bytes.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "runtime/core/error.h"

namespace bodyopt::testing {

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::remove(path);
  std::ofstream(path, std::ios::binary | std::ios::trunc).write(bytes.data(), std::ssize(bytes));
}

bool refuses(const Reader& read, const std::filesystem::path& path, const std::string& what) {
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

void expect_refused(const Reader& read, const std::filesystem::path& path, const std::string& bytes,
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

void expect_every_truncation_refused(const Reader& read, const std::filesystem::path& path, const std::string& bytes,
                                     std::size_t spare) {
  write_bytes(path, bytes);
  for (std::size_t size = bytes.size(); size-- > 0;) {
    std::filesystem::resize_file(path, size);
    const bool refused = refuses(read, path, "the first " + std::to_string(size) + " bytes");
    EXPECT_TRUE(refused || size + spare >= bytes.size()) << "the first " << size << " bytes were accepted";
  }
}

std::size_t damage_bytes(const Reader& read, const std::filesystem::path& path, const std::string& bytes, int count) {
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
