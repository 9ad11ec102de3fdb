// What a dataset and a basis remember from one run of the program to the next.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "assets/characters/muscles.h"
#include "base/frame_range.h"
#include "dataset/dataset.h"
#include "runtime/basis/safetensors.h"
#include "runtime/core/json.h"
#include "runtime/core/text.h"
#include "tests/cli/limb_files.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/png_file.h"
#include "tests/support/run_verb.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

using namespace draw;

// A draft of fourteen frames of the limb's motion.
bool makes_draft(const LimbFiles& files, const std::string& data) {
  return run_verb("simulate " + files.character + " --clip " + files.motion +
                  " --fps 120 --draft --frames 1-14 --out " + data)
             .exit_code == 0;
}

TEST(Takes, FramesAreAddedNotReplaced) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string();
  const std::string simulate = "simulate " + files.character + " --clip " + files.motion + " --out " + data;
  ASSERT_EQ(run_verb(simulate + " --frames 2,5").exit_code, 0);
  ASSERT_EQ(run_verb(simulate + " --frames 3 --heldout 3").exit_code, 0);
  const Dataset dataset = read_dataset(folder / "data/dataset.json");
  ASSERT_EQ(dataset.takes.size(), 1u);
  EXPECT_EQ(dataset.takes[0].frames, (std::vector<int>{2, 3, 5}));
  EXPECT_EQ(dataset.takes[0].heldout, std::vector<int>{3});
  EXPECT_EQ(Pc2Reader(folder / "data/bend.pc2").sample_count(), 3u);
  EXPECT_EQ(run_verb("check " + data).exit_code, 0);

  const ProgramResult other = run_verb(simulate + " --fps 12");
  EXPECT_EQ(other.exit_code, 3) << other.output;
  EXPECT_NE(other.output.find("--name"), std::string::npos) << other.output;
  EXPECT_EQ(run_verb(simulate + " --fps 12 --frames 2 --name slow").exit_code, 0);
  EXPECT_EQ(read_dataset(folder / "data/dataset.json").takes.size(), 2u);
}

TEST(Takes, SimulateTellsTheUnitThatADatasetWasMadeWith) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1000);
  const std::string simulate =
      "simulate " + files.character + " --clip " + files.motion + " --out " + (folder / "data").string() + " --draft";
  ASSERT_EQ(run_verb(simulate + " --unit 0.001 --frames 1").exit_code, 0);
  const ProgramResult without = run_verb(simulate + " --frames 2");
  EXPECT_EQ(without.exit_code, 0) << without.output;
  EXPECT_EQ(read_dataset(folder / "data/dataset.json").unit, 0.001);
}

// Of a unit that is said and makes the limb 500 m long.
TEST(Takes, AUnitThatMakesAGiantIsWarnedOf) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string unit = " --unit 1000 ", told = "With a unit of 1000 m the skin's bounding box measures";
  for (const std::string& command :
       {"check " + files.character + unit, "check " + files.character + " --clip " + files.motion + unit,
        "train --ddm-only " + files.character + " --out " + (folder / "limb.safetensors").string() + unit}) {
    const ProgramResult result = run_verb(command);
    EXPECT_NE(result.output.find(told), std::string::npos) << command << "\n" << result.output;
  }
}

// Before any work is done, and before anything is written.
TEST(Takes, SimulateRefusesWhatWouldGoWrongAtItsEnd) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string();
  const std::string simulate = "simulate " + files.character + " --clip " + files.motion + " --out " + data;
  const auto expect = [&](int exit_code, const std::string& options, const std::string& named) {
    const ProgramResult result = run_verb(simulate + options);
    EXPECT_EQ(result.exit_code, exit_code) << options << "\n" << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << result.output;
    EXPECT_FALSE(std::filesystem::exists(folder / "data/dataset.json"));
  };
  for (const char* name : {"../evil", "a/b", ".hidden", "''", "'two words'"}) {
    expect(64, std::string(" --frames 1 --name ") + name, "--name");
  }
  expect(64, " --frames ''", "--frames");
  expect(64, " --frames 1 --heldout ''", "--heldout");
  expect(4, " --frames 1 --json " + (folder / "no/a.json").string(), "a.json");
  std::filesystem::create_directory(folder / "data");
  const TakeLock another_run(folder / "data/bend.pc2");
  expect(4, " --frames 1", "another run");
  expect(4, " --frames 1 --draft", "another run");
  EXPECT_EQ(run_verb(simulate + " --frames 1 --name bend-2.b").exit_code, 0);
}

