// What eval says of frames that leave the trained range.
#include "cli/results/evaluation_log.h"

#include <gtest/gtest.h>

namespace bodyopt::cli {
namespace {

std::string eval_text(double outside) {
  EvaluationLog log;
  const Json frame = {
      {"frame", 1}, {"outside", outside}, {"outside_feature", "joint hip"}, {"fade", 1.0}, {"fading_joint", ""}};
  log.take_up({{"per_frame", {frame}}, {"starts", Json::array()}, {"tets", 0}});
  return log.text();
}

TEST(EvaluationLog, SaysNothingOfDeviationsThatAreWrittenAsZero) {
  EXPECT_EQ(eval_text(0.04).find("leave the trained range"), std::string::npos);
  EXPECT_NE(eval_text(0.06).find("(most of all joint hip, by 0.1 standard deviations)"), std::string::npos);
}

}  // namespace
}  // namespace bodyopt::cli
