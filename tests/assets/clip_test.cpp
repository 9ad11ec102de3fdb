#include "assets/clips/clip.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "assets/characters/character.h"
#include "assets/gltf/gltf_rest.h"
#include "geometry/mesh.h"
#include "runtime/core/json.h"
#include "runtime/host/rig.h"
#include "tests/assets/gltf_blob.h"
#include "tests/support/read_bytes.h"
#include "tests/support/shared_data.h"

namespace bodyopt {
namespace clip_test {

constexpr double kPi = std::numbers::pi;

// "root" at the origin, its child "tip" 1 m above.
Skeleton two_joints() {
  Skeleton skeleton;
  skeleton.joints.resize(2);
  skeleton.joints[0].name = "root";
  skeleton.joints[1].name = "tip";
  skeleton.joints[1].parent = 0;
  skeleton.joints[1].bind.translation = skeleton.joints[1].default_local.translation = {0, 1, 0};
  skeleton.joints[1].inverse_bind.m[1][3] = -1;
  return skeleton;
}

// An animation-only file: nodes "root" and "tip", no channel yet.
GltfBlob two_nodes() {
  GltfBlob blob;
  blob.root["nodes"] = {{{"name", "root"}, {"children", {1}}}, {{"name", "tip"}, {"translation", {0, 3, 0}}}};
  blob.root["animations"] = Json::array({{{"name", "move"}, {"samplers", Json::array()}, {"channels", Json::array()}}});
  return blob;
}

Clip clip_of(const GltfBlob& blob, const TemporaryFolder& folder, const ClipOptions& options = {},
             const Skeleton& skeleton = two_joints(), const std::string& name = "") {
  put_bytes(folder / "a.glb", blob.glb());
  return read_clip((folder / "a.glb").string() + name, skeleton, options);
}

TEST(Clip, SamplesLinearStepAndCubic) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  const auto s = static_cast<float>(std::sqrt(0.5));
  animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 4, 0, 0});
  animate(blob, 0, "rotation", {0, 1}, {0, 0, 0, 2, 0, 0, -2 * s, -2 * s});  // not of unit length; a quarter turn
  animate(blob, 1, "translation", {0.25f, 0.75f}, {0, 1, 0, 0, 2, 0}, "STEP");
  animate(blob, 1, "scale", {0, 1}, {0, 0, 0, 1, 1, 1, 2, 0, 0, -4, 0, 0, 3, 1, 1, 0, 0, 0}, "CUBICSPLINE");
  const Clip clip = clip_of(blob, folder, {.fps = 4, .first_frame = 10});
  ASSERT_EQ(clip.poses.size(), 5u);
  EXPECT_EQ(clip.first_frame, 10);
  EXPECT_EQ(clip.last_frame(), 14);
  EXPECT_EQ(clip.name, "move");
  for (int k = 0; k <= 4; ++k) {
    const double t = k / 4.0;
    const Pose& pose = clip.poses[static_cast<std::size_t>(k)];
    ASSERT_EQ(pose.joints.size(), 2u);
    EXPECT_NEAR(pose.joints[0].translation[0], 4 * t, 1e-6);
    const Vec3 x = rotate(pose.joints[0].rotation, {1, 0, 0});
    EXPECT_NEAR(x[0], std::cos(t * kPi / 2), 1e-6);
    EXPECT_NEAR(x[1], std::sin(t * kPi / 2), 1e-6);
    EXPECT_EQ(pose.joints[1].translation[1], k < 3 ? 1 : 2);
    // Hermite: values 1 and 3, slopes 2 and -4.
    const double hermite = (2 * t * t * t - 3 * t * t + 1) * 1 + (t * t * t - 2 * t * t + t) * 2 +
                           (3 * t * t - 2 * t * t * t) * 3 + (t * t * t - t * t) * -4;
    EXPECT_NEAR(pose.joints[1].scale[0], hermite, 1e-6);
    EXPECT_NEAR(pose.joints[1].scale[1], 1, 1e-6);
  }
  EXPECT_TRUE(mentions(clip.notes, "scales joints ('tip')"));
}