// Flexed in the same pose, trained, and flexed again: what the control does is learned under its name.
TEST(Takes, AFlexedMuscleIsLearnedAsAControl) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const Character limb = read_character(files.character);
  write_muscles({make_flexor()}, limb.skeleton, folder / "muscles.json");
  std::ofstream(folder / "flex.json")
      << R"({"schema": "bodyopt-controls-1", "controls": {"flexor": [[1, 1], [11, 0.4]]}})";
  const std::string data = (folder / "data").string(), basis = (folder / "limb.safetensors").string();
  const std::string simulate = "simulate " + files.character + " --clip " + files.motion + " --fps 48 --muscles " +
                               (folder / "muscles.json").string() + " --out " + data;
  const std::string controls = " --controls " + (folder / "flex.json").string();
  ASSERT_EQ(run_verb(simulate).exit_code, 0);
  ASSERT_EQ(run_verb(simulate + controls + " --name flexed").exit_code, 0);
  EXPECT_EQ(read_dataset(folder / "data/dataset.json").takes[1].controls, "../flex.json");
  ASSERT_EQ(run_verb("check " + data).exit_code, 0);
  ASSERT_EQ(run_verb(simulate + controls + " --frames 4,8 --heldout 4,8 --name unseen").exit_code, 0);
  const ProgramResult trained = run_verb("train " + data + " --out " + basis);
  ASSERT_EQ(trained.exit_code, 0) << trained.output;
  const std::string eval = "eval " + basis + " --clip " + files.motion + " --fps 48 --device cpu --out ";
  const std::string relaxed = (folder / "relaxed.pc2").string(), flexed = (folder / "flexed.pc2").string();
  ASSERT_EQ(run_verb(eval + relaxed).exit_code, 0);
  ASSERT_EQ(run_verb(eval + flexed + controls).exit_code, 0);
  const std::string truth = data + "/bend.pc2", flexed_truth = data + "/flexed.pc2";
  EXPECT_EQ(run_verb("compare " + truth + " " + flexed_truth + " --fail-above 0.8").exit_code, 2);
  EXPECT_EQ(run_verb("compare " + relaxed + " " + truth + " --fail-above 0.8").exit_code, 0);
  EXPECT_EQ(run_verb("compare " + flexed + " " + flexed_truth + " --fail-above 0.8").exit_code, 0);

  std::ofstream(folder / "flex.json") << R"({"schema": "bodyopt-controls-1", "controls": {"extensor": 1}})";
  const ProgramResult unknown = run_verb(eval + flexed + controls);
  EXPECT_EQ(unknown.exit_code, 0);
  EXPECT_NE(unknown.output.find("'extensor'"), std::string::npos) << unknown.output;
  EXPECT_EQ(run_verb(simulate + controls + " --name other").exit_code, 3);
}

TEST(Takes, ABasisIsAsLargeAsAskedFor) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string(), basis = (folder / "limb.safetensors").string();
  const std::string simulate = "simulate " + files.character + " --clip " + files.motion;
  ASSERT_EQ(run_verb(simulate + " --fps 60 --draft --out " + data).exit_code, 0);
  const std::string train = "train " + data + " --out " + basis;
  EXPECT_EQ(run_verb(train + " --budget 400 --tolerance 1").exit_code, 64);
  EXPECT_EQ(run_verb(train + " --budget -3").exit_code, 64);
  const ProgramResult small = run_verb(train + " --budget 20");
  EXPECT_EQ(small.exit_code, 64);
  EXPECT_NE(small.output.find("--smoothing-radius"), std::string::npos) << small.output;
  EXPECT_FALSE(std::filesystem::exists(basis));
  const ProgramResult strict = run_verb(train + " --tolerance 1e-6");
  EXPECT_EQ(strict.exit_code, 2);
  EXPECT_NE(strict.output.find("are to be expected of the best basis"), std::string::npos) << strict.output;
  const ProgramResult info = run_verb("info " + basis);
  EXPECT_EQ(info.exit_code, 0);
  EXPECT_NE(info.output.find("expected RMS, mm"), std::string::npos) << info.output;
  EXPECT_NE(info.output.find("estimated us: of a frame on one core"), std::string::npos) << info.output;
  for (const char* coded : {"\\\"", "{", "}"}) EXPECT_EQ(info.output.find(coded), std::string::npos) << info.output;
}

