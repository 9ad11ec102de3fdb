#include "viewport/picture_files.h"

#include <gtest/gtest.h>

#include "runtime/core/error.h"
#include "runtime/threads/tbb_executor.h"
#include "tests/support/png_file.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace draw;
using namespace viewport;

class PictureFilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    controls_.playback = Playback({1, 12}, 24);
    controls_.playback.set_range(4, 6);
    controls_.playback.scrub(9);
    controls_.camera.orbit(0.4, 0.2);
    before_ = controls_.camera.view();
  }

  // A pixel that knows its frame, and the camera that it was seen by.
  Image draw() {
    views_.push_back(controls_.camera.view());
    return {1, 1, {static_cast<std::uint8_t>(controls_.playback.frame()), 0, 0, 255}};
  }
  int frame_in(const std::string& file) const { return read_png(folder_ / file).rgba.at(0); }
  std::string in_folder(const std::string& file) const { return (folder_ / file).string(); }
  std::size_t files() const {
    const std::filesystem::directory_iterator all(folder_.path());
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
  }

  TemporaryFolder folder_;
  Controls controls_;
  OrbitView before_;
  std::vector<OrbitView> views_;
  const DrawPicture draw_ = [this] { return draw(); };
};

TEST_F(PictureFilesTest, AScreenshotIsThePictureAsItIs) {
  write_screenshot(in_folder("a.png"), draw_, controls_);
  EXPECT_EQ(frame_in("a.png"), 9);
  ASSERT_EQ(controls_.messages.size(), 1u);
  EXPECT_EQ(controls_.messages[0].text, "wrote " + in_folder("a.png"));
}

TEST_F(PictureFilesTest, ASequenceHasEveryFrameOfTheRange) {
  controls_.playback.play();
  make_all(*frame_series(in_folder("s.####.png"), 24, controls_), draw_);
  EXPECT_EQ(files(), 3u);
  for (const int frame : {4, 5, 6}) EXPECT_EQ(frame_in("s.000" + std::to_string(frame) + ".png"), frame);
  EXPECT_EQ(controls_.playback.frame(), 9) << "and comes back";
  EXPECT_FALSE(controls_.playback.playing());
  make_all(*frame_series(in_folder("one.png"), 24, controls_), draw_);
  EXPECT_EQ(frame_in("one.png"), 9);
}

TEST_F(PictureFilesTest, AFlipBookIsOneFile) {
  make_all(*frame_series(in_folder("s.webp"), 24, controls_), draw_);
  EXPECT_EQ(files(), 1u);
  EXPECT_EQ(views_.size(), 3u);
  EXPECT_GT(std::filesystem::file_size(folder_ / "s.webp"), 20u);
}

TEST_F(PictureFilesTest, NamesOfOtherKindsAreRefusedBeforeAnythingIsDrawn) {
  const auto expect_refused = [this](const char* file, const char* possible, const std::function<void()>& write) {
    controls_.playback.play();
    try {
      write();
      ADD_FAILURE() << file;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      for (const char* named : {file, possible}) {
        EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
      }
    }
    EXPECT_TRUE(controls_.playback.playing());
  };
  for (const char* file : {"z.jpg", "z.webp", "z", "png", "z.png.bak"}) {
    expect_refused(file, ".png", [&] { write_screenshot(in_folder(file), draw_, controls_); });
  }
  for (const char* file : {"z.jpg", "z.####.exr", "z"}) {
    expect_refused(file, ".webp", [&] { frame_series(in_folder(file), 24, controls_); });
  }
  for (const char* file : {"z.##.jpg", "z.##.webp"}) {
    expect_refused(file, ".png", [&] { turntable_series(in_folder(file), controls_); });
  }
  EXPECT_EQ(files(), 0u);
  EXPECT_TRUE(views_.empty());
  write_screenshot(in_folder("LOUD.PNG"), draw_, controls_);
  EXPECT_EQ(frame_in("LOUD.PNG"), 9);
}

TEST_F(PictureFilesTest, ATurntableGoesOnceAroundAndComesBack) {
  make_all(*turntable_series(in_folder("t.##.png"), controls_), draw_);
  EXPECT_EQ(files(), 72u);
  EXPECT_EQ(controls_.camera.view(), before_);
  ASSERT_EQ(views_.size(), 72u);
  EXPECT_EQ(views_[0], before_);
  for (const OrbitView& view : views_) EXPECT_EQ(view.elevation, before_.elevation);
  // Half a turn, to either side.
  EXPECT_NEAR(std::abs(std::remainder(views_[36].azimuth - before_.azimuth, 6.283185307179586)), 3.14159265, 1e-6);
}

TEST_F(PictureFilesTest, OneThatCannotBeWrittenEndsTheRunByItsName) {
  constexpr std::size_t kBad = 5;
  std::filesystem::create_directories(folder_ / "t.05.png" / "in the way");
  try {
    make_all(*turntable_series(in_folder("t.##.png"), controls_), draw_);
    ADD_FAILURE() << "a folder was replaced";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::file);
    EXPECT_NE(std::string(error.what()).find("t.05.png"), std::string::npos) << error.what();
  }
  EXPECT_EQ(controls_.camera.view(), before_);
  EXPECT_LE(views_.size(), kBad + thread_count()) << "no more than wait to be written";
  EXPECT_EQ(files(), views_.size());
  for (std::size_t k = 1; k <= views_.size(); ++k) {
    if (k == kBad) continue;
    EXPECT_EQ(frame_in(FrameSequenceName("t.##.png", 72)(static_cast<int>(k)).string()), 9);
  }
}

TEST_F(PictureFilesTest, OneThatCannotBeWrittenIsToldWhenTheyAreStopped) {
  std::filesystem::create_directories(folder_ / "s.0004.png" / "in the way");
  const auto series = frame_series(in_folder("s.####.png"), 24, controls_);
  series->make_next(draw_);
  EXPECT_THROW(series->finish(), Error);
}

TEST_F(PictureFilesTest, StoppedAtAnyPictureItPutsThePlayheadAndTheCameraBack) {
  {
    const auto series = frame_series(in_folder("s.####.png"), 24, controls_);
    EXPECT_TRUE(series->make_next(draw_));
    EXPECT_TRUE(series->make_next(draw_));
    EXPECT_EQ(series->made(), 2u);
    EXPECT_EQ(series->count(), 3u);
    EXPECT_EQ(controls_.playback.frame(), 5);
  }
  EXPECT_EQ(controls_.playback.frame(), 9);
  EXPECT_EQ(files(), 2u) << "what was written is kept";
  const auto failing = [this]() -> Image {
    if (views_.size() == 5) throw Error(ErrorKind::usage, "no picture");
    return draw();
  };
  EXPECT_THROW(make_all(*turntable_series(in_folder("t.##.png"), controls_), failing), Error);
  EXPECT_EQ(controls_.camera.view(), before_);
  EXPECT_THROW(make_all(*frame_series(in_folder("s.webp"), 24, controls_), failing), Error);
  EXPECT_EQ(controls_.playback.frame(), 9);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s.webp")) << "it is not whole";
}

}  // namespace
}  // namespace bodyopt::testing
