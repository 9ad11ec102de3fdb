#include "trainer/dynamics/jiggle_settings.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "runtime/core/json.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::trainer {
namespace {

using namespace testing;

const Reader read = [](const auto& path) { read_jiggle(path); };

std::string file_of(const std::string& entries) {
  return R"({"schema": "bodyopt-jiggle-1")" + (entries.empty() ? "" : ", " + entries) + "}";
}

TEST(JiggleFile, WhatItLeavesOutIsTheDefault) {
  const TemporaryFolder folder;
  write_bytes(folder / "jiggle.json", file_of(""));
  const JiggleSettings settings = read_jiggle(folder / "jiggle.json"), defaults;
  EXPECT_EQ(settings.softness, defaults.softness);
  EXPECT_EQ(settings.damping, defaults.damping);
  EXPECT_EQ(settings.amount, defaults.amount);
  EXPECT_EQ(settings.poisson, defaults.poisson);
  EXPECT_EQ(settings.density, defaults.density);
  EXPECT_EQ(settings.tension, defaults.tension);
  EXPECT_EQ(settings.lowest_frequency, defaults.lowest_frequency);
  EXPECT_EQ(settings.limit, defaults.limit);
  EXPECT_TRUE(settings.regions.empty());
}

TEST(JiggleFile, WhatIsWrittenReadsAsItWas) {
  const TemporaryFolder folder;
  const std::string written = file_of(R"("softness": 2.0, "damping": 0.3, "amount": 0.5, "poisson": 0.4,
      "density": 950.0, "tension": 6.0, "lowest_frequency": 3.5, "limit": 0.25, "flesh": 0.04, "comment": "of a bear",
      "regions": [{"joint": "Head", "amount": 0.0, "comment": "a skull"}, {"region": "belly", "softness": 4.0}, {"joint": "Hand", "flesh_factor": 1.5}])");
  write_bytes(folder / "jiggle.json", written);
  EXPECT_EQ(jiggle_json(read_jiggle(folder / "jiggle.json")), Json::parse(written));
}

TEST(JiggleFile, EveryKeyIsRead) {
  const TemporaryFolder folder;
  write_bytes(folder / "jiggle.json", file_of(R"("softness": 2, "damping": 0.3, "amount": 0.5, "poisson": 0.4,
      "density": 950, "tension": 6, "regions": [{"joint": "Head", "amount": 0}, {"muscle": "biceps*", "softness": 3},
      {"region": "belly", "damping": 0.05, "softness": 4, "amount": 1.5}])"));
  const JiggleSettings settings = read_jiggle(folder / "jiggle.json");
  EXPECT_EQ(settings.softness, 2);
  EXPECT_EQ(settings.damping, 0.3);
  EXPECT_EQ(settings.amount, 0.5);
  EXPECT_EQ(settings.poisson, 0.4);
  EXPECT_EQ(settings.density, 950);
  EXPECT_EQ(settings.tension, 6);
  ASSERT_EQ(settings.regions.size(), 3u);
  using By = JiggleRegion::By;
  EXPECT_EQ(settings.regions[0].by, By::joint);
  EXPECT_EQ(settings.regions[0].amount, 0.0);
  EXPECT_FALSE(settings.regions[0].softness);
  EXPECT_EQ(settings.regions[1].by, By::muscle);
  EXPECT_EQ(settings.regions[1].name, "biceps*");
  EXPECT_EQ(settings.regions[1].softness, 3.0);
  EXPECT_EQ(settings.regions[2].by, By::painted);
  EXPECT_EQ(settings.regions[2].damping, 0.05);
  EXPECT_EQ(settings.regions[2].amount, 1.5);
}

TEST(JiggleFile, MistakesAreNamed) {
  const TemporaryFolder folder;
  for (const auto& [entries, named] : {
           std::pair(R"("softnes": 2)", "unknown key 'softnes'"),
           std::pair(R"("softness": 0)", "'softness' is 0"),
           std::pair(R"("softness": -1)", "'softness' is -1"),
           std::pair(R"("damping": -0.1)", "'damping' is -0.1"),
           std::pair(R"("amount": -1)", "'amount' is -1"),
           std::pair(R"("poisson": 0.5)", "'poisson' is 0.5"),
           std::pair(R"("poisson": -1)", "'poisson' is -1"),
           std::pair(R"("density": 0)", "'density' is 0"),
           std::pair(R"("tension": "high")", "'tension' is \"high\""),
           std::pair(R"("regions": {})", "'regions' is not a list"),
           std::pair(R"("regions": [{"softness": 2}])", "regions[0] has 0 of 'joint', 'muscle' and 'region'"),
           std::pair(R"("regions": [{"joint": "a", "muscle": "b", "softness": 2}])", "regions[0] has 2 of"),
           std::pair(R"("regions": [{"joint": "", "softness": 2}])", "'joint' is empty"),
           std::pair(R"("regions": [{"joint": "a"}])", "says nothing of softness"),
           std::pair(R"("regions": [{"joint": "a", "flesh_factor": 0}])", "'flesh_factor' is 0"),
           std::pair(R"("regions": [{"joint": "a", "flesh": 0.1, "flesh_factor": 2}])", "both 'flesh' (metres) and"),
           std::pair(R"("regions": [{"joint": "a", "poisson": 0.3}])", "unknown key 'poisson'"),
           std::pair(R"("regions": [{"joint": "a", "softness": 1e9}])", "'softness' is 1000000000"),
       }) {
    expect_refused(read, folder / "jiggle.json", file_of(entries), named);
  }
  expect_refused(read, folder / "jiggle.json", R"({"schema": "bodyopt-jiggle-2"})", "bodyopt-jiggle-2");
}

}  // namespace
}  // namespace bodyopt::trainer