TEST(Clip, RotationsWithoutLengthAreSaid) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  animate(blob, 0, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 0, 1});
  animate(blob, 1, "rotation", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0},
          "CUBICSPLINE");
  EXPECT_FALSE(mentions(clip_of(blob, folder).notes, "length zero"));  // tangents have none
  blob = two_nodes();
  animate(blob, 1, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 0, 0});
  EXPECT_TRUE(
      mentions(clip_of(blob, folder).notes, "in the clip are quaternions of length zero, taken as none: 'tip'"));
  blob = two_nodes();
  animate(blob, 1, "translation", {0, 1}, {0, 1, 0, 0, 1, 0});
  blob.root["nodes"][0]["rotation"] = {0, 0, 0, 0};
  EXPECT_TRUE(mentions(clip_of(blob, folder).notes, "of nodes are quaternions of length zero, taken as none: 'root'"));
}

TEST(Clip, CubicTangentsAreScaledByTheKeyDistance) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  animate(blob, 0, "translation", {0, 2}, {0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 2, 0, 0, 0, 0, 0}, "CUBICSPLINE");
  const Clip clip = clip_of(blob, folder, {.fps = 2});
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {  // slope 1 everywhere: a straight line
    EXPECT_NEAR(clip.poses[k].joints[0].translation[0], 0.5 * static_cast<double>(k), 1e-6);
  }
}

TEST(Clip, WhatIsNotAnimatedStaysAsTheSkeletonHasIt) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  animate(blob, 1, "rotation", {0, 1}, {0, 0, 0, 1, 1, 0, 0, 0});
  const Clip clip = clip_of(blob, folder);
  EXPECT_EQ(clip.poses.size(), 25u);
  EXPECT_EQ(clip.poses[3].joints[1].translation, (Vec3{0, 1, 0}));  // not the 3 of the clip's file
  EXPECT_TRUE(clip.notes.empty());
}

TEST(Clip, AnimatedNodesAboveJointsAreComposedIn) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  blob.root["nodes"].push_back({{"name", "armature"}, {"scale", {2, 2, 2}}, {"children", {0}}});
  animate(blob, 2, "translation", {0, 1}, {0, 0, 0, 10, 0, 0});
  animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 0, 1, 0});
  const Clip clip = clip_of(blob, folder, {.fps = 2});
  EXPECT_NEAR(length(clip.poses[1].joints[0].translation - Vec3{5, 1, 0}), 0, 1e-6);
  EXPECT_NEAR(clip.poses[1].joints[0].scale[2], 1, 1e-9);  // the armature's is no joint's
  EXPECT_FALSE(mentions(clip.notes, "armature"));
}

TEST(Clip, ListsWhatDoesNotMatch) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  blob.root["nodes"][1]["name"] = "tail";
  animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  animate(blob, 1, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  Clip clip = clip_of(blob, folder);
  EXPECT_TRUE(mentions(clip.notes, "'tip'"));
  EXPECT_TRUE(mentions(clip.notes, "'tail'"));
  EXPECT_EQ(clip.poses[5].joints[1].translation, (Vec3{0, 1, 0}));
  blob.root["nodes"][0]["name"] = "stem";
  const std::string text = error_of(ErrorKind::mismatch, [&] { clip_of(blob, folder); });
  for (const char* name : {"'stem'", "'tail'", "'root'", "'tip'"}) EXPECT_NE(text.find(name), std::string::npos);
}

// Joints of the same names on bones of another length.
TEST(Clip, OfAnotherBuildIsAMismatch) {
  const TemporaryFolder folder;
  for (const float size : {0.6f, 1.7f, 2.5f, 0.3f}) {
    GltfBlob blob = two_nodes();
    animate(blob, 1, "translation", {0, 1}, {0, size, 0, 0, size, 0});
    if (size > 0.5 && size < 2) {
      EXPECT_EQ(clip_of(blob, folder).poses[3].joints[1].translation[1], size);
      continue;
    }
    const std::string text = error_of(ErrorKind::mismatch, [&] { clip_of(blob, folder); });
    EXPECT_NE(text.find("times as long as the character's"), std::string::npos);
  }
}

