// Runs tests. Where none failed and some were skipped it ends with 77, which `ctest` reports.
#include <gtest/gtest.h>

int main(int argc, char** argv) {
  constexpr int kSkipped = 77;
  ::testing::InitGoogleTest(&argc, argv);
  const int code = RUN_ALL_TESTS();
  return code == 0 && ::testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? kSkipped : code;
}
