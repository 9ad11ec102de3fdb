// limits.json: the shipped one, and everything that may be wrong with one.
#include "trainer/motion/joint_limits.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::trainer {
namespace {

using namespace testing;
Skeleton two_arms() {
  Skeleton skeleton;
  for (const char* name : {"chest", "left_arm", "right_arm"}) {
    Joint joint;
    joint.name = name;
    joint.parent = skeleton.size() == 0 ? -1 : 0;
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

Json small_limits() {
  return Json::parse(R"({"schema": "bodyopt-joint-limits-1", "source": "made up",
    "mirrored_joints": [{"joint": "left_arm", "mirror": "right_arm"}],
    "dofs": [{"name": "left_raise", "mirror": "right_raise", "rest": 40, "min": 0, "max": 120,
              "turns": [{"joint": "left_arm", "axis": [1, 2, 2], "share": 0.5}]}]})");
}

void read(const std::filesystem::path& path) { read_joint_limits(path, two_arms()); }

TEST(JointLimitsFile, MirrorsAcrossTheMiddle) {
  const TemporaryFolder folder;
  write_bytes(folder / "limits.json", small_limits().dump());
  const JointLimits limits = read_joint_limits(folder / "limits.json", two_arms());
  ASSERT_EQ(limits.dofs.size(), 2u);
  EXPECT_EQ(limits.dofs[1].name, "right_raise");
  EXPECT_EQ(limits.dofs[1].min, 0);
  EXPECT_EQ(limits.dofs[1].max, 120);
  EXPECT_EQ(limits.dofs[0].turns[0].joint, 1u);
  EXPECT_EQ(limits.dofs[1].turns[0].joint, 2u);
  EXPECT_EQ(limits.dofs[1].turns[0].share, 0.5);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(limits.dofs[0].turns[0].axis[i], (i == 0 ? 1.0 : 2.0) / 3, 1e-15);
    EXPECT_NEAR(limits.dofs[1].turns[0].axis[i], (i == 0 ? 1.0 : -2.0) / 3, 1e-15);
  }
}

// As small_limits(), with all that a range of motion needs beside.
Json whole_limits() {
  Json limits = small_limits();
  limits["dofs"].push_back(Json::parse(
      R"({"name": "turn", "rest": 10, "min": -50, "max": 60, "turns": [{"joint": "chest", "axis": [0, 1, 0]}]})"));
  limits["deviations"] = Json::parse(R"([{"joint": "right_arm", "degrees": 30, "source": "own"}])");
  limits["poses"] = Json::parse(R"([{"name": "both", "source": "own", "angles": {"left_raise": 90}},
                                    {"name": "one", "angles": {"left_raise": 90, "right_raise": 20, "turn": 30}}])");
  return limits;
}

TEST(JointLimitsFile, DeviationsAndPosesHaveMirrorImages) {
  const TemporaryFolder folder;
  write_bytes(folder / "limits.json", whole_limits().dump());
  const JointLimits limits = read_joint_limits(folder / "limits.json", two_arms());
  std::map<std::uint32_t, double> deviations;
  for (const JointDeviation& deviation : limits.deviations) deviations[deviation.joint] = deviation.degrees;
  EXPECT_EQ(deviations, (std::map<std::uint32_t, double>{{0, kUsualDeviation}, {1, 30}, {2, 30}}));
  ASSERT_EQ(limits.poses.size(), 3u);  // the first is its own mirror image
  using Angles = std::vector<double>;
  EXPECT_EQ(limits.poses[0].angles, (Angles{90, 90, 10}));
  EXPECT_EQ(limits.poses[1].angles, (Angles{90, 20, 30}));
  EXPECT_EQ(limits.poses[2].name, "one, mirrored");
  EXPECT_EQ(limits.poses[2].angles, (Angles{20, 90, -10}));
}

TEST(JointLimitsFile, NoDegreesAreNoDeviation) {
  const TemporaryFolder folder;
  Json limits = whole_limits();
  limits["deviations"] = Json::parse(R"([{"joint": "left_arm", "degrees": 0}, {"joint": "right_arm", "degrees": 5}])");
  write_bytes(folder / "limits.json", limits.dump());
  const JointLimits read = read_joint_limits(folder / "limits.json", two_arms());
  ASSERT_EQ(read.deviations.size(), 2u);
  EXPECT_EQ(read.deviations[0].joint, 0u);
  EXPECT_EQ(read.deviations[1].joint, 2u);
  EXPECT_EQ(read.deviations[1].degrees, 5);
}