TEST(Clip, ChoosesByName) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  auto second = blob.root["animations"][0];
  second.erase("name");
  blob.root["animations"].push_back(second);
  EXPECT_EQ(clip_of(blob, folder, {}, two_joints(), "#move").name, "move");
  EXPECT_EQ(clip_of(blob, folder, {}, two_joints(), "#animation_1").name, "a");
  const std::string text = error_of(ErrorKind::file, [&] { clip_of(blob, folder, {}, two_joints(), "#walk"); });
  EXPECT_NE(text.find("'move', 'animation_1'"), std::string::npos) << text;
  std::filesystem::copy_file(folder / "a.glb", folder / "b#2.glb");
  EXPECT_EQ(read_clip((folder / "b#2.glb").string(), two_joints(), {}).name, "move");
  EXPECT_EQ(read_clip((folder / "b#2.glb").string() + "#move", two_joints(), {}).name, "move");
}

TEST(Clip, UnitScalesTranslations) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  blob.root["nodes"][1]["translation"] = {0, 100, 0};
  animate(blob, 0, "translation", {0, 1}, {100, 0, 0, 100, 0, 0});
  EXPECT_NEAR(clip_of(blob, folder, {.unit = 0.01}).poses[7].joints[0].translation[0], 1, 1e-9);
}

// Bones 3.28 times as long may be feet, or a giant's: which of the two is asked, and the unit advised is right.
TEST(Clip, AnotherUnitThatBonesMayHaveIsAskedFor) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  blob.root["nodes"][1]["translation"] = {0, 3.28084, 0};
  animate(blob, 0, "translation", {0, 1}, {3.28084f, 0, 0, 3.28084f, 0, 0});
  EXPECT_TRUE(mentions(clip_of(blob, folder).notes, "another unit (--unit 0.3048)?"));
  const Clip followed = clip_of(blob, folder, {.unit = 0.3048});
  EXPECT_FALSE(mentions(followed.notes, "another unit"));
  EXPECT_NEAR(followed.poses[7].joints[0].translation[0], 1, 1e-6);
}

// Whatever the unit of the file, of an armature in it and its axes: joints stand where they do in metres, unscaled.
TEST(Clip, UnitsAreToldByTheBonesAndArmaturesScaleNoJoint) {
  const TemporaryFolder folder;
  const float s = std::sqrt(0.5f);
  for (const double unit : {1.0, 0.01, 0.001, 0.0254}) {
    for (const double armature : {1.0, 0.01, 100.0}) {
      for (const double given : {0.0, 0.01}) {
        if (unit == 0.0254 && given != 0) continue;  // bones 2.5 times as long may be another build's
        SCOPED_TRACE(std::to_string(unit) + " " + std::to_string(armature) + " " + std::to_string(given));
        const double inner = 1 / (unit * armature);
        GltfBlob blob = two_nodes();
        blob.root["nodes"][0]["name"] = "Root";  // matched by a convention
        blob.root["nodes"][0]["translation"] = {0, 0, 0.9 * inner};
        blob.root["nodes"][0]["rotation"] = {s, 0, 0, s};
        blob.root["nodes"][1]["translation"] = {0, inner, 0};
        blob.root["nodes"].push_back({{"name", "armature"},
                                      {"scale", {armature, armature, armature}},
                                      {"rotation", {-s, 0, 0, s}},
                                      {"children", {0}}});
        const auto to = static_cast<float>(inner);
        animate(blob, 0, "translation", {0, 1}, {0, 0, 0.9f * to, to, 0, 0.9f * to});
        animate(blob, 1, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, s, s});
        const Clip clip = clip_of(blob, folder, {.unit = given});
        const std::vector<JointTransform>& last = clip.poses.back().joints;
        EXPECT_NEAR(length(last[0].translation - Vec3{1, 0.9, 0}), 0, 1e-5);
        EXPECT_NEAR(length(last[0].scale - Vec3{1, 1, 1}), 0, 1e-6);
        EXPECT_NEAR(length(last[1].translation - Vec3{0, 1, 0}), 0, 1e-6);
        EXPECT_NEAR(last[1].rotation[2], s, 1e-6);
        EXPECT_FALSE(mentions(clip.notes, "scales"));
        EXPECT_EQ(mentions(clip.notes, "from the length of the bones"), unit != (given == 0 ? 1 : given));
      }
    }
  }
}

