#include <cmath>
#include <set>

#include "tests/support/gpu_fixture.h"
#include "tests/viewport/small_character.h"
#include "viewport/compare/error_measuring.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace viewport;

TEST(FrameError, IsThatOfTheDistances) {
  const std::vector<float> shown = {0, 0, 0, 1, 2, 3, 4, 5, 6}, compared = {0, 0, 0.003f, 1, 2.004f, 3, 4, 5, 6};
  const FrameError error = frame_error(shown, compared);
  EXPECT_NEAR(error.rms, std::sqrt((9.0 + 16.0) / 3), 1e-3);
  EXPECT_NEAR(error.max, 4, 1e-3);
  EXPECT_EQ(error.worst, (Vec3{1, 2, 3}));
}

class ErrorCurveTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    small_ = std::make_unique<SmallCharacter>(*folder_);
    actor_ = std::make_unique<Actor>(open_test_device(), ActorFiles{small_->basis, small_->clip, small_->truth},
                                     ClipOptions{}, pool_);
  }
  static void TearDownTestSuite() {
    actor_.reset();
    small_.reset();
    folder_.reset();
  }

  static ViewSettings compare_with(CompareWith with) {
    ViewSettings settings;
    settings.compare.with = with;
    return settings;
  }

  static void complete(ErrorCurve& curve, int frame = 1) {
    while (curve.measure_next(*actor_, frame)) {
    }
  }

  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline std::unique_ptr<SmallCharacter> small_;
  static inline LevelPool pool_;
  static inline std::unique_ptr<Actor> actor_;
};

TEST_F(ErrorCurveTest, IsTheDistanceToTheTruth) {
  ErrorCurve curve;
  EXPECT_TRUE(curve.look_at(*actor_, compare_with(CompareWith::truth)));
  EXPECT_EQ(curve.measured_count(), 0u);
  complete(curve);
  EXPECT_TRUE(curve.is_complete());
  ASSERT_EQ(curve.errors().size(), static_cast<std::size_t>(kClipFrames));
  for (const FrameError& error : curve.errors()) {
    EXPECT_NEAR(error.rms, 2, 1e-3);
    EXPECT_NEAR(error.max, 2, 1e-3);
  }
}

TEST_F(ErrorCurveTest, MeasuresTheFrameThatIsShownFirstAndEveryFrameOnce) {
  ErrorCurve curve;
  curve.look_at(*actor_, compare_with(CompareWith::ddm));
  ASSERT_TRUE(curve.measure_next(*actor_, 7));
  EXPECT_TRUE(std::isfinite(curve.errors()[6].rms));
  EXPECT_EQ(curve.worst(), 6u) << "of those that were measured";
  std::size_t count = 1;
  do {
    EXPECT_EQ(curve.measured_count(), count);
    for (std::size_t k = 0; k < curve.errors().size(); ++k) {
      EXPECT_EQ(curve.is_measured(k), std::isfinite(curve.errors()[k].rms));
    }
    ++count;
  } while (curve.measure_next(*actor_, 7));
  EXPECT_EQ(count, kClipFrames + 1u);
  ASSERT_TRUE(curve.worst());
  for (const FrameError& error : curve.errors()) EXPECT_LE(error.rms, curve.errors()[*curve.worst()].rms);
}

TEST_F(ErrorCurveTest, KnowsThePoseAndTheCorrection) {
  ErrorCurve curve;
  ViewSettings settings = compare_with(CompareWith::ddm);
  curve.look_at(*actor_, settings);
  complete(curve);
  const std::vector<FrameError> whole = curve.errors();
  EXPECT_GT(whole[5].rms, 0.01f);
  EXPECT_FALSE(curve.look_at(*actor_, settings)) << "nothing has changed";
  EXPECT_TRUE(curve.is_complete());

  settings.pose.correction = 0;
  EXPECT_TRUE(curve.look_at(*actor_, settings));
  complete(curve);
  for (const FrameError& error : curve.errors()) EXPECT_EQ(error.rms, 0);

  settings.pose.correction = 1;
  settings.pose.joints[actor_->basis().skeleton.joints[1].name] = {0, 0, 25};
  EXPECT_TRUE(curve.look_at(*actor_, settings));
  complete(curve);
  EXPECT_NE(curve.errors()[5].rms, whole[5].rms);
}

TEST_F(ErrorCurveTest, IsEmptyWhereNothingIsCompared) {
  ErrorCurve curve;
  EXPECT_FALSE(curve.look_at(*actor_, compare_with(CompareWith::none)));
  EXPECT_TRUE(curve.errors().empty());
  EXPECT_TRUE(curve.is_complete());
  EXPECT_EQ(curve.worst(), std::nullopt);
  EXPECT_FALSE(curve.measure_next(*actor_, 1));
}

TEST_F(ErrorCurveTest, IsForgottenWhenFilesChange) {
  ErrorCurve curve;
  curve.look_at(*actor_, compare_with(CompareWith::truth));
  complete(curve);
  curve.forget();
  EXPECT_TRUE(curve.errors().empty());
  EXPECT_TRUE(curve.look_at(*actor_, compare_with(CompareWith::truth)));
  EXPECT_FALSE(curve.is_complete());
}

}  // namespace
}  // namespace bodyopt::testing
