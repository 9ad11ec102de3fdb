// Clips of characters that rest in another pose.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "assets/characters/character.h"
#include "assets/clips/axis_turns.h"
#include "assets/clips/clip.h"
#include "runtime/core/json.h"
#include "runtime/host/rig.h"
#include "tests/assets/gltf_blob.h"
#include "tests/support/shared_data.h"

namespace bodyopt {
namespace retarget_test {

constexpr double kQuarter = std::numbers::pi / 2;

struct RigJoint {
  const char* name;
  int parent;
  Vec3 place;                // world, at rest
  Quat axes = {0, 0, 0, 1};  // world, at rest
};
using Rig = std::vector<RigJoint>;

// A body with one arm, stretched out to the left or hanging. All joints have the world's axes.
Rig with_body(const Rig& arm) {
  Rig rig{{"body", -1, {0, 1, 0}}};
  rig.insert(rig.end(), arm.begin(), arm.end());
  rig.insert(rig.end(), {{"top", 0, {0, 1.6, 0.1}}, {"bottom", 0, {0, 0, 0}}, {"right", 0, {-0.4, 1, 0}}});
  return rig;
}
Rig stretched_arm() {
  return with_body({{"upper", 0, {0.2, 1, 0}}, {"lower", 1, {0.5, 1, 0}}, {"end", 2, {0.8, 1, 0}}});
}
Rig hanging_arm() {
  return with_body({{"upper", 0, {0.2, 1, 0}}, {"lower", 1, {0.2, 0.7, 0}}, {"end", 2, {0.2, 0.4, 0}}});
}

Affine world_of(const RigJoint& joint) {
  JointTransform t;
  t.translation = joint.place;
  t.rotation = joint.axes;
  return affine_from(t);
}

Skeleton skeleton_of(const Rig& rig) {
  Skeleton skeleton;
  for (const RigJoint& from : rig) {
    Joint joint;
    joint.name = from.name;
    joint.parent = from.parent;
    joint.inverse_bind = inverse(world_of(from));
    joint.bind = decompose(from.parent < 0
                               ? world_of(from)
                               : skeleton.joints[static_cast<std::size_t>(from.parent)].inverse_bind * world_of(from));
    joint.default_local = joint.bind;
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

// The rig's nodes as they rest, and an animation "move" without channels.
GltfBlob nodes_of(const Rig& rig) {
  GltfBlob blob;
  blob.root["nodes"] = Json::array();
  const Skeleton skeleton = skeleton_of(rig);
  for (const Joint& joint : skeleton.joints) {
    blob.root["nodes"].push_back(
        {{"name", joint.name}, {"translation", joint.bind.translation}, {"rotation", joint.bind.rotation}});
  }
  for (std::size_t j = 0; j < rig.size(); ++j) {
    if (rig[j].parent >= 0) blob.root["nodes"][static_cast<std::size_t>(rig[j].parent)]["children"].push_back(j);
  }
  blob.root["animations"] = Json::array({{{"name", "move"}, {"samplers", Json::array()}, {"channels", Json::array()}}});
  return blob;
}

// The same with a triangle on a skin that is bound at rest.
GltfBlob skinned_nodes_of(const Rig& rig) {
  GltfBlob blob = nodes_of(rig);
  std::vector<float> binds;
  std::vector<std::size_t> joints;
  for (const Joint& joint : skeleton_of(rig).joints) {
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t r = 0; r < 4; ++r) {
        binds.push_back(r < 3 ? static_cast<float>(joint.inverse_bind.m[r][c]) : (c == 3 ? 1.0f : 0.0f));
      }
    }
    joints.push_back(joints.size());
  }
  const std::size_t position = blob.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const std::size_t weighted = blob.joints({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  const std::size_t weights = blob.quads({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  blob.root["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", position}, {"JOINTS_0", weighted}, {"WEIGHTS_0", weights}}}}}}}};
  blob.root["skins"] = {{{"joints", joints}, {"inverseBindMatrices", blob.matrices(binds)}}};
  blob.root["nodes"].push_back({{"name", "skin"}, {"mesh", 0}, {"skin", 0}});
  return blob;
}