// As who scales an armature in Blender exports it: bones and travel are the character's own.
TEST(Clip, ARigThatIsScaledAsAWholeKeepsItsSize) {
  const TemporaryFolder folder;
  for (const double scale : {0.4, 1.3, 2.5}) {
    GltfBlob blob = two_nodes();
    blob.root["nodes"][1]["translation"] = {0, 1, 0};
    blob.root["nodes"].push_back({{"name", "armature"}, {"scale", {scale, scale, scale}}, {"children", {0}}});
    animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
    animate(blob, 1, "translation", {0, 1}, {0, 1, 0, 0, 1, 0});
    const Clip clip = clip_of(blob, folder);
    const std::vector<JointTransform>& last = clip.poses.back().joints;
    EXPECT_NEAR(length(last[0].translation - Vec3{1, 0, 0}), 0, 1e-6);
    EXPECT_NEAR(length(last[1].translation - Vec3{0, 1, 0}), 0, 1e-6);
    EXPECT_NEAR(last[0].scale[0], 1, 1e-6);
    EXPECT_TRUE(mentions(clip.notes, "how far it travels is scaled by"));
  }
}

// As FBX has such a rig, in which no armature is left: three bones tell.
TEST(Clip, BonesThatAreAllLongerAreARigThatIsScaled) {
  const TemporaryFolder folder;
  Skeleton skeleton = two_joints();
  GltfBlob blob = two_nodes();
  blob.root["nodes"][1]["translation"] = {0, 1.3, 0};
  for (const char* name : {"third", "fourth"}) {
    Joint joint = skeleton.joints.back();
    joint.name = name;
    joint.parent = static_cast<int>(skeleton.size()) - 1;
    joint.inverse_bind.m[1][3] -= 1;
    skeleton.joints.push_back(joint);
    blob.root["nodes"].back()["children"] = {blob.root["nodes"].size()};
    blob.root["nodes"].push_back({{"name", name}, {"translation", {0, 1.3, 0}}});
  }
  animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 1.3f, 0, 0});
  GltfBlob stretched = blob, bound = blob;
  animate(bound, 2, "translation", {0, 1}, {0, 1, 0, 0, 1, 0});
  animate(blob, 2, "translation", {0, 1}, {0, 1.3f, 0, 0, 1.3f, 0});
  animate(stretched, 2, "translation", {0, 1}, {0, 1.3f, 0, 0, 1.6f, 0});
  const Clip clip = clip_of(blob, folder, {}, skeleton);
  EXPECT_NEAR(length(clip.poses.back().joints[0].translation - Vec3{1, 0, 0}), 0, 1e-6);
  EXPECT_NEAR(length(clip.poses.back().joints[2].translation - Vec3{0, 1, 0}), 0, 1e-6);
  EXPECT_TRUE(mentions(clip.notes, "are 1.3 times as long as this one's"));
  blob.root["nodes"][3]["translation"] = {0, 1, 0};  // one is as long as here: another build
  const Clip other = clip_of(blob, folder, {}, skeleton);
  EXPECT_NEAR(other.poses.back().joints[2].translation[1], 1, 1e-6);
  EXPECT_TRUE(mentions(other.notes, "Bones of the clip's character have other lengths"));
  stretched.root["nodes"][3]["translation"] = {0, 1, 0};  // what changes in the clip is motion
  EXPECT_NEAR(clip_of(stretched, folder, {}, skeleton).poses.back().joints[2].translation[1], 1.6, 1e-6);
  // In the character's file the joint stands slid: where it is bound it is the character's own, too.
  skeleton.joints[2].default_local.translation = {0, 1.5, 0};
  for (const std::size_t node : {1, 2, 3}) bound.root["nodes"][node]["translation"] = {0, 1, 0};
  const Clip of_own = clip_of(bound, folder, {}, skeleton);
  EXPECT_NEAR(of_own.poses.back().joints[2].translation[1], 1, 1e-6);
  EXPECT_FALSE(mentions(of_own.notes, "have other lengths"));
}

