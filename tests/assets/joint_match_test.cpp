#include "assets/clips/joint_match.h"

#include <gtest/gtest.h>

#include "tests/assets/gltf_blob.h"

namespace bodyopt {
namespace joint_match_test {

using Names = std::vector<std::string>;

// A chain: each joint is the parent of the next.
Skeleton chain_skeleton(const Names& names) {
  Skeleton skeleton;
  for (const std::string& name : names) {
    Joint joint;
    joint.name = name;
    joint.parent = static_cast<int>(skeleton.size()) - 1;
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

// The name of what moves each joint of the skeleton; "-" for nothing.
Names moved_by(const Names& source, const Names& target, const std::string& joint_map = "", Names* notes = nullptr) {
  const std::vector<NamedJoint> joints = named_joints(chain_skeleton(source));
  Names unused, result;
  for (const int joint :
       match_joints(joints, chain_skeleton(target), joint_map, "the clip a.bvh", notes == nullptr ? unused : *notes)) {
    result.push_back(joint < 0 ? "-" : source[static_cast<std::size_t>(joint)]);
  }
  return result;
}

const Names kArm = {"LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"};

TEST(JointMatch, EqualNamesAndNothingToSay) {
  const Names names = {"Hips", "Spine", "LeftShoulder", "LeftArm", "wing", "Tail1"};
  Names notes;
  EXPECT_EQ(moved_by(names, names, "", &notes), names);
  EXPECT_TRUE(notes.empty());
}

TEST(JointMatch, OtherConventionsByThePartOfTheBody) {
  Names notes;
  EXPECT_EQ(moved_by({"LeftCollar", "LeftShoulder", "LeftElbow", "LeftWrist"}, kArm, "", &notes),
            (Names{"LeftCollar", "LeftShoulder", "LeftElbow", "LeftWrist"}));
  EXPECT_TRUE(mentions(notes, "naming convention: 'LeftCollar' moves 'LeftShoulder', 'LeftShoulder' moves 'LeftArm'"));
  EXPECT_EQ(moved_by({"clavicle_l", "upperarm_l", "upperarm_twist_01_l", "lowerarm_l", "hand_l"}, kArm),
            (Names{"clavicle_l", "upperarm_l", "lowerarm_l", "hand_l"}));
  EXPECT_EQ(moved_by({"mixamorig:LeftHand", "mixamorig:LeftHandIndex1"}, {"LeftHand", "LeftHandFinger1"}),
            (Names{"mixamorig:LeftHand", "mixamorig:LeftHandIndex1"}));
}

// The arm of one has the name of the other's clavicle.
TEST(JointMatch, EqualNamesOfOtherPartsAreNotMatched) {
  EXPECT_EQ(moved_by({"LeftShoulder", "LeftElbow"}, kArm), (Names{"-", "LeftShoulder", "LeftElbow", "-"}));
  EXPECT_EQ(moved_by({"leftshoulder", "leftelbow"}, kArm), (Names{"-", "leftshoulder", "leftelbow", "-"}));
  EXPECT_EQ(moved_by({"lowerneck", "Neck", "Head"}, {"Neck", "Neck1", "Head"}), (Names{"lowerneck", "Neck", "Head"}));
}

// A camera's target called like a part of the body, in the character's own file.
TEST(JointMatch, WhoHasAllNamesIsMatchedByThem) {
  EXPECT_EQ(moved_by({"Head", "mixamorig:Hips", "mixamorig:Head"}, {"mixamorig:Hips", "mixamorig:Head"}),
            (Names{"mixamorig:Hips", "mixamorig:Head"}));
}

TEST(JointMatch, CaseIsSaid) {
  Names notes;
  EXPECT_EQ(moved_by({"TAIL", "Wing"}, {"tail", "Wing"}, "", &notes), (Names{"TAIL", "Wing"}));
  EXPECT_TRUE(mentions(notes, "without regard to case: 'tail'."));
}

// Arms without the trunk that they hang on; a helper is no part, and hips below a root that stays hold all together.
TEST(JointMatch, PartsThatComeApartAreSaid) {
  Skeleton skeleton = chain_skeleton({"root", "Hips", "Spine", "LeftArm", "RightArm", "ik_foot_l"});
  skeleton.joints[4].parent = 2;
  skeleton.joints[5].parent = 0;
  Names notes;
  note_parted(skeleton, {-1, 0, 1, 2, 3, 4}, notes);
  EXPECT_TRUE(notes.empty());
  note_parted(skeleton, {-1, -1, -1, 2, 3, 4}, notes);
  EXPECT_TRUE(mentions(notes, "'LeftArm', 'RightArm' hang on joints that the clip does not move, and come apart"));
}

TEST(JointMatch, AJointMovesOne) {
  EXPECT_EQ(moved_by({"tail"}, {"tail", "Tail"}), (Names{"tail", "-"}));
  EXPECT_EQ(moved_by({"tail", "tail"}, {"tail"}), (Names{"tail"}));
}

TEST(JointMatch, ChainsOfOtherLengthsLieAlongEachOther) {
  const Names five = {"spine_01", "spine_02", "spine_03", "spine_04", "spine_05"};
  EXPECT_EQ(moved_by({"abdomen", "chest", "upperchest"}, five), (Names{"abdomen", "-", "chest", "-", "upperchest"}));
  EXPECT_EQ(moved_by(five, {"abdomen", "chest", "upperchest"}), (Names{"spine_01", "spine_03", "spine_05"}));
  EXPECT_EQ(moved_by(five, {"chest"}), (Names{"spine_05"}));
  EXPECT_EQ(moved_by({"chest"}, five), (Names{"chest", "-", "-", "-", "-"}));
  // One more below is of the same convention.
  EXPECT_EQ(moved_by({"Spine", "Spine1"}, {"LowerBack", "Spine", "Spine1"}), (Names{"-", "Spine", "Spine1"}));
  EXPECT_EQ(moved_by({"Spine", "Spine1", "Spine2"}, {"LowerBack", "Spine", "Spine1"}),
            (Names{"Spine", "Spine1", "Spine2"}));
}

std::string put_map(const TemporaryFolder& folder, const std::string& joints) {
  put_bytes(folder / "map.json", R"({"schema": "bodyopt-joint-map-1", "joints": )" + joints + "}");
  return (folder / "map.json").string();
}

TEST(JointMatch, AMapWinsOverEverything) {
  const TemporaryFolder folder;
  const std::string map = put_map(folder, R"([{"from": "a", "to": "LeftArm"}, {"from": "LeftArm", "to": "tail"}])");
  EXPECT_EQ(moved_by({"a", "LeftArm", "LeftForeArm", "tail"}, {"LeftArm", "LeftForeArm", "tail", "a"}, map),
            (Names{"a", "LeftForeArm", "LeftArm", "-"}));
}

TEST(JointMatch, AMapOfAnotherClipOrCharacterIsAMismatch) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& joints) {
    const std::string map = put_map(folder, joints);
    return error_of(ErrorKind::mismatch, [&] { moved_by({"hips", "tail"}, {"root", "wing"}, map); });
  };
  const std::string from = message(R"([{"from": "hipps", "to": "root"}])");
  EXPECT_NE(from.find("'hipps', which the clip a.bvh does not have: 'hips'"), std::string::npos) << from;
  const std::string to = message(R"([{"from": "hips", "to": "wings"}])");
  EXPECT_NE(to.find("'wings', which the character does not have: 'wing'"), std::string::npos) << to;
}

TEST(JointMap, IsReadStrictly) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text, const std::string& named) {
    put_bytes(folder / "map.json", text);
    const std::string message = error_of(ErrorKind::file, [&] { read_joint_map(folder / "map.json"); });
    EXPECT_NE(message.find(named), std::string::npos) << message;
    EXPECT_NE(message.find("map.json"), std::string::npos) << message;
  };
  const auto map = [](const std::string& joints) {
    return R"({"schema": "bodyopt-joint-map-1", "joints": )" + joints + "}";
  };
  refused("", "JSON");
  refused(R"({"schema": "bodyopt-joint-map-2", "joints": []})", "bodyopt-joint-map-1");
  refused(R"({"schema": "bodyopt-joint-map-1"})", "lacks 'joints'");
  refused(R"({"schema": "bodyopt-joint-map-1", "joints": [], "map": 1})", "'map'");
  refused(map("[]"), "maps no joint");
  refused(map("{}"), "not a list");
  refused(map("[3]"), "joints[0] is not an object");
  refused(map(R"([{"from": "a"}])"), "lacks 'to'");
  refused(map(R"([{"from": "", "to": "b"}])"), "'from' is empty");
  refused(map(R"([{"from": "a", "to": 1}])"), "'to' is not text");
  refused(map(R"([{"from": "a", "to": "b", "turn": 1}])"), "'turn'");
  refused(map(R"([{"from": "a", "to": "b"}, {"from": "a", "to": "c"}])"), "joints[1] maps 'a'");
  refused(map(R"([{"from": "a", "to": "b"}, {"from": "c", "to": "b"}])"), "joints[1] maps to 'b'");
  error_of(ErrorKind::file, [&] { read_joint_map(folder / "none.json"); });
}

}  // namespace joint_match_test
}  // namespace bodyopt
