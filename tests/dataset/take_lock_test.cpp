#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dataset/dataset.h"
#include "runtime/core/error.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

bool is_free(const std::filesystem::path& cache) {
  try {
    const TakeLock lock(cache);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::file);
    EXPECT_NE(std::string(error.what()).find("another run"), std::string::npos) << error.what();
    return false;
  }
}

TEST(TakeLock, OneRunATake) {
  const TemporaryFolder folder;
  {
    const TakeLock lock(folder / "take.pc2");
    EXPECT_EQ(lock.cache(), folder / "take.pc2");
    EXPECT_FALSE(is_free(folder / "take.pc2"));
    EXPECT_FALSE(is_free(folder / "take.nodes"));
    EXPECT_FALSE(is_free(folder / "take.pc2"));  // the one refused took nothing away
    EXPECT_TRUE(is_free(folder / "other.pc2"));
  }
  EXPECT_TRUE(is_free(folder / "take.pc2"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(TakeLock, IsGivenUpWhenTheProcessDies) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    const TakeLock lock(folder / "take.pc2");
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "take.lock"));
  EXPECT_TRUE(is_free(folder / "take.pc2"));
}

}  // namespace
}  // namespace bodyopt