// An animation alone may be exported as it stands in a frame: what is stretched there is motion.
TEST(Clip, AStretchedFrameIsNoArmature) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  blob.root["nodes"][0]["scale"] = {1.3, 1.3, 1.3};
  animate(blob, 0, "scale", {0, 1}, {1, 1, 1, 1.3f, 1.3f, 1.3f});
  const Clip clip = clip_of(blob, folder);
  EXPECT_NEAR(clip.poses.front().joints[0].scale[1], 1, 1e-6);
  EXPECT_NEAR(clip.poses.back().joints[0].scale[1], 1.3, 1e-6);
}

TEST(Clip, ShearIsToldInMetres) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  blob.root["nodes"][0]["rotation"] = {0, 0, std::sin(kPi / 12), std::cos(kPi / 12)};
  blob.root["nodes"].push_back({{"name", "armature"}, {"scale", {1, 1.4, 0.7}}, {"children", {0}}});
  animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 0, 1, 0});
  EXPECT_TRUE(mentions(clip_of(blob, folder).notes, "Nodes of the clip's file shear its joints"));
  blob.root["nodes"][2]["scale"] = {2, 2, 2};
  EXPECT_FALSE(mentions(clip_of(blob, folder).notes, "shear"));
  // As they stand nothing is sheared, but as they move.
  blob.root["nodes"][0].erase("rotation");
  blob.root["nodes"][2]["scale"] = {1, 1.4, 0.7};
  EXPECT_FALSE(mentions(clip_of(blob, folder).notes, "shear"));
  const float s = std::sqrt(0.5f);
  animate(blob, 0, "rotation", {0, 1}, {0, 0, 0, 1, s, 0, 0, s});
  EXPECT_TRUE(mentions(clip_of(blob, folder).notes, "Nodes of the clip's file shear its joints"));
}

TEST(Clip, MirroredRigsAreRefused) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 0, 1, 0});
  blob.root["nodes"].push_back({{"name", "armature"}, {"scale", {-1, 1, 1}}, {"children", {0}}});
  const std::string text = error_of(ErrorKind::mismatch, [&] { clip_of(blob, folder); });
  EXPECT_NE(text.find("inside out"), std::string::npos) << text;
  blob.root["nodes"][2]["scale"] = {-1, -1, 1};  // a half turn
  EXPECT_EQ(clip_of(blob, folder).poses.size(), 25u);
}

TEST(Clip, OptionsOutOfRangeAreUsageErrors) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  animate(blob, 0, "translation", {0, 1}, {100, 0, 0, 100, 0, 0});
  for (const double fps : {0.0, -24.0, 1e9, static_cast<double>(NAN)}) {
    error_of(ErrorKind::usage, [&] { clip_of(blob, folder, {.fps = fps}); });
  }
  error_of(ErrorKind::usage, [&] { clip_of(blob, folder, {.unit = -1}); });
  error_of(ErrorKind::usage, [&] { clip_of(blob, folder, {.first_frame = 2147483640}); });
}

