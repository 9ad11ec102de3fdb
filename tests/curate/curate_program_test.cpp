// bodyopt curate, as it is run.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/json_file.h"
#include "dataset/modifier.h"
#include "runtime/basis/read_file.h"
#include "tests/curate/sweep_history.h"
#include "tests/support/png_file.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/exported_frames.h"

namespace bodyopt::trainer {
namespace {

using namespace draw;

class CurateProgram : public ::testing::Test {
 protected:
  ProgramResult curate(const std::string& verb, const std::string& options) const {
    return run_verb("curate " + verb + " " + limb_.folder().string() + " " + options);
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

// Of what moves no vertex how many frames it takes is all that there is to see.
TEST_F(CurateProgram, SaysHowManyFramesAModifierTakes) {
  const std::string all = std::to_string(limb_.stack().database().frames.size());
  const std::string told = " 3 of " + all + " frames (one 3)";
  const ProgramResult dropped = curate("add", "drop --take one --frames 5-7");
  ASSERT_EQ(dropped.exit_code, 0) << dropped.output;
  EXPECT_NE(dropped.output.find("drops" + told), std::string::npos) << dropped.output;
  EXPECT_NE(curate("diff", "").output.find("drops" + told), std::string::npos);
  const ProgramResult weighed = curate("add", "weight --take one --frames 5-7 --set weight=4 --json " + at("w.json"));
  EXPECT_NE(weighed.output.find("weighs" + told + "; weight=4"), std::string::npos) << weighed.output;
  const Json counts = Json::parse(testing::read_bytes(at("w.json"))).at("modifiers")[1].at("frame_counts");
  EXPECT_EQ(counts.at("taken"), 3);
  EXPECT_EQ(counts.at("takes").at("one"), 3);
  // Two stacks that differ by a parameter alone are told apart.
  ASSERT_EQ(curate("edit", "weight --set weight=2").exit_code, 0);
  EXPECT_NE(curate("list", "").output.find("; weight=2"), std::string::npos);
  EXPECT_NE(curate("undo", "").output.find("; weight=4"), std::string::npos);
  // What is switched off does nothing.
  EXPECT_NE(curate("disable", "drop").output.find("would drop" + told), std::string::npos);
  EXPECT_NE(curate("disable", "weight").output.find("would weigh" + told), std::string::npos);
}

// Where most frames are moved as far as the cap lets, that is said.
TEST_F(CurateProgram, DiffSaysThatConsistencyReachesItsCap) {
  const Character character = limb_character();
  const CuratedLimb limb(
      [&](int take, int frame, const Positions& truth) { return with_history(character, take, frame, truth); });
  add_modifier(limb.path(), {.type = "consistency", .parameters = {{"cap_mm", 1}}});
  const std::string diff = "curate diff " + limb.folder().string();
  EXPECT_NE(run_verb(diff).output.find("as far as cap_mm lets it (1 mm)"), std::string::npos);
  change_modifier(limb.path(), "consistency", {.parameters = {{"cap_mm", 20}}});
  EXPECT_EQ(run_verb(diff).output.find("cap_mm"), std::string::npos);
}

TEST_F(CurateProgram, AnExportedFrameComesBackAsItIs) {
  const std::string frame = "--take one --frame 5 ";
  ASSERT_EQ(curate("export-frame", frame + "--out " + at("frame.obj")).exit_code, 0);
  EXPECT_NE(testing::read_bytes(at("frame.obj")).find("usemtl " + limb_.character().skeleton.joints[1].name),
            std::string::npos);
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

// A wide sculpt of an early export, whose bump it covers, is of that one and takes what came later along.
TEST_F(CurateProgram, ASculptThatCoversWhatChangedIsOfItsOwnExport) {
  const std::string frame = "--take one --frame 16 --unposed ";
  ASSERT_EQ(curate("export-frame", frame + "--out " + at("first.obj")).exit_code, 0);
  const double above = 0.5 * limb_.character().vertices.col(1).maxCoeff();
  raise(at("first.obj"), at("narrow.obj"), above);
  raise(at("first.obj"), at("wide.obj"), 0);
  ASSERT_EQ(curate("import-frame", frame + "--mesh " + at("narrow.obj") + " --name narrow --spread 0").exit_code, 0);
  ASSERT_EQ(curate("export-frame", frame + "--out " + at("look.obj")).exit_code, 0);
  const Positions raw = limb_.stack().offsets(15, 0), below = limb_.stack().offsets(15, 1);
  const std::string import = frame + "--mesh " + at("wide.obj") + " --name wide --spread 0";
  const ProgramResult imported = curate("import-frame", import);
  EXPECT_NE(imported.output.find("has changed by 5.00 mm"), std::string::npos) << imported.output;
  const Positions sculpted = limb_.stack().offsets(15, 2) - below;
  for (Eigen::Index v = 0; v < sculpted.rows(); ++v) {
    const double moved = limb_.character().vertices(v, 1) + raw(v, 1) > 0 ? 0.005 : 0;
    ASSERT_LT((sculpted.row(v) - Eigen::RowVector3d(0, moved, 0)).norm(), 1e-5) << "vertex " << v;
  }
}

// Why a frame has changed, and what the sculpt moves by the modifier's strength and mask.
TEST_F(CurateProgram, AnImportSaysWhatIsSo) {
  const std::string frame = "--take one --frame 16 --unposed ", import = frame + "--name s --spread 20 --mesh ";
  add_modifier(limb_.path(), {.type = "smooth"});
  add_modifier(limb_.path(), {.type = "inflate",
                              .mask = {{"joints", {limb_.character().skeleton.joints[1].name}}},
                              .parameters = {{"distance_mm", 2}}});
  ASSERT_EQ(curate("export-frame", frame + "--out " + at("frame.obj")).exit_code, 0);
  raise(at("frame.obj"), at("sculpt.obj"), 0);
  EXPECT_EQ(curate("import-frame", frame + "--name smooth --mesh " + at("frame.obj")).exit_code, 64);
  move_modifier(limb_.path(), "smooth", 2);
  const ProgramResult moved = curate("import-frame", import + at("sculpt.obj"));
  EXPECT_NE(moved.output.find("(the order of the modifiers)"), std::string::npos) << moved.output;
  change_modifier(limb_.path(), "s", {.strength = 0.5});
  ASSERT_EQ(curate("export-frame", frame + "--out " + at("frame.obj")).exit_code, 0);
  change_modifier(limb_.path(), "s", {.strength = 0.25});
  const ProgramResult same = curate("import-frame", frame + "--name s --spread 3 --mesh " + at("frame.obj"));
  EXPECT_NE(same.output.find("(modifiers 's')"), std::string::npos) << same.output;
  EXPECT_NE(same.output.find("moves one 16 by 1.25 mm at most"), std::string::npos) << same.output;
  EXPECT_NE(same.output.find("within 20 degrees"), std::string::npos) << same.output;
}

TEST_F(CurateProgram, AParameterThatATypeLacksIsRefusedWithThoseItHas) {
  const ProgramResult refused = curate("add", "smooth --set radius=4");
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_NE(refused.output.find("no parameter 'radius'"), std::string::npos) << refused.output;
  EXPECT_NE(refused.output.find("Its type has 'radius_mm'"), std::string::npos) << refused.output;
}

// What was exported is a hint: where it is damaged, that is said, and the mesh is of the frame as it is.
TEST_F(CurateProgram, ADamagedRecordOfExportsIsSaidAndLeftOut) {
  const std::string frame = "--take one --frame 16 ";
  ASSERT_EQ(curate("export-frame", frame + "--out " + at("frame.obj")).exit_code, 0);
  raise(at("frame.obj"), at("sculpt.obj"), 0);
  const std::string record = export_files(read_dataset(limb_.path())).at(0);
  std::vector<Json> records(7, Json::parse(std::ifstream(record)));
  records[0].erase("modifiers");
  records[1]["schema"] = "bodyopt-exported-frame-2";
  records[2] = Json::array();
  records[3]["frame"] = "1";
  records[4]["skin"] = "modifiers/gone.pc2";
  records[5]["skin"] = "modifiers/short.pc2";
  std::ofstream(at("modifiers/short.pc2")) << "POINTCACHE2";
  const Json gone = {{"take", "one"}, {"frame", 16}, {"offsets", "modifiers/gone.pc2"}};
  const Json sculpt = {{"name", "s"}, {"type", "sculpt"}, {"parameters", {{"sculpts", Json::array({gone})}}}};
  records[6]["modifiers"] = Json::array({sculpt});
  for (const Json& text : records) {
    std::ofstream(record) << text;
    const ProgramResult imported = curate("import-frame", frame + "--mesh " + at("sculpt.obj") + " --name s");
    EXPECT_EQ(imported.exit_code, 0) << text << imported.output;
    EXPECT_NE(imported.output.find("an export is left out"), std::string::npos) << text << imported.output;
    EXPECT_NE(imported.output.find("moves one 16 by 5.00 mm at most"), std::string::npos) << imported.output;
    undo_modifiers(limb_.path());
  }
}

// Exports of an earlier version, all in one file, still say what a mesh is of, and are forgotten with the others.
TEST_F(CurateProgram, ExportsOfAnEarlierVersionAreKnown) {
  const std::string frame = "--take one --frame 16 --unposed ", import = frame + "--name s --spread 0 --mesh ";
  ASSERT_EQ(curate("export-frame", frame + "--out " + at("frame.obj")).exit_code, 0);
  raise(at("frame.obj"), at("sculpt.obj"), 0);
  const std::filesystem::path record = export_files(read_dataset(limb_.path())).at(0);
  Json entry = Json::parse(std::ifstream(record));
  entry.erase("schema");
  std::filesystem::remove(record);
  std::ofstream(at("modifiers/exported.json"))
      << Json{{"schema", "bodyopt-exported-frames-1"}, {"frames", Json::array({entry})}};
  add_modifier(limb_.path(), {.type = "inflate", .parameters = {{"distance_mm", 2}}});
  ASSERT_EQ(curate("prune", "").exit_code, 0);
  EXPECT_NE(curate("import-frame", import + at("sculpt.obj")).output.find("has changed by 2.00 mm"), std::string::npos);
  ASSERT_EQ(curate("prune", "--history").exit_code, 0);
  EXPECT_TRUE(export_files(read_dataset(limb_.path())).empty());
}

// A copy of a record, or what a conflict left of it, is none.
TEST_F(CurateProgram, OtherFilesBesideExportsAreNone) {
  const auto count = [&] { return export_files(read_dataset(limb_.path())).size(); };
  ASSERT_EQ(curate("export-frame", "--take one --frame 16 --out " + at("frame.obj")).exit_code, 0);
  const std::filesystem::path record = export_files(read_dataset(limb_.path())).at(0);
  const std::string name = record.filename(), hash = name.substr(name.size() - 21, 16);
  for (const std::string& other :
       {name + "~", "copy of " + name, "00001-exported-" + hash + ".json", "000001-imported-" + hash + ".json",
        "000001-exported-" + hash + "0.json", "000001-exported-G" + hash.substr(1) + ".json",
        "000001-exported-" + hash + ".jsom", std::string("000001"), std::string("-exported-")}) {
    std::filesystem::copy_file(record, record.parent_path() / other);
    EXPECT_EQ(count(), 1) << other;
  }
  std::filesystem::copy_file(record, record.parent_path() / ("1000001-exported-" + hash + ".json"));
  EXPECT_EQ(count(), 2);
}

// Two artists who export do not write into one file: what both wrote is there when their folders are put together.
TEST_F(CurateProgram, ExportsOfTwoArtistsMerge) {
  const auto files_of = [&] { return export_files(read_dataset(limb_.path())); };
  ASSERT_EQ(curate("export-frame", "--take one --frame 3 --out " + at("common.obj")).exit_code, 0);
  const std::filesystem::path other = limb_.folder() / "other";
  std::filesystem::copy(limb_.folder() / "modifiers", other, std::filesystem::copy_options::recursive);
  ASSERT_EQ(curate("export-frame", "--take one --frame 16 --out " + at("one.obj")).exit_code, 0);
  std::filesystem::rename(limb_.folder() / "modifiers", limb_.folder() / "first");
  std::filesystem::rename(other, limb_.folder() / "modifiers");
  ASSERT_EQ(curate("export-frame", "--take two --frame 7 --out " + at("two.obj")).exit_code, 0);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(limb_.folder() / "first")) {
    const std::filesystem::path merged =
        limb_.folder() / "modifiers" / std::filesystem::relative(entry.path(), limb_.folder() / "first");
    if (!entry.is_regular_file()) continue;
    if (std::filesystem::exists(merged)) {
      EXPECT_EQ(read_file(entry.path(), 1 << 20, "a file"), read_file(merged, 1 << 20, "a file")) << merged;
    } else {
      std::filesystem::copy_file(entry.path(), merged);
    }
  }
  EXPECT_EQ(files_of().size(), 3u);
  EXPECT_EQ(kept_exports(limb_.stack(), 15, "s").frames.size(), 1u);
  EXPECT_EQ(kept_exports(limb_.stack(), kSweepFrames + 6, "s").frames.size(), 1u);
}

// An export that is made again is the latest, and is written down once; of all the latest 200 stay.
TEST_F(CurateProgram, TheLatestExportsAreKept) {
  const ShapeStack stack = limb_.stack();
  const Dataset dataset = read_dataset(limb_.path());
  const auto keep = [&](std::size_t frame) {
    return keep_exported(limb_.path(), stack, frame, exported_now(stack, frame));
  };
  const std::string first = keep(0);
  keep(1);
  EXPECT_EQ(keep(0), first);
  ASSERT_EQ(export_files(dataset).size(), 2u);
  EXPECT_EQ(export_files(dataset).back().stem().string(), "000003-" + first);
  ExportedFrame exported = exported_now(stack, 2);
  for (int k = 0; k < 205; ++k) {
    exported.skin(0, 0) += 0.001;
    keep_exported(limb_.path(), stack, 2, exported);
  }
  EXPECT_EQ(export_files(dataset).size(), 200u);
  EXPECT_EQ(kept_exports(stack, 2, "s").frames.size(), 200u);
  EXPECT_NEAR(kept_exports(stack, 2, "s").frames.front().skin(0, 0), exported.skin(0, 0), 1e-6) << "the latest first";
}

// What could not be kept of an export is said; the mesh is written all the same.
TEST_F(CurateProgram, AnExportThatCannotBeKeptIsSaid) {
  std::ofstream(at("modifiers")) << "a file in the folder's way";
  const ProgramResult exported = curate("export-frame", "--take one --frame 16 --out " + at("frame.obj"));
  EXPECT_EQ(exported.exit_code, 0) << exported.output;
  EXPECT_NE(exported.output.find("will not know what was exported"), std::string::npos) << exported.output;
  EXPECT_TRUE(std::filesystem::exists(at("frame.obj")));
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
}  // namespace bodyopt::trainer
