// The lead cut open, its tissues found in the background.
#include "viewport/sectioning.h"

#include <gtest/gtest.h>

#include "runtime/core/error.h"
#include "tests/support/error_kind.h"
#include "tests/support/gpu_fixture.h"
#include "tests/viewport/small_character.h"
#include "viewport/commands/commands.h"
#include "viewport/picking.h"
#include "viewport/session.h"

namespace bodyopt::testing {
namespace {

using namespace draw;
using namespace viewport;

class SectioningTest : public ::testing::Test {
 protected:
  // The built-in arm, or a basis.
  void open(const std::string& file = "") {
    if (!file.empty()) options_.files = {file};
    session_ = std::make_unique<Session>(open_test_device(), options_);
    session_->open_first();
    session_->play_clip();
    session_->controls.headless = true;  // it waits
    session_->framing.follow();
  }
  void look() { session_->sectioning.look(true); }
  std::vector<SkinDraw> skins() const { return session_->scene.look(session_->controls, kArea).front().skins; }
  SectionRow row(std::array<double, 2> mouse) const {
    Snapshot snapshot;
    session_->sectioning.describe(kArea, mouse, snapshot);
    return snapshot.section.value_or(SectionRow{});
  }
  // What is named where the picture shows anything of the section.
  std::set<std::string> names() const {
    std::set<std::string> names;
    for (double x = 2; x < kArea.width; x += 4) {
      for (double y = 2; y < kArea.height; y += 4) names.insert(row({x, y}).under_mouse);
    }
    names.erase("");
    return names;
  }

  static constexpr Rectangle kArea{0, 0, 200, 200};
  TemporaryFolder folder_;
  ViewerOptions options_;
  std::unique_ptr<Session> session_;
};

TEST_F(SectioningTest, TheArmIsCutOpenPosedAndNamed) {
  open();
  const std::size_t whole = skins().size();
  run_command(session_->controls, "anatomy on");
  run_command(session_->controls, "anatomy-axis z");
  run_command(session_->controls, "front");
  session_->framing.frame_selection(kArea.width, kArea.height);
  look();
  const std::vector<SkinDraw> cut = skins();
  ASSERT_EQ(cut.size(), whole + 1);  // the skin that is left, and the face
  EXPECT_TRUE(cut[0].colours && cut[1].colours);
  const std::set<std::string> at_first = names();
  EXPECT_TRUE(at_first.contains("fat"));
  EXPECT_TRUE(std::ranges::any_of(at_first, [](const std::string& name) { return name.starts_with("bone of "); }));
  EXPECT_GE(row({0, 0}).tissues.size(), 5u);
  // The same is not cut again; another pose, plane or side is.
  const auto drawn = [this] {
    look();
    return skins()[1].positions;
  };
  const vulkan::Buffer* const before = drawn();
  const std::uint32_t triangles = skins()[1].triangle_count;
  EXPECT_EQ(drawn(), before);
  session_->controls.playback.scrub(40);
  drawn();
  EXPECT_NE(skins()[1].triangle_count, triangles);
  run_command(session_->controls, "anatomy off");
  look();
  EXPECT_EQ(skins().size(), whole);
}

// Its weights are in the file of its character.
TEST_F(SectioningTest, ABasisAloneIsNotCutOpen) {
  const SmallCharacter small(folder_);
  open(small.basis);
  session_->controls.settings.look.anatomy = true;
  const auto kind = kind_of([&] { look(); });
  EXPECT_EQ(kind, ErrorKind::usage);
  EXPECT_FALSE(session_->controls.settings.look.anatomy);
  EXPECT_NO_THROW(look());
}

}  // namespace
}  // namespace bodyopt::testing