TEST(Clip, HostileAnimationsAreErrors) {
  const TemporaryFolder folder;
  using Damage = std::function<void(GltfBlob&)>;
  const auto animated = [](const std::vector<float>& times, const std::vector<float>& values,
                           const std::string& interpolation = "LINEAR") {
    return [=](GltfBlob& b) { animate(b, 0, "translation", times, values, interpolation); };
  };
  const auto patched = [](const std::string& pointer, const Json& value) {
    return [=](GltfBlob& b) {
      animate(b, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
      b.root["animations"][0][Json::json_pointer(pointer)] = value;
    };
  };
  const std::vector<Damage> damages{
      animated({1, 0}, {0, 0, 0, 1, 0, 0}),
      animated({0, NAN}, {0, 0, 0, 1, 0, 0}),
      animated({0, 1}, {0, 0, 0, INFINITY, 0, 0}),
      animated({0, 1}, {0, 0, 0}),
      animated({0, 1}, {0, 0, 0, 1, 0, 0}, "CUBICSPLINE"),
      animated({0, 1}, {0, 0, 0, 1, 0, 0}, "BEZIER"),
      animated({0, 1e30f}, {0, 0, 0, 1, 0, 0}),
      animated({0, 1e6f}, {0, 0, 0, 1, 0, 0}),
      patched("/channels/0/sampler", 3),
      patched("/channels/0/sampler", -1),
      patched("/channels/0/target/node", 9),
      patched("/channels/0/target/path", "pointer"),
      patched("/channels/0/target/path", "rotation"),
      patched("/samplers/0/input", 1),
      patched("/samplers/0/output", 44),
      [](GltfBlob& b) {
        animate(b, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
        animate(b, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
      },
      [](GltfBlob& b) { b.root.erase("animations"); },
  };
  for (std::size_t i = 0; i < damages.size(); ++i) {
    SCOPED_TRACE(i);
    GltfBlob blob = two_nodes();
    damages[i](blob);
    error_of(ErrorKind::file, [&] { clip_of(blob, folder); });
  }
  put_bytes(folder / "x.txt", "hello");
  error_of(ErrorKind::file, [&] { read_clip((folder / "x.txt").string(), two_joints(), {}); });
  error_of(ErrorKind::file, [&] { read_clip("", two_joints(), {}); });
  error_of(ErrorKind::file, [&] { read_clip((folder / "none.glb").string(), two_joints(), {}); });
}

TEST(Clip, EveryTruncationIsAnError) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  const std::string bytes = blob.glb();
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    put_bytes(folder / "t.glb", bytes.substr(0, length));
    error_of(ErrorKind::file, [&] { read_clip((folder / "t.glb").string(), two_joints(), {}); });
  }
}

TEST(Clip, DamagedBytesNeverCrash) {
  const TemporaryFolder folder;
  GltfBlob blob = two_nodes();
  animate(blob, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  animate(blob, 1, "rotation", {0, 1}, {0, 0, 0, 1, 1, 0, 0, 0}, "STEP");
  const std::string good = blob.glb();
  unsigned state = 3;
  const auto random = [&](std::size_t below) {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
  };
  for (int round = 0; round < 500; ++round) {
    std::string bytes = good;
    for (std::size_t k = 0; k <= random(3); ++k) {
      bytes[20 + random(bytes.size() - 20)] = "0123456789-,:[]{}\"\xff\0eE."[random(22)];
    }
    put_bytes(folder / "d.glb", bytes);
    try {
      const Clip clip = read_clip((folder / "d.glb").string(), two_joints(), {});
      EXPECT_GE(clip.poses.size(), 1u);
    } catch (const Error& error) {
      EXPECT_TRUE(error.kind() == ErrorKind::file || error.kind() == ErrorKind::mismatch) << error.what();
    }
  }
}

double pose_difference(const Clip& a, const Clip& b, const Skeleton& skeleton) {
  double most = 0;
  for (std::size_t k = 0; k < a.poses.size(); ++k) {
    const auto x = posed_joints(skeleton, a.poses[k].joints), y = posed_joints(skeleton, b.poses[k].joints);
    for (std::size_t j = 0; j < x.size(); ++j) {
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 4; ++c) most = std::max(most, std::abs(x[j].m[r][c] - y[j].m[r][c]));
      }
    }
  }
  return most;
}

TEST(Clip, WrittenAndReadBackIsTheSame) {
  const TemporaryFolder folder;
  const Skeleton skeleton = two_joints();
  for (const int frames : {1, 2, 25, 30000}) {
    Clip clip;
    clip.name = "swing";
    clip.fps = 23.976;
    for (int k = 0; k < frames; ++k) {
      Pose pose;
      for (const Joint& joint : skeleton.joints) pose.joints.push_back(joint.default_local);
      pose.joints[0].rotation = axis_angle({0, 0, 1}, 0.3 * k);
      pose.joints[1].translation = {0.01 * (k % 10), 1, 0};
      clip.poses.push_back(pose);
    }
    write_clip(clip, skeleton, folder / "w.glb");
    const Clip again = read_clip((folder / "w.glb").string() + "#swing", skeleton, {.fps = 23.976});
    ASSERT_EQ(again.poses.size(), clip.poses.size());
    EXPECT_LT(pose_difference(clip, again, skeleton), frames < 100 ? 1e-5 : 0.02);  // times are single precision
    EXPECT_TRUE(again.notes.empty());
  }
}

