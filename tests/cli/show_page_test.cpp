// The page of a show on a farm.
#include <gtest/gtest.h>

#include "cli/results/pages.h"
#include "tests/support/page_contents.h"

namespace bodyopt::cli {
namespace {

ElementSummary element_of(StepState state, double seconds, std::vector<int> outside) {
  ElementSummary element;
  element.state = state;
  element.seconds = seconds;
  element.outside = std::move(outside);
  return element;
}

// The headlines are counted of these by the page: tests/report/page.test.mjs.
TEST(ShowPage, TellsOfEveryElementItsStateAndItsRange) {
  ShowSummary summary;
  summary.elements = {element_of(StepState::done, 3600, {}), element_of(StepState::failed, 0, {7}),
                      element_of(StepState::stale, 360, {1, 2, 3}), element_of(StepState::missing, 0, {})};
  summary.elements[1].shot = "</script><img src=x onerror=alert(1)>";
  summary.elements[1].failure.emplace();
  summary.elements[1].failure->message = "no memory";
  summary.elements[1].failure->host = "node7";
  const FarmPlan plan{"show", {{}, {}}, false};
  const std::string page = show_page(plan, summary);
  const Json contents = Json::parse(testing::page_json(page)), figures = contents.at("figures");
  EXPECT_EQ(contents.at("kind"), "show");
  EXPECT_EQ(contents.at("pictures"), (Json{{"looks", Json::array()}}));
  EXPECT_EQ(figures, to_json(plan, summary));
  EXPECT_EQ(figures.at("show"), "show");
  EXPECT_EQ(figures.at("tasks"), 2);
  const Json& elements = figures.at("elements");
  ASSERT_EQ(elements.size(), 4u);
  EXPECT_EQ(elements.at(0).at("seconds"), 3600);
  EXPECT_EQ(elements.at(1).at("message"), "no memory");
  EXPECT_EQ(elements.at(1).at("host"), "node7");
  EXPECT_EQ(elements.at(2).at("state"), "stale");
  EXPECT_EQ(elements.at(2).at("outside_frames"), "1-3");
  EXPECT_EQ(elements.at(2).at("outside_count"), 3);
  EXPECT_EQ(page.find("<img"), std::string::npos);
}

}  // namespace
}  // namespace bodyopt::cli