std::vector<float> floats(const Quat& q) { return {q.begin(), q.end()}; }

// From one rotation to another, within a second.
void turn(GltfBlob& blob, int node, const Quat& from, const Quat& to) {
  std::vector<float> values = floats(from);
  const std::vector<float> last = floats(to);
  values.insert(values.end(), last.begin(), last.end());
  animate(blob, node, "rotation", {0, 1}, values);
}

Clip read(const GltfBlob& blob, const Skeleton& skeleton, const ClipOptions& options = {.fps = 1}) {
  const TemporaryFolder folder;
  put_bytes(folder / "a.glb", blob.glb());
  return read_clip((folder / "a.glb").string(), skeleton, options);
}

Vec3 place(const Skeleton& skeleton, const Pose& pose, const char* joint) {
  return posed_joints(skeleton, pose.joints)[static_cast<std::size_t>(skeleton.find(joint))] * Vec3{0, 0, 0};
}

void expect_bone(const Skeleton& skeleton, const Pose& pose, const char* from, const char* to, const Vec3& direction) {
  const Vec3 bone = place(skeleton, pose, to) - place(skeleton, pose, from);
  EXPECT_NEAR(length((1 / length(bone)) * bone - direction), 0, 1e-5) << from << " to " << to;
}

// The arm is lifted from where it hangs to the front.
TEST(Retarget, ClipsOfAnotherRestPoseLayBonesAlongEachOther) {
  const Skeleton skeleton = skeleton_of(stretched_arm());
  for (const bool with_skin : {false, true}) {
    GltfBlob blob = with_skin ? skinned_nodes_of(hanging_arm()) : nodes_of(hanging_arm());
    turn(blob, 1, {0, 0, 0, 1}, axis_angle({1, 0, 0}, -kQuarter));
    turn(blob, 2, {0, 0, 0, 1}, axis_angle({1, 0, 0}, -kQuarter));
    const Clip clip = read(blob, skeleton);
    EXPECT_TRUE(mentions(clip.notes,
                         "The rest poses of clip and character differ by up to 90 degrees (the bone to 'lower'); the "
                         "bones were laid along each other."));
    ASSERT_EQ(clip.poses.size(), 2u);
    expect_bone(skeleton, clip.poses[0], "upper", "lower", {0, -1, 0});
    expect_bone(skeleton, clip.poses[0], "lower", "end", {0, -1, 0});
    expect_bone(skeleton, clip.poses[1], "upper", "lower", {0, 0, 1});
    expect_bone(skeleton, clip.poses[1], "lower", "end", {0, 1, 0});
    // Without a twist: what is on top of the stretched arm is outside when it hangs.
    const Quat upper = clip.poses[0].joints[1].rotation;
    EXPECT_NEAR(length(rotate(upper, {0, 1, 0}) - Vec3{1, 0, 0}), 0, 1e-5);
    EXPECT_EQ(clip.poses[1].joints[2].translation, skeleton.joints[2].bind.translation);
  }
}

// Nodes of a skinned file may stand in any pose: the skin tells how it rests.
TEST(Retarget, TheSkinTellsTheRestPose) {
  const Skeleton skeleton = skeleton_of(stretched_arm());
  GltfBlob blob = skinned_nodes_of(hanging_arm());
  blob.root["nodes"][1]["rotation"] = axis_angle({0, 1, 0}, 1);
  turn(blob, 1, {0, 0, 0, 1}, axis_angle({1, 0, 0}, -kQuarter));
  const Clip clip = read(blob, skeleton);
  expect_bone(skeleton, clip.poses[0], "upper", "lower", {0, -1, 0});
  expect_bone(skeleton, clip.poses[1], "upper", "lower", {0, 0, 1});
  EXPECT_NEAR(length(rotate(clip.poses[0].joints[1].rotation, {0, 1, 0}) - Vec3{1, 0, 0}), 0, 1e-5);  // not twisted
}

