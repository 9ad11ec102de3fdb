#include "viewport/scene/truth_times.h"

#include <gtest/gtest.h>

#include "assets/caches/pc2.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace {

using namespace trainer;
using namespace viewport;

class TruthTimesTest : public ::testing::Test {
 protected:
  // A cache of one point, at the place of its sample along x.
  NamedShapes cache(std::uint32_t samples, float start_frame, float sample_rate) const {
    const std::filesystem::path path = folder_ / "truth.pc2";
    Pc2Writer writer(path, 1, samples, start_frame, sample_rate);
    for (std::uint32_t k = 0; k < samples; ++k) writer.append(std::vector<float>{static_cast<float>(k), 0, 0});
    writer.close();
    return NamedShapes(path);
  }
  // Beside a clip of frames 1 to 10.
  std::string described(std::uint32_t samples, float start_frame, float sample_rate) const {
    Clip clip;
    clip.poses.resize(10);
    return describe_truth_times("truth.pc2", cache(samples, start_frame, sample_rate), clip);
  }

  TemporaryFolder folder_;
};

TEST_F(TruthTimesTest, OneSampleAFrameIsNothingToSay) { EXPECT_EQ(described(10, 1, 1), ""); }

// Steps that single precision cannot hold exactly, too.
TEST_F(TruthTimesTest, AFrameIsAsFarAlongTheSamplesAsInTime) {
  struct Case {
    float start, step;
  };
  for (const auto& [start, step] : {Case{1, 1}, {-3, 2}, {0.5f, 0.5f}, {2, 0.1f}, {1, 1.0f / 3}, {7, 2.4f}}) {
    const NamedShapes truth = cache(5, start, step);
    for (int frame = -20; frame <= 30; ++frame) {
      const double place = (frame - static_cast<double>(start)) / static_cast<double>(step);
      const std::optional<SampleTime> time = sample_time(truth, frame);
      ASSERT_EQ(time.has_value(), place > -1e-4 && place < 4 + 1e-4) << frame << " of " << start << ", " << step;
      if (!time) continue;
      EXPECT_EQ(time->on_sample(), std::abs(place - std::round(place)) < 1e-3) << frame;
      EXPECT_NEAR(static_cast<double>(read_sample(truth, *time)[0]), place, 1e-4) << frame;
    }
  }
}

TEST_F(TruthTimesTest, OneSampleHasOneFrame) {
  const NamedShapes truth = cache(1, 4, 1);
  EXPECT_EQ(sample_time(truth, 4), SampleTime{});
  EXPECT_FALSE(sample_time(truth, 3) || sample_time(truth, 5));
}

TEST_F(TruthTimesTest, OtherCountsStartsAndRatesAreSaidWithBothRanges) {
  struct Case {
    std::uint32_t samples;
    float start, rate;
    const char* said;
  };
  for (const Case& c :
       {Case{20, 1, 1, "20 samples, of frames 1-20; the clip has frames 1-10 at 24 a second"},
        Case{10, 0, 1, "of frames 0-9; the clip has frames 1-10"}, Case{5, 1, 2, "of frames 1-9, one every 2 frames"},
        Case{19, 1, 0.5, "of frames 1-10, one every 0.5 frames"}}) {
    const std::string text = described(c.samples, c.start, c.rate);
    EXPECT_NE(text.find(c.said), std::string::npos) << text;
    EXPECT_NE(text.find("--fps"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace bodyopt::testing
