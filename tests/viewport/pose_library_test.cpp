// Poses of a folder: which files are, what they look like, and how the mouse takes them.
#include "viewport/state/pose_library.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/viewport/played_viewport.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace draw;
using namespace viewport;

namespace fs = std::filesystem;

void write_pose(const fs::path& file, double degrees) {
  ViewSettings settings;
  settings.pose.joints["upper"] = {degrees, 0, 0};
  write_view_settings(settings, file);
}

void look_until_done(PoseLibrary& library, const fs::path& folder) {
  do library.look(folder);
  while (library.has_more());
}

TEST(PoseLibrary, ListsPosesAndNamesWhatIsDamaged) {
  const TemporaryFolder folder;
  write_pose(folder / "b.json", 20);
  write_pose(folder / "c.json", 30);
  fs::resize_file(folder / "c.json", 100);
  std::ofstream(folder / "d.json") << R"({"schema": "bodyopt-view-1", "pose": {"joints": {"upper": [1, 2, 361]}}})";
  write_view_settings({}, folder / "looks.json");
  std::ofstream(folder / "limits.json") << R"({"schema": "bodyopt-limits-1"})";
  std::ofstream(folder / "list.json") << "[1, 2]";
  PoseLibrary library;
  look_until_done(library, folder.path());
  ASSERT_EQ(library.poses().size(), 3u);
  EXPECT_EQ(library.poses()[0].pose.joints.at("upper")[0], 20);
  EXPECT_EQ(library.without_picture(), &library.poses()[0]) << "nothing is drawn of what is damaged";
  for (const std::size_t k : {1, 2}) {
    EXPECT_NE(library.poses()[k].problem.find(library.poses()[k].path.string()), std::string::npos) << k;
  }
  EXPECT_NE(library.poses()[1].problem.find("cannot be read from line "), std::string::npos);
  const std::uint64_t before = library.version();
  EXPECT_FALSE(library.look(folder.path()));
  EXPECT_EQ(library.version(), before);
  // What is written anew, is new, or is gone.
  write_pose(folder / "b.json", 25);
  fs::last_write_time(folder / "b.json", fs::file_time_type::clock::now() + std::chrono::seconds(2));
  write_pose(folder / "a.json", 10);
  fs::remove(folder / "c.json");
  look_until_done(library, folder.path());
  ASSERT_EQ(library.poses().size(), 3u);
  EXPECT_EQ(library.poses()[0].path.filename(), "a.json");
  EXPECT_EQ(library.poses()[1].pose.joints.at("upper")[0], 25);
  look_until_done(library, folder / "absent");
  EXPECT_TRUE(library.poses().empty());
}

class PoseLibraryTest : public PlayedTest {
 protected:
  static double turned(const PlayedViewport& viewport) {
    return set_or(viewport.controls().settings.pose.joints, "upper", {})[0];
  }
  std::unique_ptr<PlayedViewport> open_poses() const {
    auto viewport = open(small(), "section poses; hud off");
    viewport->resize(640, 480);
    viewport->let_pass(1);
    return viewport;
  }
  static constexpr double kFirstX = 460, kFirstY = 200;  // the first pose's picture
};

TEST_F(PoseLibraryTest, ThatIsSavedIsPicturedAndTakenByAClickOrAShareByADrag) {
  const auto viewport = open_poses();
  EXPECT_TRUE(viewport->controls().pose_library.poses().empty());
  viewport->prompt("turn upper 60 0 0");
  viewport->prompt("save-pose up.json");
  viewport->prompt("reset-pose");
  viewport->let_pass(1);
  EXPECT_TRUE(fs::exists("up.thumbnail.png"));
  ASSERT_EQ(viewport->controls().pose_library.poses().size(), 1u);
  EXPECT_EQ(viewport->controls().pose_library.poses()[0].picture.rgba, read_png("up.thumbnail.png").rgba);
  viewport->click(kFirstX, kFirstY);
  EXPECT_EQ(turned(*viewport), 60);
  viewport->key("Ctrl+Z");
  EXPECT_EQ(turned(*viewport), 0);
  viewport->play({viewport->at(kFirstX, kFirstY)});
  viewport->play({ButtonEvent{0, true}});
  for (const auto& [right, degrees] : {std::pair(40, 15.0), {80, 30.0}, {400, 60.0}, {-50, 0.0}, {40, 15.0}}) {
    viewport->play({viewport->at(kFirstX + right, kFirstY)});
    EXPECT_NEAR(turned(*viewport), degrees, 1e-9) << right << ": it is seen at once";
  }
  viewport->play({ButtonEvent{0, false}});
  EXPECT_NEAR(turned(*viewport), 15, 1e-9);
  viewport->key("Ctrl+Z");
  EXPECT_EQ(turned(*viewport), 0) << "one step of undo";
}

TEST_F(PoseLibraryTest, PicturesThatLackAreDrawnWhileNothingHappensAndChangeNothing) {
  write_pose("a.json", 0.5);
  write_pose("b.json", 80);
  std::ofstream("c.json") << "{";
  const auto viewport = open_poses();
  const std::vector<PoseFile>& poses = viewport->controls().pose_library.poses();
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_EQ(poses[0].picture.width, kPosePicture);
  EXPECT_GT(spot_difference(poses[0].picture, poses[1].picture).mean, 2);
  EXPECT_EQ(poses[2].picture.width, 0u);
  EXPECT_FALSE(fs::exists("a.thumbnail.png")) << "nobody asked for it";
  EXPECT_EQ(turned(*viewport), 0);
  EXPECT_EQ(viewport->session().scene.cast().size(), 1u);
  // Of the character, left of the panel.
  const auto shown = [&] {
    const Image& all = viewport->screen.picture;
    Image part{400, 340, {}};
    for (std::size_t y = 30; y < 370; ++y) {
      const auto* const row = all.rgba.data() + 4 * y * all.width;
      part.rgba.insert(part.rgba.end(), row, row + 4 * std::size_t{part.width});
    }
    return part;
  };
  const Image drawn = shown();
  viewport->prompt("section cast");
  EXPECT_LT(spot_difference(shown(), drawn).largest, 1);
}

TEST_F(PoseLibraryTest, OfAnotherCharacterAreRefusedByName) {
  ViewSettings settings;
  settings.pose.joints["Tail"] = {1, 2, 3};
  write_view_settings(settings, "tail.json");
  const auto viewport = open_poses();
  ::testing::internal::CaptureStderr();
  viewport->click(kFirstX, kFirstY);
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("tail.json: poses 'Tail'"), std::string::npos);
  EXPECT_TRUE(viewport->controls().settings.pose.joints.empty());
}

}  // namespace
}  // namespace bodyopt::testing
