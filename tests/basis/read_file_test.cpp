#include "runtime/basis/read_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <utility>

#include "runtime/core/error.h"
#include "runtime/core/file_problem.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

using namespace testing;

std::string read_small(const std::filesystem::path& path) { return read_file(path, 100, "a small file"); }

void expect_error(const Reader& read, const std::filesystem::path& path, const std::string& told) {
  try {
    read(path);
    ADD_FAILURE() << path << " was read; expected: " << told;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::file);
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(path.string() + ": ")) << text;
    EXPECT_NE(text.find(told), std::string::npos) << text << "\nexpected: " << told;
  }
}

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
  std::filesystem::create_symlink("none", folder / "dangling");
  std::filesystem::create_symlink("loop", folder / "loop");
  write_bytes(folder / "a", "");
  const std::pair<std::filesystem::path, const char*> cases[] = {
      {folder / "none", "no such file"},
      {folder.path(), "is a folder"},
      {folder / "pipe", "is a pipe"},
      {"/dev/zero", "is a device"},
      {folder / "dangling", "is a symbolic link to a file that is not there"},
      {folder / "loop", "does a symbolic link lead back to itself?"},
      {folder / "a/b", "is a file in the place of a folder?"},
      {folder / std::string(300, 'n'), "names have 255 bytes at most"}};
  for (const auto& [path, told] : cases) {
    expect_error(read_small, path, told);
    expect_error(require_file, path, told);
  }
}

TEST(ReadFile, WhatTheFileSystemRefusesIsTold) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("loop", folder / "loop");
  try {
    (void)std::filesystem::exists(folder / "loop");
    FAIL();
  } catch (const std::filesystem::filesystem_error& error) {
    EXPECT_EQ(describe_refusal(error), (folder / "loop").string() +
                                           ": the file system refuses it: Too many levels of symbolic links (does a "
                                           "symbolic link lead back to itself?)");
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
