// bodyopt curate, as it is run.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "dataset/stack_history.h"
#include "tests/curate/sweep_history.h"
#include "tests/support/png_file.h"
#include "tests/support/run_program.h"
#include "trainer/curate/edit_stack.h"

namespace bodyopt {
namespace {

class CurateProgram : public ::testing::Test {
 protected:
  ProgramResult curate(const std::string& verb, const std::string& options) const {
    return run_bodyopt("curate " + verb + " " + limb_.folder().string() + " " + options);
  }
  std::string at(const std::string& name) const { return (limb_.folder() / name).string(); }

  CuratedLimb limb_;
};

// Where the middle of a third of the picture lies, its red less its blue: clay is less red than heat.
int warmth(const Image& image, std::uint32_t third) {
  int most = -255;
  const std::uint32_t width = image.width / 3;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = third * width; x < (third + 1) * width; ++x) {
      const std::uint8_t* pixel = image.rgba.data() + 4 * (std::size_t{y} * image.width + x);
      most = std::max(most, int{pixel[0]} - int{pixel[2]});
    }
  }
  return most;
}

TEST_F(CurateProgram, DiffDrawsTheFrameThatAModifierMovesMost) {
  add_modifier(limb_.path(), {.type = "inflate",
                              .frames = {{{"take", "one"}, {"frames", "7"}}},
                              .mask = {{"joints", {limb_.character().skeleton.joints[1].name}}},
                              .parameters = {{"distance_mm", 5}}});
  const ProgramResult drawn = curate("diff", "inflate --picture " + at("p.png"));
  ASSERT_EQ(drawn.exit_code, 0) << drawn.output;
  EXPECT_NE(drawn.output.find("one 7 before 'inflate'"), std::string::npos) << drawn.output;
  // What is darkest in the picture is the table's largest.
  EXPECT_NE(drawn.output.find("darkest at 5.00 mm"), std::string::npos) << drawn.output;
  EXPECT_NE(drawn.output.find(" 5.000   one 7"), std::string::npos) << drawn.output;
  const Image image = testing::read_png(at("p.png"));
  EXPECT_GT(warmth(image, 2), warmth(image, 0) + 60);
  EXPECT_LT(std::abs(warmth(image, 1) - warmth(image, 0)), 30);
}

TEST_F(CurateProgram, DiffDrawsNothingOfWhatMovesNothing) {
  add_modifier(limb_.path(), {.type = "drop", .frames = {{{"take", "one"}, {"frames", "7"}}}});
  EXPECT_EQ(curate("diff", "drop --picture " + at("p.png")).exit_code, 64);
  const ProgramResult of_all = curate("diff", "--picture " + at("p.png"));
  EXPECT_EQ(of_all.exit_code, 64);
  EXPECT_NE(of_all.output.find("the stack has 'drop'"), std::string::npos) << of_all.output;
  EXPECT_FALSE(std::filesystem::exists(at("p.png")));
}

// Where most frames are moved as far as the cap lets, that is said.
TEST_F(CurateProgram, DiffSaysThatConsistencyReachesItsCap) {
  const Character character = limb_character();
  const CuratedLimb limb(
      [&](int take, int frame, const Positions& truth) { return with_history(character, take, frame, truth); });
  add_modifier(limb.path(), {.type = "consistency", .parameters = {{"cap_mm", 1}}});
  const std::string diff = "curate diff " + limb.folder().string();
  EXPECT_NE(run_bodyopt(diff).output.find("as far as cap_mm lets it (1 mm)"), std::string::npos);
  change_modifier(limb.path(), "consistency", {.parameters = {{"cap_mm", 20}}});
  EXPECT_EQ(run_bodyopt(diff).output.find("cap_mm"), std::string::npos);
}

TEST_F(CurateProgram, AnExportedFrameComesBackAsItIs) {
  const std::string frame = "--take one --frame 5 ";
  ASSERT_EQ(curate("export-frame", frame + "--out " + at("frame.obj")).exit_code, 0);
  std::stringstream text;
  text << std::ifstream(at("frame.obj")).rdbuf();
  EXPECT_NE(text.str().find("usemtl " + limb_.character().skeleton.joints[1].name), std::string::npos);
  const ProgramResult back = curate("import-frame", frame + "--mesh " + at("frame.obj") + " --name s");
  ASSERT_EQ(back.exit_code, 0) << back.output;
  EXPECT_NE(back.output.find("nothing is changed"), std::string::npos) << back.output;
  EXPECT_TRUE(read_dataset(limb_.path()).modifiers.empty());
  EXPECT_EQ(limb_.stack().shape(4), limb_.stack().database().raw_shape(4));
}

// Every vertex with y above `above` of an OBJ goes up by 5 mm.
void raise(const std::string& from, const std::string& to, double above) {
  std::ifstream file(from);
  std::ofstream raised(to);
  raised.precision(9);
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string word;
    double x = 0, y = 0, z = 0;
    if (words >> word && word == "v" && words >> x >> y >> z && y > above) {
      raised << "v " << x << ' ' << y + 0.005 << ' ' << z << '\n';
    } else {
      raised << line << '\n';
    }
  }
}

