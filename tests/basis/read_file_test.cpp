#include "runtime/basis/read_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "runtime/core/error.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

using namespace testing;

std::string read_small(const std::filesystem::path& path) { return read_file(path, 100, "a small file"); }

TEST(ReadFile, GivesTheBytes) {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\n\xff", 5);
  write_bytes(folder / "a", bytes);
  EXPECT_EQ(read_small(folder / "a"), bytes);
  write_bytes(folder / "empty", "");
  EXPECT_EQ(read_small(folder / "empty"), "");
  write_bytes(folder / "most", std::string(100, 'x'));
  EXPECT_EQ(read_small(folder / "most").size(), 100u);
  EXPECT_FALSE(read_file("/proc/self/status", 1 << 20, "a status").empty());  // which has no size
}

TEST(ReadFile, WhatIsNoFileOrTooLargeIsRefused) {
  const TemporaryFolder folder;
  expect_refused(read_small, folder / "a", std::string(101, 'x'), "not a small file?");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  for (const std::filesystem::path& path :
       {folder / "none", folder.path(), folder / "pipe", std::filesystem::path("/dev/zero")}) {
    EXPECT_TRUE(refuses([](const auto& from) { read_small(from); }, path, path.string()));
  }
}

// A process' memory is a file whose first bytes cannot be read: as on a disk that fails.
TEST(ReadFile, AFailureOfReadingIsAnErrorOfTheFile) {
  try {
    read_small("/proc/self/mem");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::file);
    EXPECT_NE(std::string(error.what()).find("cannot be read to its end: Input/output error"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace bodyopt
