// Models carried to characters: identities, mirroring, points under the skin, what does not belong together.
#include "trainer/muscle_models/fit.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "geometry/thickness.h"
#include "runtime/core/error.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/paths.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::trainer::muscle_models {
namespace {

using namespace testing;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// A cube of half size 1 m about the origin, each face two triangles; joints named "hip", "RightKnee", "LeftKnee".
Character cube() {
  Character character;
  character.name = "cube";
  character.vertices.resize(8, 3);
  for (int v = 0; v < 8; ++v) character.vertices.row(v) << (v & 1 ? 1 : -1), (v & 2 ? 1 : -1), (v & 4 ? 1 : -1);
  character.triangles.resize(12, 3);
  character.triangles << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3,
      5, 3, 7, 5;
  for (const auto& [name, position] :
       std::initializer_list<std::pair<const char*, Vec3>>{{"hip", {0, 0.5, 0}},
                                                           {"RightHip", {-0.2, 0.5, 0}},
                                                           {"RightKnee", {-0.2, -0.3, 0}},
                                                           {"LeftHip", {0.2, 0.5, 0}},
                                                           {"LeftKnee", {0.2, -0.3, 0}}}) {
    Joint joint;
    joint.name = name;
    for (int i = 0; i < 3; ++i) joint.inverse_bind.m[i][3] = -position[static_cast<std::size_t>(i)];
    character.skeleton.joints.push_back(joint);
  }
  return character;
}

// A right leg whose joints stand where the cube's do; y up, z forward.
Model leg() {
  Model model;
  model.file = "leg.osim";
  model.segments.resize(3);
  model.segments[0].name = "ground";
  model.segments[1].name = "thigh";
  model.segments[1].parent = 0;
  model.segments[1].before = Eigen::Translation3d(-0.2, 0.5, 0);
  model.segments[2].name = "shank";
  model.segments[2].parent = 1;
  model.segments[2].before = Eigen::Translation3d(0, -0.8, 0);
  ModelMuscle muscle{"vastus", 600, {}, {}};
  for (const auto& [segment, position] : std::initializer_list<std::pair<int, Vector3d>>{
           {1, {0.05, -0.1, 0.1}}, {1, {0, -0.6, 0.12}}, {2, {-0.01, -0.1, 0.06}}}) {
    PathPoint point;
    point.segment = segment;
    point.position = position;
    muscle.path.push_back(point);
  }
  model.muscles.push_back(muscle);
  return model;
}

Mapping leg_mapping() {
  Mapping mapping;
  mapping.file = "leg.json";
  mapping.model_axes << Vector3d::UnitY(), Vector3d::UnitZ(), Vector3d::UnitX();
  mapping.character_axes = mapping.model_axes;
  const std::vector<NamePair> centres = {{"thigh", "RightHip"}, {"shank", "RightKnee"}};
  mapping.segments = {{{"thigh"}, "RightHip", centres}, {{"shank"}, "RightKnee", centres}};
  return mapping;
}

Vector3d at(const FittedMuscle& fitted, std::size_t k) { return Vector3d::Map(fitted.muscle.path[k].position.data()); }

TEST(Align, TakesPointsExactlyAndKeepsTheTurnTheyLeaveOpen) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto any = [&] { return Vector3d(normal(random), normal(random), normal(random)); };
  const Matrix3d turn = Eigen::AngleAxisd(2.1, any().normalized()).toRotationMatrix();
  for (const std::size_t count : {2, 3, 4}) {
    std::vector<Vector3d> from, to;
    for (std::size_t k = 0; k < count; ++k) from.push_back(any()), to.push_back(any());
    const Alignment alignment = align(from, to, turn);
    for (std::size_t k = 0; k < count; ++k) EXPECT_LT((alignment.map * from[k] - to[k]).norm(), 1e-10) << count;
  }
  // A similarity comes back from any number of its points; from two with the turn it was made with.
  for (const std::size_t count : {2, 3, 5}) {
    std::vector<Vector3d> from, to;
    const Vector3d shift = any(), probe = any();
    for (std::size_t k = 0; k < count; ++k) {
      from.push_back(any());
      to.push_back(1.7 * turn * from.back() + shift);
    }
    const Alignment alignment = align(from, to, turn);
    EXPECT_LT((alignment.map * probe - (1.7 * turn * probe + shift)).norm(), 1e-9) << count;
    EXPECT_LT((alignment.turn - turn).norm(), 1e-9);
    EXPECT_NEAR(alignment.scale, 1.7, 1e-9);
  }
}