TEST(Retarget, ClipsOfTheSameSkeletonAreTakenBitForBit) {
  const Quat bend = normalized({0.1f, -0.2f, 0.3f, 0.9f});
  for (const bool with_skin : {false, true}) {
    Rig rig = stretched_arm();
    for (RigJoint& joint : rig) joint.axes = axis_angle({1, 2, 3}, joint.place[0]);
    GltfBlob blob = with_skin ? skinned_nodes_of(rig) : nodes_of(rig);
    turn(blob, 1, {0.1, -0.2, 0.3, 0.9}, {0, 0, 0, 1});
    animate(blob, 0, "translation", {0, 1}, {0.1f, 0.2f, 0.3f, 1, 2, 3});
    const Clip clip = read(blob, skeleton_of(rig));
    EXPECT_TRUE(clip.notes.empty());
    const Quat expected = normalized(
        {static_cast<double>(0.1f), static_cast<double>(-0.2f), static_cast<double>(0.3f), static_cast<double>(0.9f)});
    EXPECT_EQ(clip.poses[0].joints[1].rotation, expected);
    EXPECT_NEAR(length(rotate(expected, {1, 0, 0}) - rotate(bend, {1, 0, 0})), 0, 1e-6);
    EXPECT_EQ(clip.poses[0].joints[0].translation,
              (Vec3{static_cast<double>(0.1f), static_cast<double>(0.2f), static_cast<double>(0.3f)}));
    EXPECT_EQ(clip.poses[1].joints[2].rotation, skeleton_of(rig).joints[2].default_local.rotation);
  }
}

// What rom writes: nodes as the character's file has them, even where that is no bind pose at all.
TEST(Retarget, OurOwnClipsAreTakenAsTheyAre) {
  const TemporaryFolder folder;
  Skeleton skeleton = skeleton_of(stretched_arm());
  skeleton.joints[1].default_local.rotation = axis_angle({0, 0, 1}, -1);
  skeleton.joints[2].default_local.translation = {0, -0.5, 0};
  Clip clip;
  clip.name = "rom";
  clip.fps = 1;
  clip.poses.assign(2, bind_pose(skeleton));
  clip.poses[1].joints[1].rotation = {0.5, 0.5, 0.5, 0.5};
  write_clip(clip, skeleton, folder / "rom.glb");
  const Clip again = read_clip((folder / "rom.glb").string(), skeleton, {.fps = 1});
  EXPECT_TRUE(again.notes.empty());
  EXPECT_EQ(again.poses[1].joints[1].rotation, (Quat{0.5, 0.5, 0.5, 0.5}));
  EXPECT_EQ(again.poses[0].joints[1].rotation, (Quat{0, 0, 0, 1}));
}

// Joints that turned with their bones when the rest pose was made another: rotations mean the same in both.
TEST(Retarget, JointsOfTheSameBonesAreTakenAsTheyAre) {
  const Skeleton skeleton = skeleton_of(stretched_arm());
  Rig turned = hanging_arm();
  for (std::size_t j = 1; j < 4; ++j) turned[j].axes = axis_angle({0, 0, 1}, -kQuarter);
  for (const bool with_skin : {false, true}) {
    GltfBlob blob = with_skin ? skinned_nodes_of(turned) : nodes_of(turned);
    turn(blob, 1, {0, 0, 0, 1}, {0.5, 0.5, 0.5, 0.5});
    const Clip clip = read(blob, skeleton);
    EXPECT_EQ(clip.poses[1].joints[1].rotation, (Quat{0.5, 0.5, 0.5, 0.5}));
    EXPECT_EQ(mentions(clip.notes, "differ by up to 90 degrees ('upper'), in joints with the same bones"), with_skin);
  }
}

TEST(Retarget, TravelIsScaledByTheBones) {
  const Skeleton skeleton = skeleton_of(stretched_arm());
  Rig large = hanging_arm();
  for (RigJoint& joint : large) joint.place = 3.0 * joint.place;
  GltfBlob blob = skinned_nodes_of(large);
  turn(blob, 1, {0, 0, 0, 1}, axis_angle({1, 0, 0}, -kQuarter));
  animate(blob, 0, "translation", {0, 1}, {0, 3, 0, 3, 3, 6});
  const Clip clip = read(blob, skeleton);
  EXPECT_TRUE(mentions(clip.notes, "are 3 times as long as this one's; how far it travels is scaled by 0.3333"));
  EXPECT_NEAR(length(clip.poses[1].joints[0].translation - Vec3{1, 1, 2}), 0, 1e-6);
  expect_bone(skeleton, clip.poses[1], "upper", "lower", {0, 0, 1});
}