// With frames held out, and without.
TEST(Takes, AReportHoldsWhatTrainingMeasured) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string(), basis = (folder / "limb.safetensors").string();
  const std::string report = (folder / "made/report").string(), clip = " --clip " + files.motion + " --fps 120";
  const std::string simulate = "simulate " + files.character + clip + " --draft --out " + data;
  ASSERT_EQ(run_verb(simulate).exit_code, 0);
  const auto read = [&](const std::string& name) { return Json::parse(std::ifstream(folder / name)); };
  const std::string train = "train " + data + " --out " + basis + " --seed 7 --report " + report;
  const ProgramResult bare = run_verb(train);
  ASSERT_EQ(bare.exit_code, 0) << bare.output;
  Json told = read("made/report/report.json");
  EXPECT_EQ(told["methods"].size(), 0u);
  EXPECT_FALSE(told.contains("coverage"));
  EXPECT_GT(told["regions"].size(), 0u);

  std::vector<int> heldout;
  Dataset dataset = read_dataset(folder / "data/dataset.json");
  for (std::size_t k = 0; k < dataset.takes[0].frames.size(); k += 4) heldout.push_back(dataset.takes[0].frames[k]);
  dataset.takes[0].heldout = heldout;
  write_dataset(dataset, folder / "data/dataset.json");
  const ProgramResult trained = run_verb(train + " --ablate --json " + (folder / "train.json").string());
  ASSERT_EQ(trained.exit_code, 0) << trained.output;
  told = read("made/report/report.json");
  const Json result = read("train.json");
  ASSERT_EQ(told["methods"].size(), 12u);
  for (std::size_t m = 0; m < 12; ++m) {
    EXPECT_EQ(told["methods"][m]["name"], result["ablation"][m]["method"]);
    EXPECT_EQ(told["methods"][m]["errors_mm"], result["ablation"][m]["errors_mm"]);
    EXPECT_EQ(told["methods"][m]["frame_rms_mm"].size(), heldout.size());
  }
  EXPECT_EQ(told["methods"].back()["errors_mm"], result["errors_mm"]["full"]);
  EXPECT_EQ(told["methods"][1]["errors_mm"], result["errors_mm"]["ddm"]);
  EXPECT_EQ(told["heldout"]["frames"], heldout);
  EXPECT_EQ(told["expected_rms_mm"], result["expected_rms_mm"]);
  const Json& provenance = told["provenance"];
  EXPECT_EQ(provenance["options"]["seed"], "7");
  EXPECT_EQ(provenance["basis_checksum"], read_safetensors(basis).metadata.at("checksum"));
  EXPECT_EQ(provenance["takes"][0]["heldout"], format_frame_range(heldout));
  EXPECT_EQ(provenance["files"][0]["path"], data + "/dataset.json");
  EXPECT_EQ(provenance["files"][1]["path"], dataset.character);
  EXPECT_EQ(provenance["files"][1]["xxh3"], hexadecimal(file_hash(files.character)));
  EXPECT_NE(provenance["command_line"].get<std::string>().find("bodyopt train " + data), std::string::npos);

  // What `eval` and `coverage` expect of these frames is what the report says.
  const std::string shot = basis + clip + " --frames " + format_frame_range(heldout);
  const std::string cache = (folder / "out.pc2").string();
  ASSERT_EQ(run_verb("eval " + shot + " --device cpu --out " + cache + " --json " + cache + ".json").exit_code, 0);
  ASSERT_EQ(run_verb("coverage " + shot + " --json " + cache + ".coverage.json").exit_code, 0);
  const Json evaluated = read("out.pc2.json"), covered = read("out.pc2.coverage.json");
  ASSERT_EQ(evaluated["per_frame"].size(), heldout.size());
  for (std::size_t k = 0; k < heldout.size(); ++k) {
    EXPECT_EQ(evaluated["per_frame"][k]["frame"], heldout[k]);
    EXPECT_EQ(evaluated["per_frame"][k]["expected_rms_mm"], covered["per_frame"][k]["expected_rms_mm"]);
    EXPECT_EQ(told["coverage"]["frame_expected_rms_mm"][k], covered["per_frame"][k]["expected_rms_mm"]);
  }
}

