// The page of a show on a farm.
#include <gtest/gtest.h>

#include <fstream>

#include "assets/caches/pc2.h"
#include "cli/results/pages.h"
#include "runtime/host/device_choice.h"
#include "shots/shot_files.h"
#include "tests/support/page_contents.h"
#include "tests/support/small_basis.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::cli {
namespace {

using namespace trainer;
using namespace shots;
using namespace farm;

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

// A frame of a session's step, whose cache has a sample of the lead's rest pose.
class SessionsLook {
 public:
  explicit SessionsLook(const std::string& lead) {
    const std::string session = (folder_ / "shot.json").string();
    std::ofstream(session) << R"({"schema": "bodyopt-session-1", "characters": [)" << lead << "]}";
    step_ = {"shot", "hero", {"eval", "--session", session, "--frames", "1"}, (folder_ / "shot.pc2").string()};
  }

  // The picture of the frame, or why there is none.
  Json drawn() const {
    write_rest();
    ShowSummary summary;
    summary.worth_a_look = {{&step_, 1, 0, 1, 0}};
    const std::string page = show_page({"show", {}, false}, summary);
    return Json::parse(testing::page_json(page)).at("pictures").at("looks").at(0);
  }

  const TemporaryFolder& folder() const { return folder_; }

 private:
  void write_rest() const {
    ShotFiles files;
    take_session(step_.arguments[2], files);
    const MeshTable mesh = open_level(files).levels.front().basis.mesh;
    std::vector<float> rest;
    for (const std::uint32_t v : mesh.output_vertex) {
      rest.insert(rest.end(), mesh.rest.begin() + 3 * v, mesh.rest.begin() + 3 * v + 3);
    }
    Pc2Writer writer(step_.out, mesh.output_count(), 1);
    writer.append(rest);
    writer.close();
  }

  TemporaryFolder folder_;
  FarmStep step_;
};

TEST(ShowPage, DrawsFramesOfASession) {
  if (!has_vulkan_device()) GTEST_SKIP() << "no Vulkan device";
  const SessionsLook trained(R"({"basis": "hero.safetensors"})"), untrained("{}");
  save_basis(testing::small_basis(), trained.folder() / "hero.safetensors");
  for (const SessionsLook* look : {&trained, &untrained}) {
    const Json drawn = look->drawn();
    EXPECT_FALSE(drawn.contains("problem")) << drawn;
  }
}

}  // namespace
}  // namespace bodyopt::cli