// One common name says nothing: a stranger of another size.
TEST(Retarget, FewJointsOnBonesOfAnotherSizeAreAMismatch) {
  const Rig target = stretched_arm();
  Rig other = hanging_arm();
  const char* names[] = {"mane", "upper", "lower", "hoof", "horn", "tail", "udder"};
  for (std::size_t j = 0; j < other.size(); ++j) {
    other[j].name = names[j];
    other[j].place = 3.0 * other[j].place;
  }
  GltfBlob blob = skinned_nodes_of(other);
  for (int node = 0; node < 7; ++node) turn(blob, node, {0, 0, 0, 1}, axis_angle({1, 0, 0}, -kQuarter));
  const std::string message = error_of(ErrorKind::mismatch, [&] { read(blob, skeleton_of(target)); });
  EXPECT_NE(message.find("times as long as the character's"), std::string::npos);
}

// A clip's axes are the world's: the character goes where the clip's goes, and faces as it does.
TEST(Retarget, ClipsStandInTheWorldAsTheyAre) {
  const Skeleton skeleton = skeleton_of(stretched_arm());  // its arm points along x
  Rig sideways = stretched_arm();                          // along z
  for (RigJoint& joint : sideways) joint.place = {-joint.place[2], joint.place[1], joint.place[0]};
  GltfBlob blob = skinned_nodes_of(sideways);
  turn(blob, 1, {0, 0, 0, 1}, axis_angle({1, 0, 0}, kQuarter));
  animate(blob, 0, "translation", {0, 1}, {0, 1, 0, 5, 1, 0});
  const Clip clip = read(blob, skeleton);
  expect_bone(skeleton, clip.poses[0], "body", "upper", {0, 0, 1});
  expect_bone(skeleton, clip.poses[0], "upper", "lower", {0, 0, 1});
  expect_bone(skeleton, clip.poses[1], "upper", "lower", {0, -1, 0});
  EXPECT_NEAR(length(place(skeleton, clip.poses[1], "body") - Vec3{5, 1, 0}), 0, 1e-6);
}

TEST(Retarget, AClipOfOneFrameIsAPose) {
  const Skeleton skeleton = skeleton_of(stretched_arm());
  GltfBlob blob = skinned_nodes_of(hanging_arm());
  animate(blob, 1, "rotation", {0}, floats(axis_angle({1, 0, 0}, -kQuarter)));
  const Clip clip = read(blob, skeleton);
  ASSERT_EQ(clip.poses.size(), 1u);
  expect_bone(skeleton, clip.poses[0], "upper", "lower", {0, 0, 1});
}

TEST(Retarget, ScaleIsLeftOutAndSaid) {
  const Skeleton skeleton = skeleton_of(stretched_arm());
  GltfBlob blob = skinned_nodes_of(hanging_arm());
  turn(blob, 1, {0, 0, 0, 1}, axis_angle({1, 0, 0}, -kQuarter));
  animate(blob, 2, "scale", {0, 1}, {1, 1, 1, 2, 2, 2});
  const Clip clip = read(blob, skeleton);
  EXPECT_TRUE(mentions(clip.notes, "The clip scales joints ('lower'): scale is left out where rest poses differ."));
  EXPECT_EQ(clip.poses[1].joints[2].scale, (Vec3{1, 1, 1}));
}