// Is anything yellow, as nothing of a picture is that is not cut open?
bool shows_fat(const Image& image) {
  for (std::size_t pixel = 0; pixel < image.rgba.size(); pixel += 4) {
    const std::uint8_t* at = &image.rgba[pixel];
    if (at[0] > 2 * at[2] && at[1] > at[2] + 40) return true;
  }
  return false;
}

TEST(Takes, APictureShowsAFrame) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string();
  ASSERT_EQ(run_verb("simulate " + files.character + " --clip " + files.motion + " --frames 6 --out " + data).exit_code,
            0);
  const std::string picture = "picture " + data + " --around lower --radius 0.2 --size 64 64 --out ";
  const std::string whole = (folder / "whole.png").string(), cut = (folder / "cut.png").string();
  const ProgramResult drawn = run_verb(picture + whole + " --frame 6");
  ASSERT_EQ(drawn.exit_code, 0) << drawn.output;
  ASSERT_EQ(run_verb(picture + cut + " --frame 6 --cut-open").exit_code, 0);
  EXPECT_FALSE(shows_fat(testing::read_png(whole)));
  EXPECT_TRUE(shows_fat(testing::read_png(cut)));
  EXPECT_EQ(run_verb(picture + whole + " --frame 5").exit_code, 64);
  EXPECT_EQ(run_verb("picture " + data + " --around foot --frame 6 --out " + whole).exit_code, 64);
  EXPECT_EQ(run_verb(picture + whole + " --frame 6 --direction 0 0 0").exit_code, 64);
  EXPECT_EQ(run_verb(picture + "/nonexistent/x.png --frame 6").exit_code, 4);
  const ProgramResult json = run_verb(picture + whole + " --frame 6 --json -");
  EXPECT_NE(json.output.find("\"frame\": 6"), std::string::npos) << json.output;

  // The clip was replaced by a shorter one.
  std::filesystem::remove(files.motion);
  const Character limb = read_character(files.character);
  Clip rest;
  rest.name = "bend";
  rest.poses = {bind_pose(limb.skeleton)};
  write_clip(rest, limb.skeleton, files.motion);
  const ProgramResult lacking = run_verb(picture + whole + " --frame 6");
  EXPECT_EQ(lacking.exit_code, 3) << lacking.output;
  EXPECT_NE(lacking.output.find("frame 6"), std::string::npos) << lacking.output;
}

// The inside of a frame that is not the one whose skin is stored would be shown inside the wrong skin.
TEST(Takes, OnlyWhatWasSolvedAlikeIsCutOpen) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string materials = (folder / "m.json").string(), out = (folder / "p.png").string();
  const auto simulate = [&](const std::string& data, const std::string& options) {
    EXPECT_EQ(run_verb("simulate " + files.character + " --clip " + files.motion + " --frames 2 --out " +
                       (folder / data).string() + options)
                  .exit_code,
              0);
  };
  const auto cut = [&](const std::string& data) {
    return run_verb("picture " + (folder / data).string() + " --frame 2 --size 64 64 --cut-open --out " + out);
  };
  const auto expect_refused = [&](const std::string& data, const std::string& named) {
    const ProgramResult result = cut(data);
    EXPECT_EQ(result.exit_code, 3) << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << result.output;
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  simulate("fine", " --tet-size 0.02");
  expect_refused("fine", "--tet-size");

  std::ofstream(materials) << R"({"schema": "bodyopt-materials-1", "fat": {"shear_modulus_pa": 6e3}})";
  simulate("soft", " --materials " + materials);
  EXPECT_EQ(cut("soft").exit_code, 0);
  std::filesystem::remove(out);
  std::ofstream(materials) << R"({"schema": "bodyopt-materials-1", "fat": {"shear_modulus_pa": 5e3}})";
  expect_refused("soft", "materials");

  Dataset dataset = read_dataset(folder / "soft/dataset.json");
  dataset.takes[0].shapes_status.clear();
  write_dataset(dataset, folder / "soft/dataset.json");
  expect_refused("soft", "side-car");

  Character open = read_character(files.character);
  open.output_triangles = open.triangles = Triangles(open.triangles.bottomRows(2 * open.triangles.rows() / 3));
  write_character(open, files.character);
  simulate("caged", "");
  const ProgramResult caged = cut("caged");
  EXPECT_EQ(caged.exit_code, 0) << caged.output;
}

