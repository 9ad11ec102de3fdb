#include "runtime/core/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <thread>

#include "runtime/core/error.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/lowered_limit.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

using namespace testing;

void write(const std::filesystem::path& path, const std::string& text) {
  write_file_atomically(path, std::as_bytes(std::span(text)));
}

std::size_t entries(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(AtomicFile, WritesAndReplacesWithUsualPermissions) {
  const TemporaryFolder folder;
  write(folder / "a", "first");
  write(folder / "a", "second");
  EXPECT_EQ(read_bytes(folder / "a"), "second");
  write(folder / "empty", "");
  EXPECT_EQ(std::filesystem::file_size(folder / "empty"), 0u);
  EXPECT_EQ(entries(folder.path()), 2u);
  const mode_t mask = umask(0);
  umask(mask);
  struct stat status {};
  ASSERT_EQ(stat((folder / "a").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0666 & ~mask);
}

TEST(AtomicFile, UncommittedLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  write(folder / "a", "old");
  {
    AtomicFile file(folder / "a");
    file.write(std::as_bytes(std::span("new")));
    EXPECT_EQ(entries(folder.path()), 2u);
  }
  EXPECT_EQ(read_bytes(folder / "a"), "old");
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(AtomicFile, FoldersMissingFoldersAndDevicesAreRefused) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  for (const std::filesystem::path& path :
       {folder.path(), folder / "no/a", folder / "pipe", folder / "pipe/a", std::filesystem::path("/dev/null"),
        folder / "", std::filesystem::path(""), folder / std::string(300, 'n')}) {
    EXPECT_TRUE(refuses([](const auto& p) { write(p, "x"); }, path, path.string())) << path;
  }
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(AtomicFile, FollowsASymbolicLink) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "there");
  write(folder / "there/a", "old");
  std::filesystem::create_symlink(folder / "there/a", folder / "link");
  write(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_bytes(folder / "there/a"), "new");
  EXPECT_EQ(entries(folder / "there"), 1u);
}

TEST(AtomicFile, ALinkIsFollowedToAFileThatIsNotThereYet) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "there");
  std::filesystem::create_symlink("there/next", folder / "link");  // both tell from their own folders
  std::filesystem::create_symlink("a", folder / "there/next");
  write(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "there/next"));
  EXPECT_EQ(read_bytes(folder / "there/a"), "new");
}

TEST(AtomicFile, ALinkThatLeadsBackToItselfIsRefusedAndKept) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("b", folder / "a");
  std::filesystem::create_symlink("a", folder / "b");
  EXPECT_TRUE(refuses([](const auto& p) { write(p, "new"); }, folder / "a", "loop"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "a"));
  EXPECT_EQ(entries(folder.path()), 2u);
}

// A limit on the size of files does what a full disk does, once its signal is ignored.
TEST(AtomicFile, AFullDiskLeavesTheOldFile) {
  const TemporaryFolder folder;
  write(folder / "a", "old");
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const bool refused = [&] {
    const LoweredLimit limit(RLIMIT_FSIZE, 1000);
    return refuses([](const auto& p) { write(p, std::string(100'000, 'x')); }, folder / "a", "full");
  }();
  std::signal(SIGXFSZ, handler);
  EXPECT_TRUE(refused);
  EXPECT_EQ(read_bytes(folder / "a"), "old");
  EXPECT_EQ(entries(folder.path()), 1u);
}

// What a killed process left goes with the next write beside it; what a living one is writing stays, and so does what
// only looks alike.
TEST(AtomicFile, LeftoversOfDeadProcessesAreCleared) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "there");
  const pid_t child = fork();
  if (child == 0) {
    AtomicFile file(folder / "there/a");
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_EQ(entries(folder / "there"), 1u);
  const std::string left = std::filesystem::directory_iterator(folder / "there")->path().filename();

  int ready[2], done[2];
  ASSERT_EQ(pipe(ready), 0);
  ASSERT_EQ(pipe(done), 0);
  const pid_t writing = fork();
  char byte = 0;
  if (writing == 0) {  // clears what the first one left
    AtomicFile file(folder / "there/b");
    const bool cleared = !std::filesystem::exists(folder / "there" / left);
    const bool told = ::write(ready[1], &byte, 1) == 1 && ::read(done[0], &byte, 1) == 1;
    _exit(cleared && told ? 0 : 1);
  }
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ASSERT_EQ(entries(folder / "there"), 1u);
  for (const char* other : {".bodyopt.tmp", ".bodyopt.elsewhere.1.00.tmp", "notes.tmp"}) {
    std::ofstream(folder / "there" / other) << "kept";
  }
  write(folder / "there/c", "c");
  EXPECT_EQ(entries(folder / "there"), 5u);  // c, three that are not ours, and that which is being written
  ASSERT_EQ(::write(done[1], &byte, 1), 1);
  waitpid(writing, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

// That came after the writer had begun.
TEST(AtomicFile, APipeIsNotReplaced) {
  const TemporaryFolder folder;
  AtomicFile file(folder / "a");
  ASSERT_EQ(mkfifo((folder / "a").c_str(), 0600), 0);
  EXPECT_THROW(file.commit(), Error);
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "a"));
}

TEST(AtomicFile, WritersOfOneFileDoNotMix) {
  const TemporaryFolder folder;
  const std::string a(100'000, 'a'), b(100'000, 'b');
  const auto many = [&](const std::string& text) {
    for (int k = 0; k < 20; ++k) write(folder / "same", text);
  };
  std::thread other(many, a);
  many(b);
  other.join();
  const std::string found = read_bytes(folder / "same");
  EXPECT_TRUE(found == a || found == b);
  EXPECT_EQ(entries(folder.path()), 1u);
}

}  // namespace
}  // namespace bodyopt