TEST(Retarget, NoJointInCommonIsAMismatchThatNamesTheMap) {
  Rig other = hanging_arm();
  const char* names[] = {"p", "q", "r", "s", "t", "u", "v"};
  for (std::size_t j = 0; j < other.size(); ++j) other[j].name = names[j];
  GltfBlob blob = skinned_nodes_of(other);
  turn(blob, 1, {0, 0, 0, 1}, axis_angle({1, 0, 0}, -kQuarter));
  const Skeleton skeleton = skeleton_of(stretched_arm());
  const std::string message = error_of(ErrorKind::mismatch, [&] { read(blob, skeleton); });
  for (const char* part : {"'q'", "'upper'", "--joint-map"})
    EXPECT_NE(message.find(part), std::string::npos) << message;

  const TemporaryFolder folder;
  put_bytes(folder / "map.json", R"({"schema": "bodyopt-joint-map-1", "joints": [
      {"from": "q", "to": "upper"}, {"from": "r", "to": "lower"}, {"from": "s", "to": "end"}]})");
  const Clip clip = read(blob, skeleton, {.fps = 1, .joint_map = (folder / "map.json").string()});
  expect_bone(skeleton, clip.poses[1], "upper", "lower", {0, 0, 1});
}

// Nodes that collapse, and skins that are bound to nothing.
TEST(Retarget, HostileRestPosesAreErrors) {
  const Skeleton skeleton = skeleton_of(stretched_arm());
  GltfBlob flat = skinned_nodes_of(hanging_arm());
  flat.root["nodes"].push_back({{"name", "top"}, {"scale", {0, 0, 0}}, {"children", {0}}});
  turn(flat, 1, {0, 0, 0, 1}, {1, 0, 0, 0});
  const std::string message = error_of(ErrorKind::file, [&] { read(flat, skeleton); });
  EXPECT_NE(message.find("'body' are scaled to nothing"), std::string::npos) << message;
  GltfBlob singular = skinned_nodes_of(hanging_arm());
  singular.root["skins"][0]["inverseBindMatrices"] = singular.matrices(std::vector<float>(16 * 7, 0.0f));
  turn(singular, 1, {0, 0, 0, 1}, {1, 0, 0, 0});
  error_of(ErrorKind::file, [&] { read(singular, skeleton); });
  // Without bind matrices the nodes tell.
  GltfBlob unbound = skinned_nodes_of(hanging_arm());
  unbound.root["skins"][0].erase("inverseBindMatrices");
  turn(unbound, 1, {0, 0, 0, 1}, axis_angle({1, 0, 0}, -kQuarter));
  const Clip clip = read(unbound, skeleton);
  expect_bone(skeleton, clip.poses[1], "upper", "lower", {0, 0, 1});
}

TEST(Retarget, DamagedBytesNeverCrash) {
  const TemporaryFolder folder;
  GltfBlob blob = skinned_nodes_of(hanging_arm());
  turn(blob, 1, {0, 0, 0, 1}, axis_angle({1, 0, 0}, -kQuarter));
  animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  const std::string good = blob.glb();
  const Skeleton skeleton = skeleton_of(stretched_arm());
  unsigned state = 5;
  const auto random = [&](std::size_t below) {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
  };
  std::size_t read_whole = 0;
  for (int round = 0; round < 400; ++round) {
    std::string bytes = good;
    for (std::size_t k = 0; k <= random(3); ++k) {
      bytes[20 + random(bytes.size() - 20)] = "0123456789-,:[]{}\"\xff\0eE."[random(22)];
    }
    put_bytes(folder / "d.glb", bytes);
    try {
      const Clip clip = read_clip((folder / "d.glb").string(), skeleton, {.fps = 1});
      for (const Pose& pose : clip.poses) {
        for (const JointTransform& joint : pose.joints) {
          ASSERT_TRUE(std::isfinite(length(joint.translation)) && std::isfinite(joint.rotation[3])) << round;
        }
      }
      ++read_whole;
    } catch (const Error& error) {
      EXPECT_TRUE(error.kind() == ErrorKind::file || error.kind() == ErrorKind::mismatch) << error.what();
    }
  }
  EXPECT_GT(read_whole, 100u);
}