TEST(JointLimitsFile, RoundTrip) {
  const TemporaryFolder folder;
  write_bytes(folder / "limits.json", whole_limits().dump());
  const JointLimits limits = read_joint_limits(folder / "limits.json", two_arms());
  write_joint_limits(limits, two_arms(), folder / "again.json");
  const JointLimits again = read_joint_limits(folder / "again.json", two_arms());
  ASSERT_EQ(again.dofs.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    const DegreeOfFreedom &a = limits.dofs[k], &b = again.dofs[k];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.rest, b.rest);
    EXPECT_EQ(a.min, b.min);
    EXPECT_EQ(a.max, b.max);
    ASSERT_EQ(b.turns.size(), 1u);
    EXPECT_EQ(a.turns[0].joint, b.turns[0].joint);
    EXPECT_EQ(a.turns[0].share, b.turns[0].share);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a.turns[0].axis[i], b.turns[0].axis[i], 1e-15);
  }
  ASSERT_EQ(again.deviations.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(again.deviations[k].joint, limits.deviations[k].joint);
    EXPECT_EQ(again.deviations[k].degrees, limits.deviations[k].degrees);
  }
  ASSERT_EQ(again.poses.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(again.poses[k].angles, limits.poses[k].angles);
}

TEST(JointLimitsFile, RefusesEachMistakeByName) {
  const TemporaryFolder folder;
  const auto refused = [&](const char* pointer, const Json& value, const std::string& named, ErrorKind kind) {
    Json json = whole_limits();
    json[Json::json_pointer(pointer)] = value;
    write_bytes(folder / "limits.json", json.dump());
    try {
      read(folder / "limits.json");
      ADD_FAILURE() << pointer << " was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), kind) << error.what();
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("limits.json"), std::string::npos) << error.what();
    }
  };
  const ErrorKind file = ErrorKind::file, mismatch = ErrorKind::mismatch;
  refused("/dofs/0/turns/0/joint", "tail", "'tail'", mismatch);
  refused("/mirrored_joints/0/mirror", "tail", "'tail'", mismatch);
  refused("/dofs/0/rest", 121, "left_arm", mismatch);
  refused("/dofs/0/rest", -1, "excludes the character's rest pose", mismatch);
  refused("/dofs/0/min", 130, "left_arm", file);
  refused("/dofs/0/min", 120, "left_arm", file);
  refused("/dofs/0/turns/0/axis", {0, 0, 0}, "left_arm", file);
  refused("/dofs/0/turns/0/axis", {1, 0}, "left_arm", file);
  refused("/dofs/0/turns/0/axis", {1, 0, nullptr}, "left_arm", file);
  refused("/dofs/0/turns/0/axis", {1e300, 0, 0}, "left_arm", file);
  refused("/dofs/0/turns/0/share", 100, "share", file);
  refused("/dofs/0/turns", Json::array(), "left_raise", file);
  refused("/dofs/0/max", 1e9, "max", file);
  refused("/dofs/0/max", "120", "max", file);
  refused("/dofs/0/mirror", "left_raise", "left_raise", file);
  refused("/dofs/0/rests", 0, "rests", file);
  refused("/dofs", Json::array(), "dofs", file);
  refused("/mirrored_joints", Json::array(), "mirrored_joints", file);
  refused("/deviations/0/joint", "tail", "'tail'", mismatch);
  refused("/deviations/0/degrees", 181, "degrees", file);
  refused("/deviations/1", {{"joint", "right_arm"}, {"degrees", 1}}, "right_arm", file);
  refused("/poses/0/angles/left_raise", 130, "left_raise", file);
  refused("/poses/0/angles/tail", 1, "'tail', which is no degree of freedom", file);
  refused("/poses/0/angles", 3, "no object 'angles'", file);
  refused("/schema", "bodyopt-joint-limits-2", "schema", file);
}

TEST(JointLimitsFile, RefusesDamage) {
  const TemporaryFolder folder;
  const std::string text = small_limits().dump();
  expect_every_truncation_refused(read, folder / "limits.json", text);
  damage_bytes(read, folder / "limits.json", text, 1000);
  for (const char* bad : {"NaN", "Infinity", "1e999", "-nan"}) {
    std::string broken = text;
    broken.replace(broken.find("120"), 3, bad);
    expect_refused(read, folder / "limits.json", broken, "limits.json");
  }
  EXPECT_TRUE(refuses(read, folder / "none.json", "a missing file"));
}

}  // namespace
}  // namespace bodyopt::trainer
