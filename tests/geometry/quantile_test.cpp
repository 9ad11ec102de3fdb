#include "base/quantile.h"

#include <gtest/gtest.h>

#include <vector>

namespace bodyopt {
namespace {

const std::vector<int> kValues = {40, 10, 30, 20};

TEST(Quantile, MedianOfAnEvenNumberIsTheUpperOne) {
  EXPECT_EQ(median(kValues), 30);
  EXPECT_EQ(median(std::vector<int>{7}), 7);
}

TEST(Quantile, IsTheValueThatTheShareOfOthersDoesNotExceed) {
  EXPECT_EQ(quantile(kValues, 0), 10);
  EXPECT_EQ(quantile(kValues, 0.5), 20);
  EXPECT_EQ(quantile(kValues, 0.99), 30);
  EXPECT_EQ(quantile(kValues, 1), 40);
}

}  // namespace
}  // namespace bodyopt
