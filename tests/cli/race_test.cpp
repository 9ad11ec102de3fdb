// Several processes that change one file at once: nothing of any is lost.
#include <gtest/gtest.h>

#include <memory>

#include "assets/caches/pc2.h"
#include "dataset/dataset.h"
#include "runtime/basis/attachments.h"
#include "tests/cli/limb_files.h"
#include "tests/support/background_program.h"
#include "tests/support/limb_glb.h"
#include "tests/support/paths.h"
#include "tests/support/run_verb.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
namespace {

using namespace trainer;

constexpr int kRounds = 2, kProcesses = 8;

// Runs them at once; every one must say that it is done.
void run_together(const TemporaryFolder& folder, const std::vector<std::string>& commands) {
  std::vector<std::unique_ptr<BackgroundProgram>> programs;
  for (std::size_t k = 0; k < commands.size(); ++k) {
    programs.push_back(
        std::make_unique<BackgroundProgram>(kProgram + " " + commands[k], folder / ("said_" + std::to_string(k))));
  }
  for (const auto& program : programs) EXPECT_EQ(program->wait(60), 0) << program->output();
}

// A limb, and shapes of a clip that bends it.
class Race : public ::testing::Test {
 protected:
  Race() : files_(folder_, 1) {
    const Character limb = read_character(files_.character);
    Pc2Writer writer(at("all.pc2"), limb.output_count(), 6);
    for (const Pose& pose : read_clip(files_.motion, limb.skeleton, {}).poses) {
      writer.append(output_from_welded(limb, skin_linear(limb, pose)));
    }
    writer.close();
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  TemporaryFolder folder_;
  LimbFiles files_;
};

TEST_F(Race, NoTakeIsLost) {
  for (int round = 0; round < kRounds; ++round) {
    const std::string data = at("data" + std::to_string(round));
    std::vector<std::string> commands;
    for (int k = 0; k < kProcesses; ++k) {
      commands.push_back("dataset add " + data + " --clip " + files_.motion + " --shapes " + at("all.pc2") +
                         " --character " + files_.character + " --name take" + std::to_string(k));
    }
    run_together(folder_, commands);
    EXPECT_EQ(read_dataset(data + "/dataset.json").takes.size(), std::size_t{kProcesses});
  }
}

// Of shapes that are solved already, so that all are done at the same time.
TEST_F(Race, NoSimulatedTakeIsLost) {
  std::vector<std::string> commands;
  for (int k = 0; k < kProcesses; ++k) {
    commands.push_back("simulate " + files_.character + " --clip " + files_.motion +
                       " --draft --threads 1 --frames 1-2 --out " + at("data") + " --name take" + std::to_string(k));
  }
  ASSERT_EQ(run_verb(commands[0]).exit_code, 0);
  for (int k = 1; k < kProcesses; ++k) {
    for (const char* ending : {".nodes", ".status.json"}) {
      std::filesystem::copy_file(at("data/take0") + ending, at("data/take" + std::to_string(k)) + ending);
    }
  }
  for (int round = 0; round < kRounds; ++round) {
    std::filesystem::remove(at("data/dataset.json"));
    run_together(folder_, commands);
    EXPECT_EQ(read_dataset(at("data/dataset.json")).takes.size(), std::size_t{kProcesses});
  }
  EXPECT_EQ(run_verb("check " + at("data")).exit_code, 0);
}

TEST_F(Race, NoAttachedMeshIsLost) {
  write_character(limb_character(), at("capsule.glb"));
  ASSERT_EQ(run_verb("train --ddm-only " + at("capsule.glb") + " --out " + at("capsule.safetensors")).exit_code, 0);
  for (int k = 0; k < kProcesses; ++k) {
    const std::string name = "bead" + std::to_string(k);
    LimbGlb blob(at("scratch.glb"));
    blob.root["nodes"].clear();
    blob.root.erase("skins");
    blob.add_node(name, blob.add_mesh(sphere_at(name, {0.05, 0, 0.1 + 0.01 * k}, 0.004)), -1);
    put_bytes(at(name + ".glb"), blob.glb());
  }
  for (int round = 0; round < kRounds; ++round) {
    const std::string out = at("round" + std::to_string(round) + ".safetensors");
    std::vector<std::string> commands;
    for (int k = 0; k < kProcesses; ++k) {
      commands.push_back("attach " + at("bead" + std::to_string(k) + ".glb") + " " + at("capsule.safetensors") +
                         " --joint joint0 --out " + out);
    }
    run_together(folder_, commands);
    EXPECT_EQ(load_attachments(out).meshes.size(), std::size_t{kProcesses});
  }
}

}  // namespace
}  // namespace bodyopt
