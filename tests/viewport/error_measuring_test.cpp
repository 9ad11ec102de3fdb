#include "viewport/compare/error_measuring.h"

#include "draw/camera.h"
#include "tests/support/error_kind.h"
#include "tests/support/gpu_fixture.h"
#include "tests/viewport/small_character.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace draw;
using namespace viewport;

class ErrorMeasuringTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    small_ = std::make_unique<SmallCharacter>(*folder_);
    scene_ = std::make_unique<Scene>(open_test_device());
    scene_->add({small_->basis, small_->clip, small_->truth}, {});
  }
  static void TearDownTestSuite() {
    scene_.reset();
    small_.reset();
    folder_.reset();
  }
  void SetUp() override {
    controls_.playback = Playback({1, kClipFrames}, 24);
    controls_.settings.compare.with = CompareWith::ddm;
  }

  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline std::unique_ptr<SmallCharacter> small_;
  static inline std::unique_ptr<Scene> scene_;
  Controls controls_;
};

TEST_F(ErrorMeasuringTest, GoesToTheWorstOfThoseMeasuredSoFarAndSaysOfHowMany) {
  ErrorMeasuring errors(*scene_, controls_, false);
  controls_.playback.scrub(3);
  controls_.playback.play();
  errors.go_to_worst_frame();
  EXPECT_FALSE(controls_.playback.playing());
  EXPECT_EQ(controls_.playback.frame(), 3) << "the only one";
  ASSERT_EQ(controls_.messages.size(), 1u);
  EXPECT_EQ(controls_.messages[0].text, "worst of 1 of 12 frames measured");

  controls_.playback.scrub(9);
  errors.measure_shown_frame();
  errors.measure_shown_frame();  // it is already
  errors.go_to_worst_frame();
  ASSERT_EQ(controls_.messages.size(), 2u);
  EXPECT_EQ(controls_.messages[1].text, "worst of 2 of 12 frames measured");
  const FrameError &third = errors.curve().errors()[2], &ninth = errors.curve().errors()[8];
  ASSERT_NE(third.rms, ninth.rms);
  EXPECT_EQ(controls_.playback.frame(), third.rms > ninth.rms ? 3 : 9);

  errors.measure_all();
  errors.go_to_worst_frame();
  EXPECT_EQ(controls_.messages.size(), 2u) << "it is the worst of all";
  EXPECT_EQ(controls_.playback.frame(), static_cast<int>(*errors.curve().worst()) + 1);
}

// A truth of every fourth frame, from 3 on; then one that lies between all frames.
TEST_F(ErrorMeasuringTest, TheWorstIsAmongFramesThatTheTruthHas) {
  const std::uint32_t count = small_->made.mesh.output_count();
  const auto worst_frame = [&](float start, float step) {
    const std::string file = (*folder_ / "sparse.pc2").string();
    Pc2Writer writer(file, count, 3, start, step);
    for (int k = 0; k < 3; ++k) writer.append(std::vector<float>(std::size_t{3} * count, 0.0f));
    writer.close();
    Scene scene(open_test_device());
    scene.add({small_->basis, small_->clip, file}, {});
    controls_.settings.compare.with = CompareWith::truth;
    controls_.playback.scrub(4);
    ErrorMeasuring errors(scene, controls_, false);
    errors.go_to_worst_frame();
    const int first = controls_.playback.frame();
    errors.measure_all();
    errors.go_to_worst_frame();
    for (int frame = 1; frame <= kClipFrames; ++frame) {
      const float rms = errors.curve().errors()[static_cast<std::size_t>(frame - 1)].rms;
      EXPECT_EQ(std::isfinite(rms), frame == 3 || frame == 7 || frame == 11) << frame;
    }
    return std::pair(first, controls_.playback.frame());
  };
  const auto [first, last] = worst_frame(3, 4);
  EXPECT_EQ((first - 3) % 4, 0) << first;
  EXPECT_EQ((last - 3) % 4, 0) << last;
  EXPECT_EQ(kind_of([&] { worst_frame(1.5f, 1); }), ErrorKind::usage);
}

TEST_F(ErrorMeasuringTest, MeasuresAtRestAndWhilePlayingWhereItMay) {
  for (const bool while_playing : {false, true}) {
    ErrorMeasuring errors(*scene_, controls_, while_playing);
    controls_.playback.play();
    errors.measure_some();
    EXPECT_EQ(errors.has_work(), while_playing);
    EXPECT_EQ(errors.curve().measured_count() > 0, while_playing);
    controls_.playback.pause();
    EXPECT_TRUE(errors.has_work());
    while (errors.has_work()) {
      const std::size_t before = errors.curve().measured_count();
      errors.measure_some();
      ASSERT_GT(errors.curve().measured_count(), before);
    }
    EXPECT_TRUE(errors.curve().is_complete());
  }
}

TEST_F(ErrorMeasuringTest, GoesToTheWorstVertexOfTheFrame) {
  ErrorMeasuring errors(*scene_, controls_, false);
  controls_.playback.scrub(7);
  errors.go_to_worst_vertex();
  EXPECT_EQ(errors.curve().measured_count(), 1u);
  ASSERT_TRUE(controls_.marker);
  EXPECT_EQ(controls_.marker->frame, 7);
  EXPECT_EQ(controls_.marker->at, errors.curve().errors()[6].worst);
  EXPECT_EQ(controls_.camera.view().target, controls_.marker->at);
  const FrameError& error = errors.curve().errors()[6];
  EXPECT_EQ(errors.shown_error(), &error);
  EXPECT_LE(error.p99, error.max);
  EXPECT_GT(error.p99, error.rms);
  const std::vector<float> skin = scene_->lead().measure(SkinMethod::full, scene_->lead_pose(controls_), 7);
  const Vec3 normal = normal_at(small_->made.mesh, skin, error.worst_vertex);
  const Camera camera = controls_.camera.camera();
  const Vec3 back = to_double(camera.eye) - to_double(camera.target);
  EXPECT_GT(dot(normal, back) / length(back), 0.99);
  controls_.settings.compare.with = CompareWith::truth;
  errors.look();
  EXPECT_FALSE(controls_.marker) << "of another comparison";
}

TEST_F(ErrorMeasuringTest, RefusesWhereThereIsNothingToMeasure) {
  controls_.live = true;
  ErrorMeasuring live(*scene_, controls_, true);
  EXPECT_EQ(kind_of([&] { live.go_to_worst_frame(); }), ErrorKind::usage);
  live.measure_all();
  EXPECT_EQ(live.curve().measured_count(), 0u);
  controls_.live = false;
  ErrorMeasuring errors(*scene_, controls_, false);
  controls_.settings.compare.with = CompareWith::none;
  EXPECT_EQ(kind_of([&] { errors.go_to_worst_frame(); }), ErrorKind::usage);
  EXPECT_EQ(kind_of([&] { errors.go_to_worst_vertex(); }), ErrorKind::usage);
  EXPECT_FALSE(errors.has_work());
}

}  // namespace
}  // namespace bodyopt::testing