// A control that flexes nothing, or is no share of what a muscle can, is found before a long simulation or training.
TEST(Takes, CheckReadsControlsAndMaterials) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const Character limb = read_character(files.character);
  write_muscles({make_flexor()}, limb.skeleton, folder / "muscles.json");
  const auto write_controls = [&](const std::string& controls) {
    std::ofstream(folder / "flex.json") << R"({"schema": "bodyopt-controls-1", "controls": )" << controls << "}";
  };
  const auto write_materials = [&](const std::string& entry) {
    std::ofstream(folder / "m.json") << R"({"schema": "bodyopt-materials-1", )" << entry << "}";
  };
  write_controls(R"({"flexor": [[3, 1], [6, 2]]})");  // too much only where no frame is simulated
  write_materials(R"("fat": {"shear_modulus_pa": 6e3})");
  const std::string data = (folder / "data").string();
  ASSERT_EQ(run_verb("simulate " + files.character + " --clip " + files.motion + " --frames 2,3 --muscles " +
                     (folder / "muscles.json").string() + " --materials " + (folder / "m.json").string() +
                     " --controls " + (folder / "flex.json").string() + " --out " + data)
                .exit_code,
            0);
  const auto expect = [&](int exit_code, const std::string& named) {
    const ProgramResult result = run_verb("check " + data);
    EXPECT_EQ(result.exit_code, exit_code) << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << result.output;
  };
  expect(0, "it belongs together");
  write_controls(R"({"flexor": [[2, 0], [3, 70]]})");
  expect(3, "'flexor' is 70 in frame 3");
  write_controls(R"({"extensor": 0})");
  expect(3, "'extensor'");
  write_controls(R"({"fl*": 1})");
  expect(0, "it belongs together");
  write_materials(R"("fat": {"shear_modulus": 6e3})");
  expect(4, "shear_modulus");
  std::filesystem::remove(folder / "m.json");
  expect(4, "m.json");
}

// What would be learned of them is of no use, and the held-out frames would not tell: they are as wrong.
TEST(Takes, TrainRefusesWhatCheckRefuses) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string(), basis = (folder / "limb.safetensors").string();
  ASSERT_EQ(run_verb("simulate " + files.character + " --clip " + files.motion + " --out " + data).exit_code, 0);
  const auto scale_samples = [&](std::uint32_t count, float scale) {
    const Pc2Reader shapes(folder / "data/bend.pc2");
    Pc2Writer writer(folder / "data/bend.pc2", shapes.point_count(), shapes.sample_count());
    for (std::uint32_t k = 0; k < shapes.sample_count(); ++k) {
      std::vector<float> sample = shapes.sample(k);
      for (float& x : sample) x *= k < count ? scale : 1;
      writer.append(sample);
    }
    writer.close();
  };
  scale_samples(6, 100);
  for (const std::string& command : {"check " + data, "train " + data + " --out " + basis}) {
    const ProgramResult refused = run_verb(command);
    EXPECT_EQ(refused.exit_code, 3) << refused.output;
    EXPECT_NE(refused.output.find("take 'bend': the shapes lie"), std::string::npos) << refused.output;
    EXPECT_NE(refused.output.find("centimetres"), std::string::npos) << refused.output;
  }
  EXPECT_FALSE(std::filesystem::exists(basis));

  // A frame that did not converge may be a wreck: it is left out, not held against the others.
  scale_samples(1, 0.01f);
  std::vector<FrameStatus> status = read_frame_status(folder / "data/bend.status.json");
  for (std::size_t k = 1; k < status.size(); ++k) status[k].converged = false;
  write_frame_status(status, folder / "data/bend.status.json");
  EXPECT_EQ(run_verb("check " + data).exit_code, 0);
  for (FrameStatus& frame : status) frame.converged = false;
  write_frame_status(status, folder / "data/bend.status.json");
  const std::string json = (folder / "check.json").string();
  const ProgramResult unsolved = run_verb("check " + data + " --json " + json);
  EXPECT_EQ(unsolved.exit_code, 3) << unsolved.output;
  EXPECT_NE(unsolved.output.find("none compared with the skinned character"), std::string::npos) << unsolved.output;
  EXPECT_NE(unsolved.output.find("not one of its "), std::string::npos) << unsolved.output;
  EXPECT_EQ(unsolved.output.find("it belongs together"), std::string::npos) << unsolved.output;
  EXPECT_TRUE(Json::parse(testing::read_bytes(json)).at("takes")[0].at("fit_mm").is_null());
}

