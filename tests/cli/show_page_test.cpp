// The page of a show on a farm.
#include "cli/results/show_page.h"

#include <gtest/gtest.h>

namespace bodyopt::cli {
namespace {

ElementSummary element_of(StepState state, double seconds, std::vector<int> outside) {
  ElementSummary element;
  element.state = state;
  element.seconds = seconds;
  element.outside = std::move(outside);
  return element;
}

TEST(ShowPage, HeadlinesCountTheElementsByTheirState) {
  ShowSummary summary;
  summary.elements = {element_of(StepState::done, 3600, {}),     element_of(StepState::done, 1800, {4, 5}),
                      element_of(StepState::done, 0, {}),        element_of(StepState::failed, 0, {}),
                      element_of(StepState::failed, 0, {7}),     element_of(StepState::stale, 360, {1}),
                      element_of(StepState::stopped, 0, {}),     element_of(StepState::missing, 0, {}),
                      element_of(StepState::missing, 0, {1, 2}), element_of(StepState::missing, 0, {})};
  const std::string page = show_page({"show", {}, false}, summary);
  const auto expect = [&](const std::string& value, const std::string& unit, const std::string& text) {
    const std::string headline = "<b>" + value + "</b><i>" + unit + "</i><span>" + text;
    EXPECT_NE(page.find(headline), std::string::npos) << headline;
  };
  expect("3", "of 10", "elements are done");
  expect("2", "", "failed");
  expect("5", "", "are stale, stopped or not begun");
  expect("4", "", "leave the trained range");
  expect("1.60", "h", "that tasks took for what is done");
}

}  // namespace
}  // namespace bodyopt::cli
