// bodyopt transfer, as it is run.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "assets/clips/clip.h"
#include "runtime/basis/basis.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/json.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/page_contents.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"
#include "tests/support/temporary_folder.h"
#include "tests/transfer/limb_dataset.h"
#include "tests/viewport/twin_level.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/transfer/markers_file.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::trainer {
namespace {

class TransferProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    write_character(limb_character(), path("limb.glb"));
    save_basis(build_ddm_basis(limb_character(), {}), path("limb.safetensors"));
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ProgramResult transfer(const std::string& targets_and_options) const {
    return run_verb("transfer basis " + path("limb.safetensors") + " " + targets_and_options);
  }

  TemporaryFolder folder_;
};

TEST_F(TransferProgram, WritesABasisForEveryTarget) {
  const ProgramResult result = transfer(path("limb.glb") + " " + path("limb.glb") + " --out " + path("a.safetensors") +
                                        " " + path("b.safetensors"));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(load_basis(path("a.safetensors")).mesh.rest, load_basis(path("b.safetensors")).mesh.rest);
}

TEST_F(TransferProgram, WhatStandsBesideTheBasisGoesWithIt) {
  const Basis source = load_basis(path("limb.safetensors"));
  save_levels({testing::twin(source)}, path("limb.proxy.safetensors"));
  const ProgramResult made = run_verb("dynamics " + path("limb.glb") + " --basis " + path("limb.safetensors") +
                                      " --dynamics-resolution 800 --out " + path("limb.dynamics.safetensors"));
  ASSERT_EQ(made.exit_code, 0) << made.output;
  const ProgramResult result = transfer(path("limb.glb") + " --out " + path("a.safetensors"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Basis carried = load_basis(path("a.safetensors"));
  EXPECT_EQ(load_levels(path("a.proxy.safetensors")).front().carried.size(), carried.mesh.output_count());
  EXPECT_GT(load_dynamics(path("a.dynamics.safetensors"), carried).tets.tet_count(), 0u);
  ASSERT_EQ(transfer(path("limb.glb") + " --alone --out " + path("b.safetensors")).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("b.proxy.safetensors")));
  EXPECT_FALSE(std::filesystem::exists(path("b.dynamics.safetensors")));
  EXPECT_EQ(transfer(path("limb.glb") + " --alone --proxy x --out " + path("b.safetensors")).exit_code, 64);
}

TEST_F(TransferProgram, ADatasetInPlaceOfABasisIsCalledOne) {
  testing::write_limb_dataset(folder_ / "source", 4);
  for (const char* dataset : {"source", "source/dataset.json"}) {
    const ProgramResult result =
        run_verb("transfer basis " + path(dataset) + " " + path("limb.glb") + " --out " + path("a.safetensors"));
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_NE(result.output.find("is a dataset"), std::string::npos) << result.output;
    EXPECT_NE(result.output.find("'bodyopt transfer dataset'"), std::string::npos) << result.output;
  }
}

TEST_F(TransferProgram, AProxyIsASourceWithAllOfItsLevels) {
  const Basis source = load_basis(path("limb.safetensors"));
  save_levels({testing::twin(source), testing::twin(source)}, path("twins.safetensors"));
  const ProgramResult result =
      run_verb("transfer basis " + path("twins.safetensors") + " " + path("limb.glb") + " --out " +
               path("a.safetensors") + " --json " + path("r.json") + " --report " + path("r.html"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const std::vector<Level> carried = load_levels(path("a.safetensors"));
  ASSERT_EQ(carried.size(), 2u);
  for (const Level& level : carried) EXPECT_EQ(level.carried.size(), source.mesh.output_count());
  const auto told = Json::parse(std::ifstream(path("r.json"))).at("targets").at(0);
  EXPECT_EQ(told.at("levels").get<int>(), 2);
}

TEST_F(TransferProgram, TheReportSaysWhereBodiesDiffer) {
  Character other = limb_character();
  for (Eigen::Index v = 0; v < other.vertices.rows(); ++v) {  // the far half is six times as thick
    if (other.vertices(v, 2) > other.skeleton.joints[1].bind.translation[2] + 0.02) other.vertices.row(v).head(2) *= 6;
  }
  write_character(other, path("other.glb"));
  Clip clip;
  clip.poses.assign(4, bind_pose(other.skeleton));
  clip.poses[2].joints[1].rotation = axis_angle({1, 0, 0}, 0.8);
  write_clip(clip, other.skeleton, path("bend.glb"));
  const ProgramResult result = transfer(path("other.glb") + " --out " + path("a.safetensors") + " --report " +
                                        path("r.html") + " --clip " + path("bend.glb") + " --json " + path("r.json"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto told = Json::parse(std::ifstream(path("r.json"))).at("targets").at(0);
  ASSERT_EQ(told.at("parts").size(), 3u);
  EXPECT_EQ(told.at("poses").size(), 4u);
  EXPECT_NEAR(told.at("poses").at(0).at("target_volume").get<double>(), 1, 1e-4);
  EXPECT_TRUE(std::any_of(told.at("parts").begin(), told.at("parts").end(),
                          [](const auto& part) { return part.at("breaks_assumption").template get<bool>(); }));
  const ProgramResult alike = transfer(path("limb.glb") + " --out " + path("a.safetensors") + " --report " +
                                       path("r.html") + " --json " + path("r.json"));
  ASSERT_EQ(alike.exit_code, 0) << alike.output;
  const auto parts = Json::parse(std::ifstream(path("r.json"))).at("targets").at(0).at("parts");
  for (const auto& part : parts) {
    EXPECT_FALSE(part.at("breaks_assumption").get<bool>()) << part;
    EXPECT_NEAR(part.at("size").get<double>(), 1, 1e-6);
  }
}

// All that the report tells of a trained basis: what it expects to be wrong by, and what is worth simulating.
TEST_F(TransferProgram, ATrainedBasisKnowsOnAnotherBodyWhatItDoesNotKnow) {
  testing::write_limb_dataset(folder_ / "data", 40);
  const ProgramResult trained = run_verb("train " + path("data") + " --out " + path("trained.safetensors"));
  ASSERT_EQ(trained.exit_code, 0) << trained.output;
  Character thick = limb_character();
  thick.vertices.leftCols<2>() *= 1.3;
  write_character(thick, path("thick.glb"));
  const ProgramResult result = run_verb("transfer basis " + path("trained.safetensors") + " " + path("thick.glb") +
                                        " --out " + path("a.safetensors") + " --report " + path("r.html") + " --clip " +
                                        path("data/bend.glb") + " --frames 1-40x3 --json " + path("r.json"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Basis source = load_basis(path("trained.safetensors")), carried = load_basis(path("a.safetensors"));
  EXPECT_EQ(carried.residual.coefficient_count(), source.residual.coefficient_count());
  EXPECT_FALSE(carried.residual.blend.empty());
  const auto told = Json::parse(std::ifstream(path("r.json"))).at("targets").at(0);
  ASSERT_EQ(told.at("poses").size(), 14u);
  for (const auto& pose : told.at("poses")) EXPECT_GT(pose.at("expected_rms_mm").get<double>(), 0) << pose;
  const std::string frames = told.at("worth_simulating").get<std::string>();
  EXPECT_FALSE(frames.empty());
  const auto contents = testing::page_contents(path("r.html"));
  EXPECT_EQ(contents.at("kind"), "transfer");
  EXPECT_EQ(contents.at("figures").at("targets").at(0), told);
  EXPECT_EQ(std::count_if(told.at("poses").begin(), told.at("poses").end(),
                          [](const auto& pose) { return pose.at("is_shown").template get<bool>(); }),
            3);
  for (const char* picture : {"match", "poses"}) {
    EXPECT_TRUE(contents.at("pictures").at(0).at(picture).contains("src")) << picture;
  }
}

// The others, the report and the JSON are finished; then the first failure is told.
TEST_F(TransferProgram, ATargetThatFailsDoesNotTakeTheOthersAlong) {
  Character stranger = limb_character();
  for (Joint& joint : stranger.skeleton.joints) joint.name = "bone" + joint.name;
  write_character(stranger, path("stranger.glb"));
  const ProgramResult result =
      transfer(path("stranger.glb") + " " + path("limb.glb") + " --out " + path("a.safetensors") + " " +
               path("b.safetensors") + " --report " + path("r.html") + " --json " + path("r.json"));
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_FALSE(std::filesystem::exists(path("a.safetensors")));
  EXPECT_TRUE(std::filesystem::exists(path("b.safetensors")));
  const auto pictures = testing::page_contents(path("r.html")).at("pictures");
  ASSERT_EQ(pictures.size(), 2u);  // as many as targets
  EXPECT_TRUE(pictures.at(0).empty());
  EXPECT_TRUE(pictures.at(1).contains("match"));
  const auto told = Json::parse(std::ifstream(path("r.json"))).at("targets");
  ASSERT_EQ(told.size(), 2u);
  EXPECT_NE(told.at(0).at("error").get<std::string>().find("in common"), std::string::npos);
  EXPECT_EQ(told.at(1).at("basis").get<std::string>(), path("b.safetensors"));
}

TEST_F(TransferProgram, RefusesBeforeAnyWorkWhatWouldFailAfterIt) {
  Clip clip;
  clip.poses.assign(3, bind_pose(limb_skeleton()));
  write_clip(clip, limb_skeleton(), path("still.glb"));
  const std::string one = path("limb.glb") + " --out " + path("a.safetensors"),
                    report = one + " --report " + path("r.html");
  const auto expect = [&](int code, const std::string& arguments, const std::string& told) {
    const ProgramResult result = transfer(arguments);
    EXPECT_EQ(result.exit_code, code) << arguments << "\n" << result.output;
    EXPECT_NE(result.output.find(told), std::string::npos) << result.output;
    EXPECT_FALSE(std::filesystem::exists(path("a.safetensors"))) << arguments;
  };
  expect(64,
         path("limb.glb") + " " + path("limb.glb") + " --out " + path("a.safetensors") + " " + path("./a.safetensors"),
         "twice");
  expect(64, one + " --frames 1-2", "--clip");
  expect(64, report + " --clip " + path("still.glb") + " --frames 2-9", "1-3");
  expect(4, report + " --clip " + path("none.glb"), "none.glb");
  expect(4, one + " --picture " + path("none/match.png"), "match.png");
  expect(4, one + " --report " + path("none/r.html"), "r.html");
}

TEST_F(TransferProgram, NotesSayWhichTargetTheyAreOfAndAllJointsAreListed) {
  Character more = limb_character();
  for (int k = 0; k < 30; ++k) {
    Joint joint = more.skeleton.joints[2];
    joint.name = "finger" + std::to_string(k);
    joint.parent = 2;
    joint.bind.translation = {0.001 * (k + 1), 0, 0.02};
    joint.default_local = joint.bind;
    joint.inverse_bind.m[0][3] = -0.001 * (k + 1);
    joint.inverse_bind.m[2][3] = -0.52;
    more.skeleton.joints.push_back(joint);
  }
  write_character(more, path("more.glb"));
  const ProgramResult result =
      transfer(path("more.glb") + " --out " + path("a.safetensors") + " --json " + path("r.json"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("more.glb: Joints of the target"), std::string::npos) << result.output;
  const auto told = Json::parse(std::ifstream(path("r.json"))).at("targets").at(0);
  EXPECT_EQ(told.at("unmatched_target_joints").size(), 30u);
  EXPECT_TRUE(told.at("unmatched_source_joints").empty());
}

TEST_F(TransferProgram, RefusesTargetsWithoutAPlaceAndStrangers) {
  EXPECT_EQ(transfer(path("limb.glb") + " " + path("limb.glb") + " --out " + path("a.safetensors")).exit_code, 64);
  Character stranger = limb_character();
  for (Joint& joint : stranger.skeleton.joints) joint.name = "bone" + joint.name;
  write_character(stranger, path("stranger.glb"));
  const ProgramResult refused = transfer(path("stranger.glb") + " --out " + path("a.safetensors"));
  EXPECT_EQ(refused.exit_code, 3) << refused.output;
  EXPECT_NE(refused.output.find("--map"), std::string::npos) << refused.output;
  EXPECT_FALSE(std::filesystem::exists(path("a.safetensors")));
}

// The skin of the one end is held by the joint of the other.
TEST_F(TransferProgram, UnlikeBodiesAreShownAndRefusedUnlessForced) {
  Character unlike = limb_character();
  for (Eigen::Index v = 0; v < unlike.vertices.rows(); ++v) {
    unlike.weights[static_cast<std::size_t>(v)] = limb_weights(kLimbLength - unlike.vertices(v, 2));
  }
  unlike.triangles.conservativeResize(unlike.triangles.rows() - 1, 3);  // other triangles: not matched by number
  unlike.output_triangles = unlike.triangles;
  write_character(unlike, path("unlike.glb"));
  const std::string arguments = path("unlike.glb") + " --out " + path("a.safetensors");
  const ProgramResult refused = transfer(arguments + " --picture " + path("match.png"));
  EXPECT_EQ(refused.exit_code, 3) << refused.output;
  EXPECT_NE(refused.output.find("--force"), std::string::npos) << refused.output;
  EXPECT_TRUE(std::filesystem::exists(path("match.png")));
  EXPECT_FALSE(std::filesystem::exists(path("a.safetensors")));
  const ProgramResult forced = transfer(arguments + " --force --json " + path("r.json"));
  EXPECT_EQ(forced.exit_code, 0) << forced.output;
  EXPECT_EQ(load_basis(path("a.safetensors")).mesh.vertex_count(), unlike.vertices.rows());
  EXPECT_LT(Json::parse(std::ifstream(path("r.json"))).at("targets").at(0).at("likeness").get<double>(),
            kLeastLikeness);
}

TEST_F(TransferProgram, RefusesMarkersThatAreNone) {
  const std::string good = R"({"schema":"bodyopt-markers-1","markers":[{"source":1,"target":2}]})";
  const auto read = [](const std::filesystem::path& file) { read_markers(file); };
  testing::write_bytes(path("markers.json"), good);
  EXPECT_EQ(read_markers(path("markers.json")).at(0).target, 2u);
  testing::expect_every_truncation_refused(read, path("markers.json"), good);
  testing::write_bytes(path("markers.json"),
                       R"({"schema":"bodyopt-markers-1","markers":[{"source":99999,"target":2}]})");
  const ProgramResult refused =
      transfer(path("limb.glb") + " --markers " + path("markers.json") + " --out " + path("a.safetensors"));
  EXPECT_EQ(refused.exit_code, 3) << refused.output;
}

}  // namespace
}  // namespace bodyopt::trainer