// A character in centimetres: its basis reads the clips alike, without being told again.
TEST(Takes, ABasisRemembersTheUnit) {
  const TemporaryFolder metres_folder, centimetres_folder;
  const LimbFiles metres(metres_folder, 1), centimetres(centimetres_folder, 100);
  const auto evaluate = [](const TemporaryFolder& folder, const LimbFiles& files, const std::string& unit) {
    const std::string basis = (folder / "b.safetensors").string(), cache = (folder / "c.pc2").string();
    EXPECT_EQ(run_verb("train --ddm-only " + files.character + unit + " --out " + basis).exit_code, 0);
    EXPECT_EQ(run_verb("eval " + basis + " --clip " + files.motion + " --device cpu --out " + cache).exit_code, 0);
    return cache;
  };
  const std::string a = evaluate(metres_folder, metres, ""),
                    b = evaluate(centimetres_folder, centimetres, " --unit 0.01");
  const ProgramResult compared = run_verb("compare " + a + " " + b + " --fail-above 0.01");
  EXPECT_EQ(compared.exit_code, 0) << compared.output;
}

TEST(Takes, InfoSaysHowLongClipsAre) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  std::ofstream(folder / "a.bvh") << "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n"
                                     "End Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 3\nFrame Time: 0.25\n"
                                     "0 0 0\n1 0 0\n2 0 0\n";
  const ProgramResult bvh = run_verb("info " + (folder / "a.bvh").string());
  EXPECT_EQ(bvh.exit_code, 0) << bvh.output;
  EXPECT_NE(bvh.output.find("hips"), std::string::npos);
  EXPECT_NE(bvh.output.find("0.5"), std::string::npos);  // seconds
  std::filesystem::resize_file(folder / "a.bvh", std::filesystem::file_size(folder / "a.bvh") - 8);
  EXPECT_EQ(run_verb("info " + (folder / "a.bvh").string()).exit_code, 4);
}

TEST(Takes, FilesOfTheWrongKindAreCalledByTheirKind) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  std::filesystem::copy_file(files.character, folder / "dataset.json");
  const ProgramResult json = run_verb("check " + (folder / "dataset.json").string());
  EXPECT_EQ(json.exit_code, 4);
  EXPECT_NE(json.output.find("looks like a binary glTF"), std::string::npos) << json.output;
  const ProgramResult basis =
      run_verb("eval " + files.character + " --clip a.glb --out " + (folder / "o.pc2").string());
  EXPECT_EQ(basis.exit_code, 4);
  EXPECT_NE(basis.output.find("looks like a binary glTF"), std::string::npos) << basis.output;
  for (const auto& [start, kind] : {std::pair{"Kaydara FBX Binary  ", "an FBX file"},
                                    {"BLENDER-v300", "a Blender file"},
                                    {"PK\x03\x04 and more", "a ZIP archive"},
                                    {"#usda 1.0", "a USD file"}}) {
    std::ofstream(folder / "other.glb", std::ios::binary) << start << std::string(40, ' ');
    const ProgramResult other = run_verb("info " + (folder / "other.glb").string());
    EXPECT_EQ(other.exit_code, 4);
    EXPECT_NE(other.output.find(kind), std::string::npos) << other.output;
  }
}