const std::string kWalk =
    "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    " JOINT Spine\n {\n  OFFSET 0 2 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "  JOINT Neck\n  {\n   OFFSET 0 2 0\n   CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "   JOINT Head\n   {\n    OFFSET 0 1 0\n    CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "    End Site\n    {\n     OFFSET 0 1 0\n    }\n   }\n  }\n }\n"
    " JOINT LeftUpLeg\n {\n  OFFSET 1 0 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "  JOINT LeftFoot\n  {\n   OFFSET 0 -4 0\n   CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "   JOINT LeftToeBase\n   {\n    OFFSET 0 -1 1\n    CHANNELS 0\n    End Site\n    {\n     OFFSET 0 0 1\n    }\n   "
    "}\n"
    "  }\n }\n}\n"
    "MOTION\nFrames: 2\nFrame Time: 1\n"
    "0 9 0 0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0\n"
    "0 9 0 0 0 0  0 9 0  0 9 0  0 9 0  0 9 0  0 9 0\n";

// A neck that leans forwards at rest is a neck of another build: a face that looks ahead goes on doing so. The leg that
// is spread at rest is a pose, but the foot stays flat.
TEST(Retarget, TrunksAndFeetAreHeldAlike) {
  const TemporaryFolder folder;
  put_bytes(folder / "walk.bvh", kWalk);
  const Skeleton skeleton = skeleton_of({{"Hips", -1, {0, 9, 0}},
                                         {"Spine", 0, {0, 11, -0.5}},
                                         {"Neck", 1, {0, 13, 0}},
                                         {"Head", 2, {0, 13.7, 0.7}},
                                         {"LeftUpLeg", 0, {1, 9, 0}},
                                         {"LeftFoot", 4, {3, 5, 0}},
                                         {"LeftToeBase", 5, {3, 4.5, 1.5}}});
  const Clip clip = read_clip((folder / "walk.bvh").string(), skeleton, {.fps = 1});
  for (const char* joint : {"Hips", "Spine", "Neck", "Head", "LeftFoot"}) {
    const Affine world = posed_joints(skeleton, clip.poses[0].joints)[static_cast<std::size_t>(skeleton.find(joint))];
    EXPECT_NEAR(length(world * Vec3{0, 0, 1} - world * Vec3{0, 0, 0} - Vec3{0, 0, 1}), 0, 1e-9) << joint;
  }
  expect_bone(skeleton, clip.poses[0], "LeftUpLeg", "LeftFoot", {0, -1, 0});
  EXPECT_TRUE(mentions(clip.notes, "(the bone to 'LeftFoot')"));
}

// A mesh that lies in its own space, stood upright by the nodes above its joints.
TEST(Retarget, MeshesThatLieStandUpright) {
  const TemporaryFolder folder;
  put_bytes(folder / "walk.bvh", kWalk);
  const auto lying = [](double x, double y, double z) { return Vec3{x, -z, y}; };
  Skeleton skeleton = skeleton_of({{"Hips", -1, lying(0, 9, 0)},
                                   {"Spine", 0, lying(0, 11, 0)},
                                   {"Neck", 1, lying(0, 13, 0)},
                                   {"Head", 2, lying(0, 14, 0)},
                                   {"LeftUpLeg", 0, lying(1, 9, 0)},
                                   {"LeftFoot", 4, lying(1, 5, 0)},
                                   {"LeftToeBase", 5, lying(1, 4, 1)}});
  JointTransform upright;
  upright.rotation = axis_angle({1, 0, 0}, -kQuarter);
  skeleton.joints[0].default_local = decompose(affine_from(upright) * affine_from(skeleton.joints[0].bind));
  const Clip clip = read_clip((folder / "walk.bvh").string(), skeleton, {.fps = 1});
  EXPECT_GT(place(skeleton, clip.poses[0], "Head")[1], place(skeleton, clip.poses[0], "LeftFoot")[1] + 8);
  expect_bone(skeleton, clip.poses[0], "Hips", "Neck", {0, 1, 0});
  // Turned by its nodes about the vertical only, a character keeps its own facing.
  EXPECT_EQ(turn_upright(skeleton_of(stretched_arm())), (Quat{0, 0, 0, 1}));
  skeleton = skeleton_of(stretched_arm());
  skeleton.joints[0].default_local.rotation = axis_angle({0, 1, 0}, kQuarter);
  EXPECT_EQ(turn_upright(skeleton), (Quat{0, 0, 0, 1}));
  skeleton.joints[0].default_local.rotation = axis_angle({0, 0, 1}, 1);  // a pose
  EXPECT_EQ(turn_upright(skeleton), (Quat{0, 0, 0, 1}));
}

// Bodies that were bound facing elsewhere play one motion side by side.
TEST(Retarget, HowACharacterFacesAtBindIsNoMatterOfTheMotion) {
  const TemporaryFolder folder;
  put_bytes(folder / "walk.bvh", kWalk);
  const auto skeleton_facing = [](double angle) {
    const auto turned = [&](double x, double y, double z) {
      return rotate(axis_angle({0, 1, 0}, angle), Vec3{x, y, z});
    };
    return skeleton_of({{"Hips", -1, turned(0, 9, 0)},
                        {"Spine", 0, turned(0, 11, 0)},
                        {"Neck", 1, turned(0, 13, 0)},
                        {"Head", 2, turned(0, 14, 0)},
                        {"LeftUpLeg", 0, turned(1, 9, 0)},
                        {"LeftFoot", 4, turned(1, 5, 0)},
                        {"LeftToeBase", 5, turned(1, 4, 1)}});
  };
  const Skeleton forwards = skeleton_facing(0);
  const Clip expected = read_clip((folder / "walk.bvh").string(), forwards, {.fps = 1});
  for (const double angle : {kQuarter, -kQuarter, 2 * kQuarter}) {
    const Skeleton other = skeleton_facing(angle);
    const Clip clip = read_clip((folder / "walk.bvh").string(), other, {.fps = 1});
    ASSERT_EQ(clip.poses.size(), expected.poses.size());
    for (std::size_t k = 0; k < clip.poses.size(); ++k) {
      for (const Joint& joint : forwards.joints) {
        const Vec3 off =
            place(other, clip.poses[k], joint.name.c_str()) - place(forwards, expected.poses[k], joint.name.c_str());
        EXPECT_LT(length(off), 1e-9) << joint.name << ' ' << angle;
      }
    }
    EXPECT_FALSE(mentions(clip.notes, "axis"));
  }
}

// A clip of a heavier body on the real human: the limbs point as they do on the body that the clip was made for.
TEST(Retarget, RealClipsMoveOtherRealCharacters) {
  const auto human = shared_data("characters/human_muscular.glb"), heavy = shared_data("characters/human_heavy.glb"),
             man = shared_data("characters/quaternius_man.glb");
  if (!human || !heavy || !man) GTEST_SKIP() << kNeedsOtherWriters;
  const Skeleton skeleton = read_character(*human).skeleton;
  const auto expect_alike = [&](const Skeleton& own, const std::string& source, std::size_t frame) {
    const Pose a = read_clip(source, own, {.fps = 30}).poses[frame];
    const Pose b = read_clip(source, skeleton, {.fps = 30}).poses[frame];
    for (const auto& [from, to] : {std::pair{"LeftArm", "LeftForeArm"},
                                   {"RightForeArm", "RightHand"},
                                   {"LeftUpLeg", "LeftLeg"},
                                   {"RightLeg", "RightFoot"}}) {
      const Vec3 bone = place(own, a, to) - place(own, a, from);
      const Vec3 carried = place(skeleton, b, to) - place(skeleton, b, from);
      EXPECT_GT(dot(bone, carried) / (length(bone) * length(carried)), 0.9999) << source << ' ' << from;
    }
  };
  expect_alike(read_character(*heavy).skeleton, heavy->string() + "#cmu_131_02", 59);
  expect_alike(read_character(*man).skeleton, man->string() + "#Run", 7);
  // The man is eight units tall, and has three spines with other names.
  const Clip run = read_clip(man->string() + "#Run", skeleton, {.fps = 30});
  EXPECT_TRUE(mentions(run.notes, "'Spine2' moves 'Spine1'"));
  EXPECT_TRUE(mentions(run.notes, "times as long as this one's"));
}

}  // namespace retarget_test
}  // namespace bodyopt
