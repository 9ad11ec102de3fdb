// What eval says of frames that leave the trained range.
#include "cli/results/evaluation_log.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace bodyopt::cli {
namespace {

std::string eval_text(double outside, double fade = 1, int frames = 1) {
  const Basis basis;  // which knows nothing of its error
  EvaluationLog log(basis);
  Json per_frame = Json::array();
  for (int number = 1; number <= frames; ++number) {
    per_frame.push_back({{"frame", number},
                         {"outside", outside},
                         {"outside_feature", "joint hip"},
                         {"outside_by", "12.3 degrees"},
                         {"fade", fade},
                         {"fading_joint", "hip"}});
  }
  log.take_up({{"per_frame", per_frame}, {"starts", Json::array()}, {"tets", 0}});
  return log.text();
}

TEST(EvaluationLog, SaysNothingOfDeviationsThatAreWrittenAsZero) {
  EXPECT_EQ(eval_text(0.04).find("the trained range"), std::string::npos);
  EXPECT_NE(eval_text(0.06).find("(most of all joint hip, by 12.3 degrees)"), std::string::npos);
}

TEST(EvaluationLog, OneFrameIsOne) {
  const std::string one = eval_text(1, 0.5), two = eval_text(1, 0.5, 2);
  EXPECT_NE(one.find("1 frame leaves the trained range"), std::string::npos) << one;
  EXPECT_NE(one.find("1 frame holds a pose that training did not show"), std::string::npos) << one;
  EXPECT_NE(two.find("2 frames leave the trained range"), std::string::npos) << two;
  EXPECT_NE(two.find("2 frames hold poses that training did not show"), std::string::npos) << two;
}

// All that a frame may tell, and a frame that tells little.
TEST(EvaluationLog, WhatIsKeptGoesOnAsItWas) {
  const Json per_frame = {{{"frame", 3},
                           {"outside", 0.5},
                           {"fade", 0.25},
                           {"fading_joint", "hip"},
                           {"outside_feature", "joint hip"},
                           {"outside_by", "12.3 degrees"},
                           {"jiggle_rms_mm", 1.5},
                           {"jiggle_max_mm", 7.25},
                           {"inverted_tets", 2},
                           {"jiggle_limited_vertices", 9},
                           {"jiggle_limited_near", "belly"},
                           {"expected_rms_mm", 2.5},
                           {"expected_ddm_rms_mm", 6.5}},
                          {{"frame", 4}, {"outside", 0.0}, {"fade", 1.0}, {"fading_joint", ""}}};
  const Basis basis;
  EvaluationLog log(basis);
  log.take_up({{"per_frame", per_frame}, {"starts", Json::array()}, {"tets", 5}});
  EXPECT_EQ(log.kept().at("per_frame"), per_frame);
  EXPECT_NE(log.text().find("7.25 mm at most, in frame 3"), std::string::npos) << log.text();
  EvaluationLog again(basis);
  again.take_up(log.kept());
  EXPECT_EQ(again.kept(), log.kept());
  EXPECT_EQ(again.text(), log.text());
}

}  // namespace
}  // namespace bodyopt::cli