TEST(Takes, TestSaysOfWhichPosesTheBasisLearned) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string simulate = "simulate " + files.character + " --clip " + files.motion + " --fps 120 --draft --out ";
  const std::string data = (folder / "data").string(), other = (folder / "other").string();
  const std::string basis = (folder / "limb.safetensors").string(), json = (folder / "test.json").string();
  ASSERT_EQ(run_verb(simulate + data + " --frames 1-14").exit_code, 0);
  ASSERT_EQ(run_verb(simulate + other + " --frames 14-26").exit_code, 0);
  ASSERT_EQ(run_verb("train " + data + " --out " + basis).exit_code, 0);
  const ProgramResult own = run_verb("test " + basis + " " + data + " --json " + json);
  EXPECT_NE(own.output.find("the basis learned from 14 of the 14 frames tested (1-14)"), std::string::npos)
      << own.output;
  EXPECT_EQ(Json::parse(testing::read_bytes(json)).at("takes")[0].at("learned_frames"), "1-14");
  // One of 13 is told, and no reason to warn.
  const ProgramResult of_other = run_verb("test " + basis + " " + other + " --json " + json);
  EXPECT_EQ(of_other.output.find("the basis learned from"), std::string::npos) << of_other.output;
  EXPECT_EQ(Json::parse(testing::read_bytes(json)).at("takes")[0].at("learned_frames"), "14");
  // That none was learned, and that it is not known, are two things.
  ASSERT_EQ(run_verb("train --ddm-only " + files.character + " --out " + basis).exit_code, 0);
  const ProgramResult untold = run_verb("test " + basis + " " + data + " --json " + json);
  EXPECT_TRUE(Json::parse(testing::read_bytes(json)).at("takes")[0].at("learned_frames").is_null());
  EXPECT_EQ(untold.output.find("which poses it learned from"), std::string::npos) << untold.output;
}

TEST(Takes, DraftsAreCutOpenAndRegionsAreDrawnFromAllAround) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string();
  ASSERT_TRUE(makes_draft(files, data));
  const std::string cut = (folder / "cut.png").string();
  const ProgramResult opened = run_verb("picture " + data + " --frame 2 --size 64 64 --cut-open --out " + cut);
  ASSERT_EQ(opened.exit_code, 0) << opened.output;
  EXPECT_TRUE(shows_fat(testing::read_png(cut)));

  const std::string picture = (folder / "regions.png").string(), json = (folder / "regions.json").string();
  ASSERT_EQ(run_verb("regions " + data + " --picture " + picture + " --json " + json).exit_code, 0);
  const Image image = testing::read_png(picture);
  EXPECT_EQ(image.width, 4 * 700u);
  EXPECT_EQ(image.height, 1000u);
  EXPECT_TRUE(Json::parse(testing::read_bytes(json)).at("not_numbered").is_array());
}

// Training bent the limb one way; the other clip bends it that way, too, and then another way.
TEST(Takes, TestAndEvalCountTheSamePosesAsUnlikeThoseOfTraining) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string(), other = (folder / "other").string();
  const std::string basis = (folder / "limb.safetensors").string(), aside = (folder / "aside.glb").string();
  const std::string simulate = "simulate " + files.character + " --draft --out ";
  ASSERT_EQ(run_verb(simulate + data + " --clip " + files.motion + " --fps 120 --frames 1-14").exit_code, 0);
  ASSERT_EQ(run_verb("train " + data + " --out " + basis).exit_code, 0);
  const Character limb = make_limb();
  Clip clip;
  clip.name = "aside";
  for (int n = 0; n < 4; ++n) clip.poses.push_back(bent(limb, degrees(5.0 * n)));
  for (int n = 0; n < 4; ++n) {
    Pose& pose = clip.poses.emplace_back(bent(limb, 0));
    pose.joints[1].rotation = pose.joints[1].rotation * axis_angle({0, 1, 0}, degrees(20 + 10.0 * n));
  }
  write_clip(clip, limb.skeleton, aside);
  ASSERT_EQ(run_verb(simulate + other + " --clip " + aside).exit_code, 0);
  const ProgramResult tested = run_verb("test " + basis + " " + other);
  const ProgramResult evaluated =
      run_verb("eval " + basis + " --clip " + aside + " --out " + (folder / "limb.pc2").string());
  ASSERT_EQ(tested.exit_code, 0) << tested.output;
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.output;
  const auto told = [](const std::string& output) {
    const std::size_t at = output.find(" that training did not show");
    if (at == std::string::npos) return std::string("nothing");
    const std::size_t begin = output.find_first_not_of(' ', output.rfind('\n', at) + 1);
    return output.substr(begin, output.find('\n', at) - begin);
  };
  EXPECT_TRUE(told(evaluated.output).starts_with("4 frames hold poses")) << evaluated.output;
  EXPECT_EQ(told(tested.output), told(evaluated.output));
}