TEST(Clip, OnlyWhatVariesIsWritten) {
  const TemporaryFolder folder;
  const Skeleton skeleton = two_joints();
  Clip clip;
  clip.name = "still";
  clip.poses.assign(3, bind_pose(skeleton));
  const auto channels = [&] {
    write_clip(clip, skeleton, folder / "w.glb");
    const std::string bytes = testing::read_bytes(folder / "w.glb");
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    return Json::parse(bytes.substr(20, length))["animations"][0]["channels"].size();
  };
  EXPECT_EQ(channels(), 1u);                                       // glTF forbids an empty animation
  for (Pose& pose : clip.poses) pose.joints[1].scale = {1, 2, 1};  // still, but not the default
  EXPECT_EQ(channels(), 1u);
  EXPECT_EQ(read_clip((folder / "w.glb").string(), skeleton, {}).poses[2].joints[1].scale, (Vec3{1, 2, 1}));
  clip.poses[1].joints[0].translation[2] = 1;
  EXPECT_EQ(channels(), 2u);
}

// Other programs make one armature with one action of it: all joints are those of one skin, which draws nothing.
TEST(Clip, IsWrittenAsOneSkeletonWithOneAnimation) {
  const TemporaryFolder folder;
  const Skeleton skeleton = two_joints();
  Clip clip;
  clip.poses.assign(2, bind_pose(skeleton));
  clip.poses[1].joints[1].rotation = axis_angle({0, 0, 1}, 0.3);
  write_clip(clip, skeleton, folder / "w.glb");
  const GltfFile file(folder / "w.glb");
  ASSERT_EQ(file.model().skins.size(), 1u);
  EXPECT_EQ(file.model().skins[0].joints, (std::vector<int>{0, 1}));
  EXPECT_EQ(file.model().nodes.at(static_cast<std::size_t>(file.model().skins[0].skeleton)).name, "skeleton");
  EXPECT_EQ(file.model().animations.size(), 1u);
  EXPECT_TRUE(file.model().meshes.empty());
  std::vector<std::string> notes;
  const RestNodes rest = read_rest(file, read_nodes(file, 1, notes), 1);
  EXPECT_TRUE(rest.is_bound);
  EXPECT_NEAR(length(rest.local[1].translation - skeleton.joints[1].bind.translation), 0, 1e-6);
  EXPECT_FALSE(has_skin(folder / "w.glb"));
  error_of(ErrorKind::file, [&] { read_character(folder / "w.glb"); });
}

TEST(Clip, WhatCannotBeWrittenLeavesNothing) {
  const TemporaryFolder folder;
  const Skeleton skeleton = two_joints();
  Clip clip;
  error_of(ErrorKind::file, [&] { write_clip(clip, skeleton, folder / "w.glb"); });
  clip.poses.assign(2, bind_pose(skeleton));
  clip.poses[1].joints[0].translation[0] = NAN;
  error_of(ErrorKind::file, [&] { write_clip(clip, skeleton, folder / "w.glb"); });
  clip.poses[1].joints.pop_back();
  error_of(ErrorKind::file, [&] { write_clip(clip, skeleton, folder / "w.glb"); });
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

// Under a name of its own: what stands beside the file, or what that links to, is not written over.
TEST(Clip, WritingOneTouchesNothingBesideIt) {
  const TemporaryFolder folder;
  const Skeleton skeleton = two_joints();
  Clip clip;
  clip.poses.assign(2, bind_pose(skeleton));
  put_bytes(folder / "w.glb.tmp", "a user's");
  put_bytes(folder / "precious", "another's");
  std::filesystem::create_symlink(folder / "precious", folder / "x.glb.tmp");
  write_clip(clip, skeleton, folder / "w.glb");
  write_clip(clip, skeleton, folder / "x.glb");
  EXPECT_EQ(testing::read_bytes(folder / "w.glb.tmp"), "a user's");
  EXPECT_EQ(testing::read_bytes(folder / "precious"), "another's");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "x.glb.tmp"));
  ASSERT_EQ(mkfifo((folder / "pipe.glb").c_str(), 0600), 0);
  error_of(ErrorKind::file, [&] { write_clip(clip, skeleton, folder / "pipe.glb"); });
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe.glb"));
}

