#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "runtime/core/atomic_file.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

using namespace testing;

int number_in(const std::filesystem::path& path) {
  int number = 0;
  std::ifstream(path) >> number;
  return number;
}

// Two threads open the lock's file apart from each other, as two processes do.
TEST(FileLock, NoChangeIsLost) {
  const TemporaryFolder folder;
  constexpr int kChanges = 200;
  const auto change = [&] {
    for (int k = 0; k < kChanges; ++k) {
      const FileLock lock = lock_to_change(folder / "number");
      const int number = number_in(folder / "number");
      std::ofstream(folder / "number") << number + 1;
    }
  };
  std::thread other(change);
  change();
  other.join();
  EXPECT_EQ(number_in(folder / "number"), 2 * kChanges);
}

TEST(FileLock, ALinkToTheFileHasTheLockOfTheFile) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a") << "1";
  std::filesystem::create_directory(folder / "else");
  std::filesystem::create_symlink(folder / "a", folder / "else/link");
  const FileLock lock = lock_to_change(folder / "else/link");
  EXPECT_FALSE(FileLock(folder / ".a.lock").is_held());
}

TEST(FileLock, IsGivenUpWhenTheProcessIsKilled) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    const FileLock lock = lock_to_change(folder / "a");
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(lock_to_change(folder / "a").is_held());
}

// Nothing that stands in the lock's place is opened or locked: not what a link names, no pipe, no folder.
TEST(FileLock, WhatIsNoFileOfItsOwnIsRefused) {
  const TemporaryFolder folder;
  std::ofstream(folder / "precious") << "as it was";
  std::filesystem::create_symlink(folder / "precious", folder / "link");
  std::filesystem::create_symlink(folder / "nowhere", folder / "dangling");
  std::filesystem::create_directory(folder / "folder");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  for (const char* name : {"link", "dangling", "folder", "pipe", "no/such"}) {
    EXPECT_TRUE(refuses([](const auto& path) { const RunLock lock(path, "doing this"); }, folder / name, name));
  }
  EXPECT_EQ(read_bytes(folder / "precious"), "as it was");
  EXPECT_FALSE(std::filesystem::exists(folder / "nowhere"));
}

}  // namespace
}  // namespace bodyopt