TEST(SkinDepth, OfACubeIsTheDistanceToItsFaces) {
  const Character character = cube();
  const SkinDepth depth(character.vertices, character.triangles);
  EXPECT_NEAR(depth({0, 0, 0}), 1, 1e-12);
  EXPECT_NEAR(depth({0.25, 0.5, 0}), 0.5, 1e-12);
  EXPECT_NEAR(depth({0, 3, 0}), -2, 1e-12);
  EXPECT_EQ(depth.tuck({0.1, 0.2, 0.3}, 0.5), Vector3d(0.1, 0.2, 0.3));
  EXPECT_LT((*depth.tuck({0.2, 0.9, 0}, 0.25) - Vector3d(0.2, 0.75, 0)).norm(), 1e-12);
  EXPECT_LT((*depth.tuck({0.2, 1.9, 0}, 0.25) - Vector3d(0.2, 0.75, 0)).norm(), 1e-12);
  EXPECT_LT((*depth.tuck({0.2, 1, 0.1}, 0.25) - Vector3d(0.2, 0.75, 0.1)).norm(), 1e-12) << "on the skin itself";
}

TEST(SkinDepth, ASkinThatIsInsideOutHasTheSameInside) {
  Character character = cube();
  character.triangles.col(1).swap(character.triangles.col(2));
  const SkinDepth depth(character.vertices, character.triangles);
  EXPECT_NEAR(depth({0.25, 0.5, 0}), 0.5, 1e-12);
  EXPECT_NEAR(depth({0, 3, 0}), -2, 1e-12);
}

TEST(Fit, AModelWithTheCharactersJointsStaysWhereItIs) {
  const Model model = leg();
  const std::vector<FittedMuscle> fitted = fit_muscles(model, leg_mapping(), cube());
  ASSERT_EQ(fitted.size(), 1u);
  const std::vector<PathStop> stops = trace_path(model.muscles[0], pose_model(model, {}));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT((at(fitted[0], k) - stops[k].position).norm(), 1e-12);
  EXPECT_EQ(fitted[0].muscle.path[0].joint, 1u);
  EXPECT_EQ(fitted[0].muscle.path[2].joint, 2u);
  EXPECT_LT(fitted[0].largest_push, 1e-12);
  // 600 N at 60 N/cm2 are 10 cm2.
  EXPECT_NEAR(fitted[0].muscle.radius, std::sqrt(1e-3 / std::numbers::pi), 1e-12);
}

TEST(Fit, TheOtherSideIsTheMirrorImageAndItsMirrorImageIsTheFirst) {
  const Character character = cube();
  Mapping mapping = leg_mapping();
  mapping.mirror_joints = {{"Right", "Left"}};
  mapping.mirror_muscles = {"_r", "_l"};
  const std::vector<FittedMuscle> both = fit_muscles(leg(), mapping, character);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[0].muscle.name, "vastus_r");
  EXPECT_EQ(both[1].muscle.name, "vastus_l");
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT((at(both[1], k).cwiseProduct(Vector3d(-1, 1, 1)) - at(both[0], k)).norm(), 1e-12) << k;
  }
  EXPECT_EQ(character.skeleton.joints[both[1].muscle.path[0].joint].name, "LeftHip");

  // The same leg said to be a left one lies mirrored; mirrored again it is where it was.
  Mapping other = mapping;
  for (SegmentMap& map : other.segments) {
    map.joint = mapping.mirrored_joint(map.joint);
    for (NamePair& centre : map.centres) centre[1] = mapping.mirrored_joint(centre[1]);
  }
  other.mirror_joints = {{"Left", "Right"}};
  Model mirrored = leg();
  mirrored.segments[1].before.translation().x() *= -1;
  for (PathPoint& point : mirrored.muscles[0].path) point.position.x() *= -1;
  const std::vector<FittedMuscle> again = fit_muscles(mirrored, other, character);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT((at(again[1], k) - at(both[0], k)).norm(), 1e-12) << k;
    EXPECT_LT((at(again[0], k) - at(both[1], k)).norm(), 1e-12) << k;
  }
}

TEST(Fit, PointsOutsideArePushedUnderTheSkinAndBelliesMadeToFit) {
  const Character character = cube();
  const SkinDepth depth(character.vertices, character.triangles);
  Model model = leg();
  for (PathPoint& point : model.muscles[0].path) point.position.z() += 1;
  model.muscles[0].max_force = 60000;
  const FittedMuscle fitted = fit_muscles(model, leg_mapping(), character)[0];
  for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(depth(at(fitted, k)), 0.0039) << k;
  EXPECT_GT(fitted.largest_push, 0.1);
  EXPECT_LT(fitted.muscle.radius, fitted.full_radius);
}