// Training bent the limb by 38 degrees; the clip bends it on, to 170, and twists it.
TEST(Takes, EvalTellsWhereNoBetterThanDirectDeltaMushIsExpected) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string(), basis = (folder / "limb.safetensors").string();
  const std::string json = (folder / "eval.json").string();
  const std::string clip = " --clip " + files.motion + " --fps 120";
  ASSERT_EQ(run_verb("simulate " + files.character + clip + " --draft --frames 1-20 --out " + data).exit_code, 0);
  ASSERT_EQ(run_verb("train " + data + " --out " + basis).exit_code, 0);
  Clip further;
  further.name = "further";
  const Character limb = make_limb();
  for (int n = 0; n < 18; ++n) {
    Pose& pose = further.poses.emplace_back(bent(limb, degrees(10.0 * n)));
    pose.joints[1].rotation = pose.joints[1].rotation * axis_angle({1, 0, 0}, degrees(8.0 * n));
  }
  write_clip(further, limb.skeleton, (folder / "further.glb").string());
  const ProgramResult result = run_verb("eval " + basis + " --clip " + (folder / "further.glb").string() + " --out " +
                                        (folder / "limb.pc2").string() + " --json " + json);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Json told = Json::parse(testing::read_bytes(json));
  std::vector<int> frames;
  for (const Json& entry : told.at("per_frame")) {
    const double ddm = entry.value("expected_ddm_rms_mm", 0.0);
    if (ddm > 0.5 && entry.at("expected_rms_mm").get<double>() > 0.9 * ddm) frames.push_back(entry.at("frame"));
  }
  ASSERT_FALSE(frames.empty()) << told.at("per_frame").back();
  ASSERT_LT(frames.size(), told.at("per_frame").size());
  EXPECT_EQ(told.at("no_better_than_ddm_frames"), format_frame_range(frames));
  EXPECT_NE(result.output.find("no better than Direct Delta Mush alone is to be expected in " +
                               std::to_string(frames.size()) + " frame"),
            std::string::npos)
      << result.output;
}

// What is expected near the training frames says little of those that bend four times as far.
TEST(Takes, TrainTellsWhereHeldOutFramesAreFurtherOffThanExpected) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string();
  const std::string simulate = "simulate " + files.character + " --draft --out " + data + " --clip ";
  const std::string train = "train " + data + " --out " + (folder / "limb.safetensors").string();
  ASSERT_EQ(run_verb(simulate + files.motion + " --fps 120 --frames 1-20 --heldout 9").exit_code, 0);
  const std::string told = "the held-out frames are off by ";
  const ProgramResult near = run_verb(train);
  EXPECT_NE(near.output.find("mm RMS expected of poses near those trained on"), std::string::npos) << near.output;
  EXPECT_EQ(near.output.find(told), std::string::npos) << near.output;
  Clip further;
  further.name = "further";
  const Character limb = make_limb();
  for (int n = 0; n < 3; ++n) further.poses.push_back(bent(limb, degrees(90 + 10.0 * n)));
  write_clip(further, limb.skeleton, (folder / "further.glb").string());
  ASSERT_EQ(run_verb(simulate + (folder / "further.glb").string() + " --heldout all").exit_code, 0);
  const ProgramResult far = run_verb(train);
  EXPECT_NE(far.output.find(told), std::string::npos) << far.output;
}

TEST(Takes, HoldingOutEveryNthBlockSaysWhenThatIsNone) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string();
  ASSERT_TRUE(makes_draft(files, data));
  const std::string train = "train " + data + " --out " + (folder / "limb.safetensors").string() + " --heldout-every ";
  const ProgramResult none = run_verb(train + "3");
  EXPECT_EQ(none.exit_code, 0) << none.output;
  EXPECT_NE(none.output.find("holds out none of the frames"), std::string::npos) << none.output;
  EXPECT_NE(none.output.find("simulate another clip into the dataset with --heldout all"), std::string::npos)
      << none.output;
  EXPECT_EQ(run_verb(train + "2").output.find("holds out none"), std::string::npos);
}

}  // namespace
}  // namespace bodyopt
