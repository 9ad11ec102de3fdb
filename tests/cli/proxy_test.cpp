// Levels of detail, on the command line.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "assets/characters/muscles.h"
#include "runtime/basis/levels.h"
#include "runtime/core/json.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/run_verb.h"
#include "tests/support/temporary_folder.h"
#include "trainer/builtin/arm.h"
#include "trainer/train/features/features.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt {
namespace {

using namespace trainer;

// A limb in centimetres that moves, with shapes from elsewhere, and its full basis and proxy: once for all tests.
class Proxy : public ::testing::Test {
 protected:
  struct Data {
    Data() {
      const SampleSet set = limb_samples(60, 0);
      Character centimetres = set.character;
      centimetres.vertices *= 100;
      Clip motion;
      motion.name = "motion";
      Pc2Writer writer(folder / "shapes.pc2", set.character.output_count(), 60);
      for (const Sample& sample : set.train) {
        motion.poses.push_back(sample.pose);
        for (JointTransform& joint : motion.poses.back().joints) joint.translation = 100.0 * joint.translation;
        writer.append(output_from_welded(set.character, sample.shape.read()));
      }
      writer.close();
      for (Joint& joint : centimetres.skeleton.joints) {
        joint.bind.translation = 100.0 * joint.bind.translation;
        joint.default_local = joint.bind;
        for (auto& row : joint.inverse_bind.m) row[3] *= 100;
      }
      write_character(centimetres, character);
      write_clip(motion, centimetres.skeleton, folder / "motion.glb");
      added = run_verb("dataset add " + data + clip + " --shapes " + (folder / "shapes.pc2").string() +
                       " --character " + character + " --unit 0.01");
      trained = run_verb("train " + data + " --out " + basis);
      made = run_verb("proxy " + data + " --error 1 0.3 --out " + proxy + " --json " + proxy + ".json");
    }
    TemporaryFolder folder;
    std::string character = (folder / "limb.glb").string(), clip = " --clip " + (folder / "motion.glb").string(),
                data = (folder / "data").string(), basis = (folder / "full.safetensors").string(),
                proxy = (folder / "proxy.safetensors").string();
    ProgramResult added, trained, made;
  };
  static const Data& data() {
    static const Data made;
    return made;
  }
  static std::string at(const std::string& name) { return (data().folder / name).string(); }
};

TEST_F(Proxy, LevelsOfADatasetAreABasisAndCarryTheFullSkin) {
  ASSERT_EQ(data().added.exit_code, 0) << data().added.output;
  ASSERT_EQ(data().trained.exit_code, 0) << data().trained.output;
  ASSERT_EQ(data().made.exit_code, 0) << data().made.output;
  const auto result = Json::parse(std::ifstream(data().proxy + ".json"));
  ASSERT_EQ(result["levels"].size(), 2u);
  EXPECT_EQ(result["levels"][0]["error_mm"], 0.3);  // finest first
  EXPECT_GT(result["levels"][0]["bytes"], result["levels"][1]["bytes"]);
  EXPECT_GT(result["levels"][1]["microseconds"], 0);
  EXPECT_GT(result["levels"][1]["carrying_microseconds"], 0);

  const auto levels = load_levels(data().proxy);
  const auto points = [&](const std::string& options) {
    const ProgramResult run = run_verb("eval " + data().proxy + data().clip + options + " --out " + at("a.pc2"));
    EXPECT_EQ(run.exit_code, 0) << run.output;
    return Pc2Reader(at("a.pc2")).point_count();
  };
  EXPECT_EQ(points(""), levels[0].basis.mesh.output_count());
  EXPECT_EQ(points(" --level 1"), levels[1].basis.mesh.output_count());
  EXPECT_EQ(points(" --level 1 --full-skin"), levels[0].carried.size());
  EXPECT_EQ(result["levels"][0]["map_bytes"], levels[0].carried.bytes());

  ASSERT_EQ(run_verb("eval " + data().basis + data().clip + " --out " + at("full.pc2")).exit_code, 0);
  ASSERT_EQ(points(" --full-skin"), Pc2Reader(at("full.pc2")).point_count());
  const ProgramResult compared = run_verb("compare " + at("a.pc2") + " " + at("full.pc2") + " --json -");
  ASSERT_EQ(compared.exit_code, 0) << compared.output;
  const std::size_t begin = compared.output.find('{');
  EXPECT_LT(Json::parse(compared.output.substr(begin, compared.output.rfind('}') + 1 - begin))["rms"], 2.0);
}

TEST_F(Proxy, InfoTellsTheLevels) {
  const ProgramResult info = run_verb("info " + data().proxy);
  ASSERT_EQ(info.exit_code, 0) << info.output;
  for (const char* column : {"us a frame", "with map", "carried"}) {
    EXPECT_NE(info.output.find(column), std::string::npos) << info.output;
  }
  EXPECT_NE(info.output.find("training frames"), std::string::npos) << info.output;
  EXPECT_NE(info.output.find("level 0 could give"), std::string::npos) << info.output;
  EXPECT_EQ(run_verb("info " + data().basis).output.find("us a frame"), std::string::npos);
}

TEST_F(Proxy, ABasisTeachesOne) {
  const std::string out = at("taught.safetensors");
  const std::string command = "proxy " + data().basis + data().clip + " --error 1 --out " + out;
  const ProgramResult taught = run_verb(command + " --character " + data().character);
  ASSERT_EQ(taught.exit_code, 0) << taught.output;
  EXPECT_EQ(load_levels(out).size(), 1u);
  // It remembers the unit: its clips are read as the basis' are.
  EXPECT_EQ(run_verb("eval " + out + data().clip + " --out " + at("b.pc2")).exit_code, 0);
  EXPECT_EQ(load_basis(out).metadata.at("character_unit_m"), load_basis(data().basis).metadata.at("character_unit_m"));
}

TEST_F(Proxy, OfABasisWithFibresItAsksForTheMuscles) {
  const TemporaryFolder folder;
  const BuiltinArm arm = build_arm();
  const auto file = [&](const char* name) { return (folder / name).string(); };
  write_character(arm.character, file("arm.glb"));
  write_muscles(arm.muscles, arm.character.skeleton, file("muscles.json"));
  write_clip(arm_heldout(arm.character.skeleton, 2), arm.character.skeleton, file("clip.glb"));
  Basis basis = build_ddm_basis(arm.character, {});
  basis.strain = make_strain_table(basis, arm.muscles);
  save_basis(basis, file("arm.safetensors"));
  // Ends at a frame that the clip lacks, before it learns anything.
  const std::string command = "proxy " + file("arm.safetensors") + " --character " + file("arm.glb") + " --clip " +
                              file("clip.glb") + " --frames 3 --out " + file("proxy.safetensors");
  const ProgramResult without = run_verb(command);
  EXPECT_EQ(without.exit_code, 64) << without.output;
  EXPECT_NE(without.output.find(std::to_string(basis.strain.fibre_count()) + " fibres"), std::string::npos)
      << without.output;
  const ProgramResult with = run_verb(command + " --muscles " + file("muscles.json"));
  EXPECT_EQ(with.exit_code, 64) << with.output;
  EXPECT_EQ(with.output.find("fibres"), std::string::npos) << with.output;
}

TEST_F(Proxy, WrongArgumentsAreSaid) {
  const auto expect = [](const std::string& command, int code, const std::string& named) {
    const ProgramResult run = run_verb(command);
    EXPECT_EQ(run.exit_code, code) << command << "\n" << run.output;
    EXPECT_NE(run.output.find(named), std::string::npos) << run.output;
  };
  const std::string out = " --out " + at("never.safetensors");
  expect("proxy " + data().basis + out, 64, "--character");
  expect("proxy " + data().basis + out + " --character " + data().character, 64, "--clip");
  expect("proxy " + data().data + out + data().clip, 64, "a dataset");
  expect("proxy " + data().data + out + " --frames 1-20", 64, "--clip");
  expect("proxy " + data().data + out + " --fps 30", 64, "--clip");
  expect("proxy " + data().data + out + " --error 300", 64, "300 mm leaves");
  expect("proxy " + data().basis + data().clip + " --character " + data().character + " --out " + data().basis, 64,
         "write over");
  expect("proxy " + data().data + " --out " + at("never.glb"), 64, ".safetensors");
  expect("eval " + data().proxy + data().clip + " --level 2 --out " + at("a.pc2"), 64, "levels 0 to 1");
  expect("eval " + data().basis + data().clip + " --full-skin --out " + at("a.pc2"), 64, "no proxy");
  EXPECT_FALSE(std::filesystem::exists(at("never.safetensors")));
}

}  // namespace
}  // namespace bodyopt