TEST(Fit, WhatDoesNotBelongTogetherIsNamed) {
  const Character character = cube();
  const auto expect = [&](const Model& model, const Mapping& mapping, const std::string& named) {
    try {
      fit_muscles(model, mapping, character);
      ADD_FAILURE() << "not refused: " << named;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), 3);
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
    }
  };
  Mapping mapping = leg_mapping();
  mapping.segments[1].joint = "Tail";
  expect(leg(), mapping, "'Tail'");
  mapping = leg_mapping();
  mapping.segments[0].segments = {"wing"};
  expect(leg(), mapping, "'wing'");
  mapping = leg_mapping();
  mapping.segments.pop_back();
  expect(leg(), mapping, "'shank'");
  mapping = leg_mapping();
  mapping.leave_out = {"gluteus"};
  expect(leg(), mapping, "'gluteus'");
  mapping = leg_mapping();
  mapping.segments[0].centres[1] = mapping.segments[0].centres[0];
  expect(leg(), mapping, "the segments 'thigh' and 'thigh' of leg.osim");
  mapping = leg_mapping();
  mapping.segments[0].centres[1][1] = "RightHip";
  expect(leg(), mapping, "the joints 'RightHip' and 'RightHip' of the character 'cube'");
  expect(leg(), mapping, "name two that are apart");
  mapping = leg_mapping();
  mapping.segments[1].segments.push_back("thigh");
  expect(leg(), mapping, "twice");
  Model model = leg();
  for (PathPoint& point : model.muscles[0].path) point = model.muscles[0].path[0];
  expect(model, leg_mapping(), "'vastus'");
  model = leg();
  model.muscles[0].max_force = 0;
  expect(model, leg_mapping(), "no largest force");
}

TEST(MappingFile, HostileBytesAreRefusedAndWhatIsWrongNamed) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "mapping.json";
  const std::string good = R"({"schema": "bodyopt-muscle-mapping-1", "model_up": "+z", "model_forward": "-y",
    "character_up": "+y", "character_forward": "+z", "leave_out": ["a"],
    "segments": [{"segments": ["thigh"], "joint": "RightHip", "centres": [["thigh", "RightHip"], ["shank", "RightKnee"]]}],
    "mirror_joints": [["Right", "Left"]], "mirror_muscles": ["_r", "_l"]})";
  const Reader read = [](const std::filesystem::path& file) { read_mapping(file); };
  write_bytes(path, good);
  const Mapping mapping = read_mapping(path);
  EXPECT_EQ(mapping.model_axes.col(1), -Vector3d::UnitY());
  EXPECT_EQ(mapping.mirrored_joint("RightKnee"), "LeftKnee");
  EXPECT_EQ(mapping.mirrored_joint("Spine"), "Spine");
  expect_every_truncation_refused(read, path, good);
  damage_bytes(read, path, good, 500);
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& named) {
    std::string text = good;
    expect_refused(read, path, text.replace(text.find(from), from.size(), to), named);
  };
  expect("\"+z\"", "\"up\"", "model_up");
  expect("\"-y\"", "\"-z\"", "the same axis");
  expect(", [\"shank\", \"RightKnee\"]", "", "fewer than two");
  expect("[\"thigh\"]", "[]", "'segments' is empty");
  expect("[\"thigh\"]", "[3]", "list of names");
  expect("\"_l\"", "\"_r\"", "equal endings");
  expect("\"joint\"", "\"joints\"", "joints");
}

// The shipped mappings: every muscle of the models on the shared human, under its skin, on the right side.
TEST(HumanMappings, GiveTheHumanItsMuscles) {
  const auto human = shared_data("characters/human_muscular.glb");
  if (!human) GTEST_SKIP() << kNeedsRealBodies;
  const Character character = read_character(*human);
  const SkinDepth depth(character.vertices, character.triangles);
  const std::string rigs = kSourceFolder + "/rigs/human/";
  std::size_t count = 0;
  for (const auto& [file, mapping, muscles] :
       {std::tuple("opensim/gait2392_thelen2003muscle.osim", "gait2392.json", 92),
        std::tuple("myo_sim/leg/myolegs.xml", "myo_leg.json", 80),
        std::tuple("myo_sim/arm/myoarm.xml", "myo_arm.json", 100)}) {
    const std::vector<FittedMuscle> fitted =
        fit_muscles(read_model(*shared_data(std::string("muscles/") + file)), read_mapping(rigs + mapping), character);
    EXPECT_EQ(fitted.size(), static_cast<std::size_t>(muscles)) << mapping;
    for (const FittedMuscle& muscle : fitted) {
      const double side = muscle.muscle.name.ends_with("_l") ? 1 : -1;  // the left is +x
      for (std::size_t k = 0; k < muscle.muscle.path.size(); ++k) {
        EXPECT_GT(depth(at(muscle, k)), 0) << muscle.muscle.name;
        EXPECT_GT(side * at(muscle, k).x(), -0.02) << muscle.muscle.name;
      }
    }
    count += fitted.size();
  }
  EXPECT_GE(count, 100u);
}

}  // namespace
}  // namespace bodyopt::trainer::muscle_models
