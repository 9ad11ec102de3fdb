#include "viewport/platform/watched_files.h"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace {

using namespace viewport;

namespace fs = std::filesystem;
using Paths = std::vector<fs::path>;

constexpr double kQuiet = WatchedFiles::kQuiet;

// The time of the file's last change; file systems may not tell changes within a few milliseconds apart.
void set_time(const fs::path& path, int seconds) {
  fs::last_write_time(path, fs::file_time_type(std::chrono::seconds(1'000'000 + seconds)));
}

class WatchedFilesTest : public ::testing::Test {
 protected:
  WatchedFilesTest() {
    write(basis_, "basis", 0);
    write(clip_, "clip", 0);
  }

  static void write(const fs::path& path, const std::string& bytes, int time) {
    write_bytes(path, bytes);
    set_time(path, time);
  }

  TemporaryFolder folder_;
  fs::path basis_ = folder_ / "basis.safetensors", clip_ = folder_ / "clip.glb";
};

TEST_F(WatchedFilesTest, ReportsAChangeOnceItIsQuiet) {
  WatchedFiles watched({basis_, clip_});
  EXPECT_EQ(watched.changed(100), Paths());
  write(basis_, "other", 5);  // as long as before
  EXPECT_EQ(watched.changed(101), Paths());
  EXPECT_EQ(watched.changed(101 + 0.9 * kQuiet), Paths());
  EXPECT_EQ(watched.changed(101 + 1.1 * kQuiet), Paths({basis_}));
  EXPECT_EQ(watched.changed(200), Paths());
}

TEST_F(WatchedFilesTest, SeesAnotherSizeAtTheSameTime) {
  WatchedFiles watched({basis_, clip_});
  write(clip_, "longer clip", 0);
  EXPECT_EQ(watched.changed(1), Paths());
  EXPECT_EQ(watched.changed(2), Paths({clip_}));
}

TEST_F(WatchedFilesTest, SeesAnotherContentOfTheSameSizeAtTheSameTime) {
  WatchedFiles watched({basis_, clip_});
  write(clip_, "klip", 0);
  EXPECT_EQ(watched.changed(1), Paths());
  EXPECT_EQ(watched.changed(2), Paths({clip_}));
  write(clip_, "clip", 0);
  EXPECT_EQ(watched.changed(3), Paths());
  EXPECT_EQ(watched.changed(4), Paths({clip_}));
}

TEST_F(WatchedFilesTest, WaitsForAFileThatGrows) {
  WatchedFiles watched({basis_});
  double now = 10;
  for (int k = 1; k < 20; ++k) {
    write(basis_, std::string(static_cast<std::size_t>(10 * k), 'x'), 1);
    EXPECT_EQ(watched.changed(now), Paths()) << k;
    now += 0.9 * kQuiet;
  }
  EXPECT_EQ(watched.changed(now + 1.1 * kQuiet), Paths({basis_}));
}

TEST_F(WatchedFilesTest, AFileThatIsBackCountsEvenIfItIsTheSame) {
  WatchedFiles watched({basis_, clip_});
  fs::rename(basis_, folder_ / "away");
  EXPECT_EQ(watched.changed(1), Paths());
  EXPECT_EQ(watched.changed(5), Paths());
  fs::rename(folder_ / "away", basis_);
  EXPECT_EQ(watched.changed(6), Paths());
  EXPECT_EQ(watched.changed(7), Paths({basis_}));
  EXPECT_EQ(watched.changed(8), Paths());
}

TEST_F(WatchedFilesTest, AFileMayComeLater) {
  WatchedFiles watched({folder_ / "later", folder_.path()});  // and a folder is no file
  EXPECT_EQ(watched.changed(1), Paths());
  write(folder_ / "later", "now", 3);
  EXPECT_EQ(watched.changed(2), Paths());
  EXPECT_EQ(watched.changed(3), Paths({folder_ / "later"}));
}

TEST_F(WatchedFilesTest, AChangeThatIsTakenBackIsNone) {
  WatchedFiles watched({basis_});
  set_time(basis_, 7);
  EXPECT_EQ(watched.changed(1), Paths());
  set_time(basis_, 0);
  EXPECT_EQ(watched.changed(1.1), Paths());
  EXPECT_EQ(watched.changed(9), Paths());
}

TEST_F(WatchedFilesTest, ReportsInTheOrderGiven) {
  WatchedFiles watched({clip_, basis_});
  write(basis_, "1", 1);
  write(clip_, "2", 2);
  watched.changed(1);
  EXPECT_EQ(watched.changed(2), Paths({clip_, basis_}));
}

}  // namespace
}  // namespace bodyopt::testing
