#include "proxy_viewer/truth_times.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace {

class TruthTimesTest : public ::testing::Test {
 protected:
  // Of a cache of one point, beside a clip of frames 1 to 10.
  std::string described(std::uint32_t samples, float start_frame, float sample_rate) const {
    const std::filesystem::path path = folder_ / "truth.pc2";
    Pc2Writer writer(path, 1, samples, start_frame, sample_rate);
    for (std::uint32_t k = 0; k < samples; ++k) writer.append(std::vector<float>{0, 0, 0});
    writer.close();
    Clip clip;
    clip.poses.resize(10);
    return describe_truth_times("truth.pc2", Pc2Reader(path), clip);
  }

  TemporaryFolder folder_;
};

TEST_F(TruthTimesTest, OneSampleAFrameIsNothingToSay) { EXPECT_EQ(described(10, 1, 1), ""); }

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
