// Pictures of the program against those that were looked at once (tests/viewport/goldens, made by the program): as
// eyes compare them, so that another device or driver passes, and a lost shadow does not.
#include <gtest/gtest.h>

#include "tests/support/gpu_fixture.h"
#include "tests/support/paths.h"
#include "tests/support/png_file.h"
#include "tests/support/run_verb.h"
#include "tests/viewport/small_character.h"

namespace bodyopt::testing {
namespace {

using namespace draw;

constexpr double kBound = 2;  // largest spot, of 255

class GoldensTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { test_device(); }  // the driver, for the programs

  // After the first script, and after each of the others from there, all drawn by one program. What a state file does
  // not keep, the frame, the next script takes back.
  struct Pictures {
    Image first;
    std::vector<Image> then;
  };

  Pictures pictures(const std::string& files, const std::string& first, const std::vector<std::string>& then,
                    const std::string& size = "320 180") {
    const char* device = std::getenv("BODYOPT_TEST_DEVICE");
    const std::string state = (folder_ / "state.json").string();
    const auto file = [&](std::size_t k) { return (folder_ / ("picture" + std::to_string(k) + ".png")).string(); };
    std::string script = "panels off; hud off; legend off; " + first + "; screenshot " + file(0);
    for (std::size_t k = 0; k < then.size(); ++k) {
      script += "; save-state " + state + "; " + then[k] + "; screenshot " + file(k + 1) + "; load-state " + state;
    }
    const ProgramResult result =
        run_verb("view " + files + " --size " + size + " --headless -o " + (folder_ / "last.png").string() + " --do '" +
                 script + "'" + (device ? " --device " + std::string(device) : ""));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    Pictures drawn{read_png(file(0)), {}};
    for (std::size_t k = 0; k < then.size(); ++k) drawn.then.push_back(read_png(file(k + 1)));
    if (then.empty()) return drawn;
    const SpotDifference left = spot_difference(read_png(folder_ / "last.png"), drawn.first);
    EXPECT_LE(left.largest, kBound) << "each began where the first ended";
    return drawn;
  }

  // The picture is the golden one; without what a loss takes from it it would not pass.
  void expect_golden(const std::string& name, const std::string& files, const std::string& script,
                     const std::vector<std::string>& losses, const std::string& size = "320 180") {
    const Pictures drawn = pictures(files, script, losses, size);
    for (std::size_t k = 0; k < losses.size(); ++k) {
      EXPECT_GT(spot_difference(drawn.first, drawn.then[k]).largest, 2 * kBound) << losses[k];
    }
    const Image golden = read_png(kSourceFolder + "/tests/viewport/goldens/" + name);
    const double difference = spot_difference(golden, drawn.first).largest;
    if (difference <= kBound) return;
    const std::filesystem::path kept = std::filesystem::temp_directory_path() / name;
    write_png(drawn.first, kept);
    ADD_FAILURE() << "differs by " << difference << ": look at " << kept
                  << ", and copy it over the golden if it is right";
  }

  TemporaryFolder folder_;
  SmallCharacter small_{folder_};
  const std::string files_ = small_.basis + " " + small_.clip;
};

TEST_F(GoldensTest, Clay) {
  expect_golden("clay.png", files_, "frame 7; orbit 15 40; turn upper 60 0 0; frame-selection",
                {"shadow off", "orbit 180 0", "orbit 10 0", "style flat", "style matcap", "grid off", "axes off",
                 "frame 9", "frame 7; correction 0", "turn upper 10 0 0", "orthographic", "dolly 0.5"});
}

TEST_F(GoldensTest, Compared) {
  expect_golden(
      "compared.png", files_,
      "frame 9; compare ddm; heat on; heat-scale 20; skeleton on; fibres on; ghosts 1 0; ghost-step 5; wire on",
      {"heat off", "heat-scale 40", "skeleton off", "fibres off", "ghosts 0 0", "wire off", "compare none",
       "layout wipe"});
}

TEST_F(GoldensTest, Legend) {
  expect_golden("legend.png", files_,
                "shadow off; legend on; frame 9; compare ddm; heat on; heat-scale 20; fibres on; frame-selection",
                {"legend off", "heat off", "fibres off", "heat-scale 21"}, "480 270");
}

// With room for all of them. Each loss begins anew: a state file does not bring all of the panels back.
TEST_F(GoldensTest, Panels) {
  const std::string script = "shadow off; legend on; panels on; frame 5; compare ddm; layout wipe", size = "600 338";
  expect_golden("panels.png", files_, script, {}, size);
  const Image worked = pictures(files_, script, {}, size).first;
  for (const char* loss : {"panels off", "side-panel off", "frame 6", "section cast", "wipe 0.6", "legend off"}) {
    const Image lost = pictures(files_, script + "; " + loss, {}, size).first;
    EXPECT_GT(spot_difference(worked, lost).largest, 2 * kBound) << loss;
  }
}

TEST_F(GoldensTest, Cast) {
  const JigglingCharacter limb(folder_);
  expect_golden("cast.png", files_ + " " + limb.basis + " " + limb.clip,
                "shadow off; frame 8; copies 3; copy-delay 3; right; orbit 30 15; frame-selection; dolly -2",
                {"frame 9", "frame 8; copies 2", "copy-delay 4"});
}

// Seen from the side, the limb's wrist is at the left, its base at the right.
TEST_F(GoldensTest, CoverageIsHotWhereThePoseLeavesTheTraining) {
  const TrainedCharacter trained(folder_);
  const std::string script =
      "grid off; axes off; shadow off; heat-scale 4; turn joint2 0 115 0; right; frame-selection";
  const Pictures drawn = pictures(trained.basis, script, {"coverage on"});
  const Image &plain = drawn.first, &covered = drawn.then[0];
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
  const Pictures drawn = pictures(files_ + " " + small_.truth, "frame 9; compare truth; heat on; legend on",
                                  {"heat-scale 2", "heat-scale 5", "heat-scale 5; heat-scale auto"});
  EXPECT_TRUE(drawn.first.rgba == drawn.then[0].rgba);
  EXPECT_FALSE(drawn.first.rgba == drawn.then[1].rgba);
  EXPECT_TRUE(drawn.first.rgba == drawn.then[2].rgba);
}

}  // namespace
}  // namespace bodyopt::testing