// What came below meanwhile stays, what was sculpted is added: the mesh is of what was exported. Its spread reaches
// three steps of 6 degrees to either side, to and fro, in both takes.
TEST_F(CurateProgram, ASculptIsOfTheFrameAsItWasExported) {
  const std::string frame = "--take one --frame 16 ", spread = " --name s --spread 20";
  ASSERT_EQ(curate("export-frame", frame + "--unposed --out " + at("frame.obj")).exit_code, 0);
  const double above = 0.5 * limb_.character().vertices.col(1).maxCoeff();
  raise(at("frame.obj"), at("sculpt.obj"), above);
  raise(at("frame.obj"), at("more.obj"), 0.5 * above);
  const Positions raw = limb_.stack().offsets(15, 0);
  add_modifier(limb_.path(), {.type = "inflate", .parameters = {{"distance_mm", 2}}});
  const Positions below = limb_.stack().offsets(15, 1);
  // Looked at once more: the sculpt is still of the first.
  ASSERT_EQ(curate("export-frame", frame + "--unposed --out " + at("later.obj")).exit_code, 0);
  for (const std::string mesh : {"sculpt.obj", "more.obj"}) {  // the second in the place of the first
    const ProgramResult imported = curate("import-frame", frame + "--unposed --mesh " + at(mesh) + spread);
    ASSERT_EQ(imported.exit_code, 0) << imported.output;
    EXPECT_NE(imported.output.find("one 16 has changed by 2.00 mm since the mesh was exported (modifiers 'inflate')"),
              std::string::npos)
        << imported.output;
    EXPECT_NE(imported.output.find("moves one 16 by 5.00 mm at most, and 27 other frames within 20 degrees by less"),
              std::string::npos)
        << imported.output;
    const Positions sculpted = limb_.stack().offsets(15, 2) - below;
    const double limit = mesh == "sculpt.obj" ? above : 0.5 * above;
    for (Eigen::Index v = 0; v < sculpted.rows(); ++v) {
      const double moved = limb_.character().vertices(v, 1) + raw(v, 1) > limit ? 0.005 : 0;
      ASSERT_LT((sculpted.row(v) - Eigen::RowVector3d(0, moved, 0)).norm(), 1e-5) << mesh << ", vertex " << v;
    }
  }
  undo_modifiers(limb_.path());
  undo_modifiers(limb_.path());
  ASSERT_EQ(curate("prune", "").exit_code, 0);
  EXPECT_NE(curate("import-frame", frame + "--unposed --mesh " + at("sculpt.obj") + spread).output.find("has changed"),
            std::string::npos);
  undo_modifiers(limb_.path());
  ASSERT_EQ(curate("prune", "--history").exit_code, 0);
  EXPECT_EQ(curate("import-frame", frame + "--unposed --mesh " + at("sculpt.obj") + spread).output.find("has changed"),
            std::string::npos)
      << "forgotten: of the frame as it is";
}

TEST_F(CurateProgram, AFrameThatIsNotSolvedIsRefusedWithTheNearest) {
  Dataset dataset = read_dataset(limb_.path());
  std::vector<FrameStatus> status;
  for (const int frame : dataset.takes[0].frames) status.push_back({frame, 0, frame < 16 || frame > 18});
  write_frame_status(status, at("status.json"));
  dataset.takes[0].shapes_status = "status.json";
  write_dataset(dataset, limb_.path());
  const ProgramResult refused = curate("export-frame", "--take one --frame 17 --out " + at("frame.obj"));
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.output.find("no solved frame 17; nearest to it: 15 and 19"), std::string::npos) << refused.output;
}

TEST_F(CurateProgram, ABakedDatasetKeepsWhatATrainingWouldHoldOut) {
  const auto heldout = [&](const std::string& options) {
    const std::string folder = at("baked" + options.substr(0, 1));
    EXPECT_EQ(curate("bake", "--out " + folder + " " + options).exit_code, 0);
    return read_dataset(folder + "/dataset.json").takes[0].heldout;
  };
  EXPECT_EQ(heldout(""), std::vector<int>());
  const std::vector<int> second = {11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40};
  EXPECT_EQ(heldout("--heldout-every 2"), second);
}

TEST_F(CurateProgram, ASculptThatIsNotSeenIsSaid) {
  const std::string frame = "--take one --frame 16 ";
  ASSERT_EQ(curate("export-frame", frame + "--out " + at("frame.obj")).exit_code, 0);
  raise(at("frame.obj"), at("sculpt.obj"), 0);
  const std::string import = frame + "--mesh " + at("sculpt.obj") + " --name s";
  ASSERT_EQ(curate("import-frame", import).output.find("not what was sculpted"), std::string::npos);
  enable_modifier(limb_.path(), "s", false);
  const ProgramResult hidden = curate("import-frame", import);
  EXPECT_NE(hidden.output.find("'s' is switched off"), std::string::npos) << hidden.output;
}

}  // namespace
}  // namespace bodyopt
