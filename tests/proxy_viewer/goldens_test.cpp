// Pictures of the program against those that were looked at once (tests/proxy_viewer/goldens, made by the program): as
// eyes compare them, so that another device or driver passes, and a lost shadow does not.
#include <gtest/gtest.h>

#include "tests/proxy_viewer/small_character.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/paths.h"
#include "tests/support/png_file.h"
#include "tests/support/run_program.h"

namespace bodyopt::testing {
namespace {

constexpr double kBound = 2;  // largest spot, of 255

class GoldensTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { test_device(); }  // the driver, for the programs

  Image picture(const std::string& script) { return picture(small_.basis + " " + small_.clip, script); }

  Image picture(const std::string& files, const std::string& script, const std::string& size = "320 180") {
    const char* device = std::getenv("BODYOPT_TEST_DEVICE");
    const std::string out = (folder_ / "picture.png").string();
    const ProgramResult result = run_bodyopt("view " + files + " --size " + size + " --headless -o " + out +
                                             " --do 'panels off; hud off; legend off; " + script + "'" +
                                             (device ? " --device " + std::string(device) : ""));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return read_png(out);
  }

  Image legend(const std::string& script) { return picture(small_.basis + " " + small_.clip, script, "480 270"); }
  // With room for all of them.
  Image panels(const std::string& script) { return picture(small_.basis + " " + small_.clip, script, "600 338"); }

  void expect_golden(const std::string& name, const std::string& script) { expect_golden(name, picture(script)); }

  void expect_golden(const std::string& name, const Image& now) {
    const Image golden = read_png(kSourceFolder + "/tests/proxy_viewer/goldens/" + name);
    const double difference = spot_difference(golden, now).largest;
    if (difference <= kBound) return;
    const std::filesystem::path kept = std::filesystem::temp_directory_path() / name;
    write_png(now, kept);
    ADD_FAILURE() << "differs by " << difference << ": look at " << kept
                  << ", and copy it over the golden if it is right";
  }

  TemporaryFolder folder_;
  SmallCharacter small_{folder_};
};

const std::string kClay = "frame 7; orbit 15 40; turn upper 60 0 0; frame-selection";
const std::string kCompared =
    "frame 9; compare ddm; heat on; heat-scale 20; skeleton on; fibres on; ghosts 1 0; ghost-step 5; wire on";

const std::string kLegend =
    "shadow off; legend on; frame 9; compare ddm; heat on; heat-scale 20; fibres on; frame-selection";
const std::string kPanels = "shadow off; legend on; panels on; frame 5; compare ddm; layout wipe";
const std::string kCast = "shadow off; frame 8; copies 3; copy-delay 3; right; orbit 30 15; frame-selection; dolly -2";

TEST_F(GoldensTest, Clay) { expect_golden("clay.png", kClay); }
TEST_F(GoldensTest, Compared) { expect_golden("compared.png", kCompared); }
TEST_F(GoldensTest, Legend) { expect_golden("legend.png", legend(kLegend)); }
TEST_F(GoldensTest, Panels) { expect_golden("panels.png", panels(kPanels)); }
TEST_F(GoldensTest, Cast) {
  const JigglingCharacter limb(folder_);
  const std::string both = small_.basis + " " + small_.clip + " " + limb.basis + " " + limb.clip;
  const Image cast = picture(both, kCast);
  expect_golden("cast.png", cast);
  for (const char* loss : {"copies 2", "copy-delay 4", "frame 9"}) {
    EXPECT_GT(spot_difference(cast, picture(both, kCast + "; " + loss)).largest, 2 * kBound) << loss;
  }
}

// Seen from the side, the limb's wrist is at the left, its base at the right.
TEST_F(GoldensTest, CoverageIsHotWhereThePoseLeavesTheTraining) {
  const TrainedCharacter trained(folder_);
  const std::string script =
      "grid off; axes off; shadow off; heat-scale 4; turn joint2 0 115 0; right; frame-selection; ";
  const Image covered = picture(trained.basis, script + "coverage on"), plain = picture(trained.basis, script);
  const auto hottest = [](const Image& image, std::uint32_t from, std::uint32_t to) {
    int most = 0;
    for (std::uint32_t y = 0; y < image.height; ++y) {
      for (std::uint32_t x = from; x < to; ++x) {
        const std::uint8_t* p = image.rgba.data() + 4 * (std::size_t{y} * image.width + x);
        most = std::max(most, int{p[0]} - int{p[2]});
      }
    }
    return most;
  };
  const std::uint32_t width = covered.width;
  EXPECT_GT(hottest(covered, 0, width / 2), hottest(plain, 0, width) + 60);
  EXPECT_LT(hottest(covered, 2 * width / 3, width), hottest(covered, 0, width / 2) - 60);
}

// The truth is 2 mm away everywhere.
TEST_F(GoldensTest, HeatIsScaledByTheErrorsOfTheFrameUntilANumberIsGiven) {
  const std::string files = small_.basis + " " + small_.clip + " " + small_.truth;
  const auto heat = [&](const std::string& script) {
    return picture(files, "frame 9; compare truth; heat on; legend on; " + script).rgba;
  };
  const std::vector<std::uint8_t> automatic = heat("");
  EXPECT_TRUE(automatic == heat("heat-scale 2"));
  EXPECT_FALSE(automatic == heat("heat-scale 5"));
  EXPECT_TRUE(automatic == heat("heat-scale 5; heat-scale auto"));
}

// What must not pass.
TEST_F(GoldensTest, LossesAreSeen) {
  const Image clay = picture(kClay), compared = picture(kCompared);
  for (const char* loss : {"shadow off", "orbit 180 0", "orbit 10 0", "style flat", "style matcap", "grid off",
                           "axes off", "frame 9", "correction 0", "turn upper 10 0 0", "orthographic", "dolly 0.5"}) {
    EXPECT_GT(spot_difference(clay, picture(kClay + "; " + loss)).largest, 2 * kBound) << loss;
  }
  for (const char* loss : {"heat off", "heat-scale 40", "skeleton off", "fibres off", "ghosts 0 0", "wire off",
                           "compare none", "layout wipe"}) {
    EXPECT_GT(spot_difference(compared, picture(kCompared + "; " + loss)).largest, 2 * kBound) << loss;
  }
  const Image explained = legend(kLegend), worked = panels(kPanels);
  for (const char* loss : {"legend off", "heat off", "fibres off", "heat-scale 21"}) {
    EXPECT_GT(spot_difference(explained, legend(kLegend + "; " + loss)).largest, 2 * kBound) << loss;
  }
  for (const char* loss : {"panels off", "side-panel off", "frame 6", "section cast", "wipe 0.6", "legend off"}) {
    EXPECT_GT(spot_difference(worked, panels(kPanels + "; " + loss)).largest, 2 * kBound) << loss;
  }
}

}  // namespace
}  // namespace bodyopt::testing