// Linear blend skinning, the textbook way.
Positions skinned(const Character& c, const Pose& pose) {
  const std::vector<Affine> matrices = skinning_matrices(c.skeleton, pose.joints);
  Positions result = Positions::Zero(c.vertices.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const Vec3 rest{c.vertices(v, 0), c.vertices(v, 1), c.vertices(v, 2)};
    for (const JointWeight& w : c.weights[static_cast<std::size_t>(v)]) {
      const Vec3 p = matrices[w.joint] * rest;
      for (int i = 0; i < 3; ++i) result(v, i) += w.weight * p[static_cast<std::size_t>(i)];
    }
  }
  return result;
}

TEST(Clip, RealHumanStandsInItsOwnClip) {
  const auto path = shared_data("characters/human_muscular.glb");
  if (!path) GTEST_SKIP() << kNeedsOtherWriters;
  const Character c = read_character(*path);
  const Clip clip = read_clip(path->string() + "#cmu_01_01", c.skeleton, {.fps = 30});
  EXPECT_EQ(clip.poses.size(), 688u);
  EXPECT_TRUE(clip.notes.empty());
  const Positions posed = skinned(c, clip.poses[0]);
  ASSERT_TRUE(posed.allFinite());
  EXPECT_NEAR(posed.col(1).maxCoeff() - posed.col(1).minCoeff(), 1.8, 0.12);

  // The same motion moves the average build, whose bones keep their own lengths.
  const Character average = read_character(*shared_data("characters/human_average.glb"));
  const Clip carried = read_clip(path->string(), average.skeleton, {.fps = 30});
  const int shin = average.skeleton.find("LeftFoot");
  ASSERT_GE(shin, 0);
  EXPECT_NEAR(length(carried.poses[99].joints[static_cast<std::size_t>(shin)].translation -
                     average.skeleton.joints[static_cast<std::size_t>(shin)].default_local.translation),
              0, 1e-6);
}

TEST(Clip, RealClipsReadAndRoundTrip) {
  const TemporaryFolder folder;
  for (const std::string name : {"cesium_man.glb", "greenman.glb#2_move", "quaternius_horse.glb#Walk",
                                 "quaternius_man.glb#Run", "human_163_joints.glb#tpose", "simple_skin.gltf"}) {
    SCOPED_TRACE(name);
    const auto path = shared_data("characters/" + name.substr(0, name.find('#')));
    if (!path) GTEST_SKIP() << kNeedsOtherWriters;
    const Character c = read_character(*path);
    const Clip clip = read_clip((path->parent_path() / name).string(), c.skeleton, {});
    ASSERT_GT(clip.poses.size(), 1u);
    for (const Pose& pose : {clip.poses.front(), clip.poses.back()}) {
      const Positions posed = skinned(c, pose);
      ASSERT_TRUE(posed.allFinite());
      const double size = box_diagonal(posed);
      const double rest = box_diagonal(c.vertices);
      EXPECT_GT(size, 0.5 * rest);
      EXPECT_LT(size, 2 * rest);
    }
    write_clip(clip, c.skeleton, folder / "again.glb");
    const Clip again = read_clip((folder / "again.glb").string(), c.skeleton, {});
    ASSERT_EQ(again.poses.size(), clip.poses.size());
    EXPECT_LT(pose_difference(clip, again, c.skeleton), 1e-4);
  }
}

// cesium_man rests Z up; its nodes turn it to glTF's Y up.
TEST(Clip, RealCesiumManWalksUpright) {
  const auto path = shared_data("characters/cesium_man.glb");
  if (!path) GTEST_SKIP() << kNeedsOtherWriters;
  const Character c = read_character(*path);
  const Clip clip = read_clip(path->string(), c.skeleton, {});
  const Positions posed = skinned(c, clip.poses[10]);
  EXPECT_NEAR(posed.col(1).maxCoeff() - posed.col(1).minCoeff(), 1.5, 0.1);
}

}  // namespace clip_test
}  // namespace bodyopt
