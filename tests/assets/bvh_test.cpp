#include "assets/clips/bvh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "runtime/host/rig.h"
#include "tests/assets/gltf_blob.h"
#include "tests/support/shared_data.h"

namespace bodyopt {
namespace {

constexpr double kPi = std::numbers::pi;

const std::string kSmall =
    "HIERARCHY\n"
    "ROOT hips\n{\n  OFFSET 0 0 0\n  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    "  JOINT chest\n  {\n    OFFSET 0 10 0\n    CHANNELS 3 Yrotation Zrotation Xrotation\n"
    "    JOINT head\n    {\n      OFFSET 0 5 2\n      CHANNELS 0\n      End Site\n      {\n        OFFSET 0 1 0\n      "
    "}\n    }\n  }\n"
    "}\n"
    "MOTION\nFrames: 2\nFrame Time: 0.5\n"
    "1 2 3 0 0 0 0 0 0\n"
    "3 2 +3e0 90 0 0 10 20 30\n";

Skeleton small_skeleton();

Bvh parse(const TemporaryFolder& folder, const std::string& text) {
  put_bytes(folder / "a.bvh", text);
  return read_bvh(folder / "a.bvh");
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

TEST(Bvh, ReadsTheHierarchyAndChannelsInTheirOrder) {
  const TemporaryFolder folder;
  const Bvh bvh = parse(folder, kSmall);
  ASSERT_EQ(bvh.joints.size(), 3u);
  EXPECT_EQ(bvh.joints[2].name, "head");
  EXPECT_EQ(bvh.joints[2].parent, 1);
  EXPECT_EQ(bvh.joints[2].offset, (Vec3{0, 5, 2}));
  EXPECT_EQ(bvh.frame_count, 2u);
  EXPECT_EQ(bvh.duration(), 0.5);
  EXPECT_EQ(bvh.local(0, 1).translation, (Vec3{3, 2, 3}));

  // chest, frame 1: Ry(10) Rz(20) Rx(30), multiplied out by hand as rotations about fixed axes, the last first.
  const auto turn = [](const Vec3& v, int axis, double degrees) {
    const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
    const auto i = static_cast<std::size_t>((axis + 1) % 3), j = static_cast<std::size_t>((axis + 2) % 3);
    Vec3 r = v;
    r[i] = c * v[i] - s * v[j];
    r[j] = s * v[i] + c * v[j];
    return r;
  };
  const Vec3 v{1, 2, 3}, expected = turn(turn(turn(v, 0, 30), 2, 20), 1, 10);
  EXPECT_NEAR(length(rotate(bvh.local(1, 1).rotation, v) - expected), 0, 1e-12);

  const JointTransform half = bvh.local_at(0, 0.25);
  EXPECT_NEAR(half.translation[0], 2, 1e-12);
  EXPECT_NEAR(rotate(half.rotation, {1, 0, 0})[1], std::sqrt(0.5), 1e-12);
  EXPECT_EQ(bvh.local_at(0, 99).translation, (Vec3{3, 2, 3}));
}

TEST(Bvh, ReadsOtherSpellings) {
  const TemporaryFolder folder;
  std::string text = replaced(kSmall, "ROOT hips\n{", "root My Hips {");
  text = replaced(text, "End Site\n", "End Site ");
  EXPECT_EQ(parse(folder, text).joints[0].name, "My Hips");
  std::string windows;
  for (const char c : kSmall) windows += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(parse(folder, windows).joints[2].name, "head");
}

std::string utf16(const std::string& text, bool is_big, bool has_mark) {
  std::string wide = !has_mark ? "" : is_big ? "\xfe\xff" : "\xff\xfe";
  for (const char c : text) wide += is_big ? std::string{'\0', c} : std::string{c, '\0'};
  return wide;
}

// Byte order marks, UTF-16, what DOS and fixed sizes leave behind, gaps where others have none.
TEST(Bvh, ReadsWhatEditorsAndProgramsMakeOfText) {
  const TemporaryFolder folder;
  std::vector<std::string> texts = {"\xef\xbb\xbf" + kSmall, kSmall + "\x1a", kSmall + std::string(9, '\0') + "\r\n"};
  for (const bool is_big : {false, true}) {
    for (const bool has_mark : {false, true}) texts.push_back(utf16(kSmall, is_big, has_mark));
  }
  texts.push_back(replaced(replaced(kSmall, "Frames: 2", "FRAMES:2"), "Time: 0.5", "Time:0.5"));
  texts.push_back(replaced(kSmall, "{\n  OFFSET 0 0 0", "{OFFSET 0 0 0"));
  for (const std::string& text : texts) {
    const Bvh bvh = parse(folder, text);
    EXPECT_EQ(bvh.joints.size(), 3u);
    EXPECT_EQ(bvh.values.back(), 30);
    EXPECT_TRUE(bvh.notes.empty());
  }
  error_of(ErrorKind::file, [&] { parse(folder, std::string("\xff\xfe\x00\xd8H", 5)); });
}

// Writers that are stopped, or write on, declare another number of frames than there are.
TEST(Bvh, FramesMayBeMoreOrFewerThanDeclared) {
  const TemporaryFolder folder;
  for (const auto& [declared, read] : {std::pair{0, 2u}, {1, 1u}, {3, 2u}, {400000000, 2u}}) {
    const Bvh bvh = parse(folder, replaced(kSmall, "Frames: 2", "Frames: " + std::to_string(declared)));
    EXPECT_EQ(bvh.frame_count, read) << declared;
    EXPECT_EQ(bvh.values.size(), 9 * read) << declared;
    EXPECT_TRUE(mentions(bvh.notes, "and holds 2; " + std::to_string(read) + " are read")) << declared;
  }
  const Skeleton skeleton = small_skeleton();
  put_bytes(folder / "a.bvh", replaced(kSmall, "Frames: 2", "Frames: 1"));
  EXPECT_TRUE(mentions(read_clip((folder / "a.bvh").string(), skeleton, {}).notes, "declares 1 frames and holds 2"));
}

// Cut between frames, the file has those before.
TEST(Bvh, TruncationIsAnErrorOrSaid) {
  const TemporaryFolder folder;
  const std::size_t second = kSmall.find("3 2 +3e0");
  // Cutting inside the very last number leaves a complete file with another number.
  for (std::size_t length = 0; length + 3 < kSmall.size(); ++length) {
    SCOPED_TRACE(length);
    if (length + 1 < second || length > second) {
      error_of(ErrorKind::file, [&] { parse(folder, kSmall.substr(0, length)); });
    } else {
      EXPECT_TRUE(mentions(parse(folder, kSmall.substr(0, length)).notes, "declares 2 frames and holds 1"));
    }
  }
  error_of(ErrorKind::file, [&] { read_bvh(folder / "absent.bvh"); });
  error_of(ErrorKind::file, [&] { read_bvh(folder / ""); });
}

TEST(Bvh, HostileTextIsAnError) {
  const TemporaryFolder folder;
  const std::pair<const char*, const char*> damages[] = {
      {"HIERARCHY", "HIERARCHIE"},
      {"ROOT", "JOINT"},
      {"ROOT hips", "ROOT"},
      {"OFFSET 0 10 0", "OFFSET 0 nan 0"},
      {"OFFSET 0 10 0", "OFFSET 0 inf 0"},
      {"OFFSET 0 10 0", "OFFSET 0 1e999 0"},
      {"OFFSET 0 10 0", "OFFSET 0 10"},
      {"OFFSET 0 10 0", "OFFSET 0 10 0x"},
      {"CHANNELS 6", "CHANNELS 7"},
      {"CHANNELS 6", "CHANNELS 5"},
      {"CHANNELS 6", "CHANNELS -6"},
      {"CHANNELS 6", "CHANNELS 6.5"},
      {"CHANNELS 6", "CHANNELS 99999999999999999999"},
      {"Xposition", "Wposition"},
      {"Yposition", "Xposition"},
      {"CHANNELS 0", "CHANNELS 1 Xrotation"},
      {"End Site", "Fin Site"},
      {"MOTION", "}"},
      {"MOTION", "ROOT"},
      {"Frames: 2", "Frames: -1"},
      {"Frames: 2", "Frames: 1.5"},
      {"Frames: 2", "Frames: 18446744073709551615"},
      {"Frame Time: 0.5", "Frame Time: 0"},
      {"Frame Time: 0.5", "Frame Time: -1"},
      {"Frame Time: 0.5", "Frame Time: nan"},
      {"1 2 3 0", "1 2 NaN 0"},
      {"1 2 3 0", "1 2 3 0 0"},
      {"1 2 3 0", "1 2 -inf 0"},
  };
  for (const auto& [what, with] : damages) {
    SCOPED_TRACE(std::string(what) + " -> " + with);
    error_of(ErrorKind::file, [&, what = what, with = with] { parse(folder, replaced(kSmall, what, with)); });
  }
  error_of(ErrorKind::file, [&] { parse(folder, std::string("\0\xff\xfe", 3)); });
  std::string deep = "HIERARCHY ROOT a\n{ OFFSET 0 0 0 CHANNELS 0 ";
  for (int i = 0; i < 100000; ++i) deep += "JOINT a\n{ OFFSET 0 0 0 CHANNELS 0 ";
  error_of(ErrorKind::file, [&] { parse(folder, deep); });
}

TEST(Bvh, MotionTooLongIsAnError) {
  const TemporaryFolder folder;
  put_bytes(folder / "a.bvh", replaced(kSmall, "Frame Time: 0.5", "Frame Time: 1e300"));
  Skeleton skeleton;
  skeleton.joints.resize(2);
  skeleton.joints[0].name = "hips";
  skeleton.joints[1].name = "head";
  skeleton.joints[1].parent = 0;
  skeleton.joints[1].bind.translation = {0, 1, 0};
  error_of(ErrorKind::file, [&] { read_clip((folder / "a.bvh").string(), skeleton, {}); });
}

// hips at (0, 1, 0), chest 1 m above, head 0.5 m above and 0.2 m in front: kSmall in decimetres. Joint axes are turned
// in the bind pose, as rigs do.
Skeleton small_skeleton() {
  Skeleton skeleton;
  skeleton.joints.resize(3);
  const char* names[] = {"hips", "Chest", "head"};
  const Vec3 positions[] = {{0, 1, 0}, {0, 2, 0}, {0, 2.5, 0.2}};
  for (std::size_t j = 0; j < 3; ++j) {
    JointTransform world;
    world.translation = positions[j];
    world.rotation = axis_angle({1, 2, 3}, 0.7 * static_cast<double>(j + 1));
    Joint& joint = skeleton.joints[j];
    joint.name = names[j];
    joint.parent = static_cast<int>(j) - 1;
    joint.inverse_bind = inverse(affine_from(world));
    joint.bind = decompose(j == 0 ? affine_from(world) : skeleton.joints[j - 1].inverse_bind * affine_from(world));
    joint.default_local = joint.bind;
  }
  return skeleton;
}

// Where the skinning carries a point of the rest pose.
Vec3 carried(const Skeleton& skeleton, const Pose& pose, std::size_t joint, const Vec3& rest) {
  return skinning_matrices(skeleton, pose.joints)[joint] * rest;
}

TEST(Bvh, CarriesRotationsAndPositionsToASkeleton) {
  const TemporaryFolder folder;
  put_bytes(folder / "a.bvh", kSmall);
  const Skeleton skeleton = small_skeleton();
  const Clip clip = read_clip((folder / "a.bvh").string(), skeleton, {.fps = 4, .first_frame = 5});
  ASSERT_EQ(clip.poses.size(), 3u);
  EXPECT_EQ(clip.first_frame, 5);
  EXPECT_TRUE(mentions(clip.notes, "without regard to case: 'Chest'"));
  EXPECT_TRUE(mentions(clip.notes, "0.1 m"));

  // First frame: no rotation, the hips at (0.1, 0.2, 0.3).
  const Vec3 shift{0.1, -0.8, 0.3};
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_NEAR(length(carried(skeleton, clip.poses[0], j, {1, 2, 3}) - (Vec3{1, 2, 3} + shift)), 0, 1e-9);
  }
  // Last frame: hips turned a quarter about z at (0.3, 0.2, 0.3).
  const Vec3 chest = carried(skeleton, clip.poses[2], 0, {0, 2, 0});
  EXPECT_NEAR(length(chest - Vec3{-0.7, 0.2, 0.3}), 0, 1e-9);
  // Half way: an eighth of a turn, half the way.
  EXPECT_NEAR(
      length(carried(skeleton, clip.poses[1], 0, {0, 2, 0}) - Vec3{0.2 - std::sqrt(0.5), 0.2 + std::sqrt(0.5), 0.3}), 0,
      1e-9);
  // A point 1 m above the chest's joint follows hips * Ry(10) Rz(20) Rx(30).
  const Quat chest_turn = axis_angle({0, 0, 1}, kPi / 2) * axis_angle({0, 1, 0}, 10 * kPi / 180) *
                          axis_angle({0, 0, 1}, 20 * kPi / 180) * axis_angle({1, 0, 0}, 30 * kPi / 180);
  EXPECT_NEAR(length(carried(skeleton, clip.poses[2], 1, {0, 3, 0}) - (chest + rotate(chest_turn, {0, 1, 0}))), 0,
              1e-9);
  // The head has no channels: it follows the chest.
  EXPECT_NEAR(length(carried(skeleton, clip.poses[2], 2, {0, 3, 0}) - (chest + rotate(chest_turn, {0, 1, 0}))), 0,
              1e-9);
}

// The same figure with Z up, facing -Y, must move the skeleton as the Y-up one does.
TEST(Bvh, ZUpGivesTheSameMotion) {
  const TemporaryFolder folder;
  put_bytes(folder / "y.bvh", kSmall);
  // y -> z, z -> -y: offsets (0, 10, 0) -> (0, 0, 10), (0, 5, 2) -> (0, -2, 5); channels: Y becomes Z, Z becomes -Y.
  std::string text = kSmall;
  text = replaced(text, "Xposition Yposition Zposition Zrotation Xrotation Yrotation",
                  "Xposition Zposition Yposition Yrotation Xrotation Zrotation");
  text = replaced(text, "OFFSET 0 10 0", "OFFSET 0 0 10");
  text = replaced(text, "OFFSET 0 5 2", "OFFSET 0 -2 5");
  text = replaced(text, "Yrotation Zrotation Xrotation", "Zrotation Yrotation Xrotation");
  text = replaced(text, "1 2 3 0 0 0 0 0 0", "1 2 -3 0 0 0 0 0 0");
  text = replaced(text, "3 2 +3e0 90 0 0 10 20 30", "3 2 -3 -90 0 0 10 -20 30");
  put_bytes(folder / "z.bvh", text);
  const Skeleton skeleton = small_skeleton();
  const Clip y = read_clip((folder / "y.bvh").string(), skeleton, {});
  const Clip z = read_clip((folder / "z.bvh").string(), skeleton, {});
  EXPECT_TRUE(mentions(z.notes, "turned to the character's axes"));
  EXPECT_FALSE(mentions(y.notes, "turned to the character's axes"));
  ASSERT_EQ(y.poses.size(), z.poses.size());
  for (std::size_t k = 0; k < y.poses.size(); ++k) {
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(length(carried(skeleton, y.poses[k], j, {1, 2, 3}) - carried(skeleton, z.poses[k], j, {1, 2, 3})), 0,
                  1e-9);
    }
  }
}

TEST(Bvh, PositionsOfInnerJointsMoveThem) {
  const TemporaryFolder folder;
  std::string text = replaced(kSmall, "CHANNELS 3 Yrotation Zrotation Xrotation",
                              "CHANNELS 6 Xposition Yposition Zposition Yrotation Zrotation Xrotation");
  text = replaced(text, "1 2 3 0 0 0 0 0 0", "0 10 0 0 0 0 0 10 0 0 0 0");
  text = replaced(text, "3 2 +3e0 90 0 0 10 20 30", "0 10 0 90 0 0 2 11 0 0 0 0");
  put_bytes(folder / "a.bvh", text);
  const Skeleton skeleton = small_skeleton();
  const Clip clip = read_clip((folder / "a.bvh").string(), skeleton, {.fps = 2});
  EXPECT_NEAR(length(carried(skeleton, clip.poses[0], 1, {1, 2, 3}) - Vec3{1, 2, 3}), 0, 1e-9);
  // The chest sits at (0.2, 1.1, 0) from the hips, which are turned a quarter about z.
  EXPECT_NEAR(length(carried(skeleton, clip.poses[1], 1, {0, 2, 0}) - Vec3{-1.1, 1.2, 0}), 0, 1e-9);
}

TEST(Bvh, StatedUnitIsTaken) {
  const TemporaryFolder folder;
  put_bytes(folder / "a.bvh", kSmall);
  const Skeleton skeleton = small_skeleton();
  const Clip clip = read_clip((folder / "a.bvh").string(), skeleton, {.unit = 1});
  EXPECT_NEAR(length(carried(skeleton, clip.poses[0], 0, {0, 1, 0}) - Vec3{1, 2, 3}), 0, 1e-9);
}

// Lengths may be in position channels alone.
TEST(Bvh, OffsetsMayBeZeroBesidePositions) {
  const TemporaryFolder folder;
  std::string text = replaced(kSmall, "CHANNELS 3 Yrotation", "CHANNELS 6 Xposition Yposition Zposition Yrotation");
  text = replaced(replaced(text, "1 2 3 0 0 0 0", "1 2 3 0 0 0 0 10 0 0"), "90 0 0 10", "90 0 0 0 10 0 10");
  put_bytes(folder / "lengths.bvh", text);
  put_bytes(folder / "none.bvh", replaced(text, "OFFSET 0 10 0", "OFFSET 0 0 0"));
  const Skeleton skeleton = small_skeleton();
  const Clip expected = read_clip((folder / "lengths.bvh").string(), skeleton, {}),
             clip = read_clip((folder / "none.bvh").string(), skeleton, {});
  for (std::size_t k = 0; k < expected.poses.size(); ++k) {
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec3 at = carried(skeleton, clip.poses[k], j, {1, 2, 3});
      EXPECT_NEAR(length(at - carried(skeleton, expected.poses[k], j, {1, 2, 3})), 0, 1e-9);
    }
  }
  put_bytes(folder / "flat.bvh",
            replaced(replaced(kSmall, "OFFSET 0 10 0", "OFFSET 0 0 0"), "OFFSET 0 5 2", "OFFSET 0 0 0"));
  const std::string message =
      error_of(ErrorKind::mismatch, [&] { read_clip((folder / "flat.bvh").string(), skeleton, {}); });
  EXPECT_NE(message.find("all its OFFSETs are zero"), std::string::npos) << message;
}

TEST(Bvh, TheAxisThatIsUpCanBeSaid) {
  const TemporaryFolder folder;
  put_bytes(folder / "a.bvh", kSmall);
  const std::string path = (folder / "a.bvh").string();
  const Skeleton skeleton = small_skeleton();
  for (const char* up : {"x", "y", "z", "-x", "-y", "-z"}) {
    const Clip clip = read_clip(path, skeleton, {.up = up});
    const Vec3 trunk = posed_joints(skeleton, clip.poses[0].joints)[1] * Vec3{0, 0, 0} -
                       posed_joints(skeleton, clip.poses[0].joints)[0] * Vec3{0, 0, 0};
    const double sign = up[0] == '-' ? -1 : 1;
    EXPECT_NEAR(trunk[1], std::string(up).back() == 'y' ? sign : 0, 1e-9) << up;
  }
  error_of(ErrorKind::usage, [&] { read_clip(path, skeleton, {.up = "up"}); });
  error_of(ErrorKind::usage, [&] { read_clip(path, skeleton, {.up = "-"}); });
}

TEST(Bvh, StrangersAreAMismatch) {
  const TemporaryFolder folder;
  put_bytes(folder / "a.bvh", kSmall);
  Skeleton skeleton = small_skeleton();
  for (Joint& joint : skeleton.joints) joint.name = "x" + joint.name;
  const std::string text = error_of(ErrorKind::mismatch, [&] { read_clip((folder / "a.bvh").string(), skeleton, {}); });
  EXPECT_NE(text.find("'xhips'"), std::string::npos);
  EXPECT_NE(text.find("'chest'"), std::string::npos);
  skeleton.joints[0].name = "hips";  // one match gives no bone to fit the unit with
  error_of(ErrorKind::mismatch, [&] { read_clip((folder / "a.bvh").string(), skeleton, {}); });
  EXPECT_EQ(read_clip((folder / "a.bvh").string(), skeleton, {.unit = 0.1}).poses.size(), 13u);
  error_of(ErrorKind::file, [&] { read_clip((folder / "a.bvh").string() + "#walk", skeleton, {}); });
}

// Of the bone from a joint to its first child, between two poses.
double cosine_of_bones(const Skeleton& skeleton, const Pose& a, const Pose& b, const char* name) {
  const auto joint = static_cast<std::size_t>(skeleton.find(name));
  std::size_t child = joint + 1;
  while (skeleton.joints[child].parent != static_cast<int>(joint)) ++child;
  const auto bone = [&](const Pose& pose) {
    const std::vector<Affine> posed = posed_joints(skeleton, pose.joints);
    return posed[child] * Vec3{0, 0, 0} - posed[joint] * Vec3{0, 0, 0};
  };
  const Vec3 u = bone(a), v = bone(b);
  return dot(u, v) / (length(u) * length(v));
}

// Another rest pose of the character changes its joints' rotations, not where they are.
TEST(Bvh, OtherRestPosesAreAligned) {
  const TemporaryFolder folder;
  Skeleton skeleton = small_skeleton();
  put_bytes(folder / "a.bvh", kSmall);
  const Clip upright = read_clip((folder / "a.bvh").string(), skeleton, {});
  const Quat bend = axis_angle({0.6, 0, 0.8}, 0.6);
  skeleton.joints[0].bind.rotation = bend * skeleton.joints[0].bind.rotation;
  const Clip bent = read_clip((folder / "a.bvh").string(), skeleton, {});
  EXPECT_TRUE(mentions(bent.notes, "laid along each other"));
  ASSERT_EQ(bent.poses.size(), upright.poses.size());
  for (std::size_t k = 0; k < bent.poses.size(); ++k) {
    const std::vector<Affine> a = posed_joints(skeleton, bent.poses[k].joints),
                              b = posed_joints(skeleton, upright.poses[k].joints);
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(length(a[j] * Vec3{0, 0, 0} - b[j] * Vec3{0, 0, 0}), 0, 1e-5) << k << ' ' << j;
    }
  }
}

TEST(Bvh, RealMotionMovesTheRealHuman) {
  const auto human = shared_data("characters/human_muscular.glb");
  const auto matching = shared_data("motion/01_01.bvh"), other = shared_data("motion/131_01.bvh");
  if (!human || !matching || !other) GTEST_SKIP() << kNeedsRealMotion;
  const Skeleton skeleton = read_character(*human).skeleton;
  const Clip clip = read_clip(matching->string(), skeleton, {.fps = 30});
  EXPECT_EQ(clip.poses.size(), 688u);
  EXPECT_TRUE(mentions(clip.notes,
                       "naming convention: 'LeftHandIndex1' moves 'LeftHandFinger1', 'RightHandIndex1' moves "
                       "'RightHandFinger1'."));
  const auto head = static_cast<std::size_t>(skeleton.find("Head")),
             foot = static_cast<std::size_t>(skeleton.find("LeftFoot"));
  for (std::size_t k = 0; k < clip.poses.size(); k += 43) {
    const std::vector<Affine> posed = posed_joints(skeleton, clip.poses[k].joints);
    const double height = posed[head].m[1][3] - posed[foot].m[1][3];
    EXPECT_GT(height, 0.8) << k;  // he jumps and lands, never lies down
    EXPECT_LT(height, 1.8) << k;
    EXPECT_GT(posed[0].m[1][3], 0.5);
    EXPECT_LT(posed[0].m[1][3], 2.2);
  }
  // The BVH and the hero's own clip of this motion turn the hips alike and point the limbs the same way, though the
  // hero rests with other arms.
  const Clip own = read_clip(human->string(), skeleton, {.fps = 30});
  for (std::size_t k = 1; k < 688; k += 97) {
    const Quat &a = own.poses[k].joints[0].rotation, &b = clip.poses[k].joints[0].rotation;
    EXPECT_GT(std::abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]), 0.999) << k;
    for (const char* joint : {"LeftArm", "LeftForeArm", "RightForeArm", "LeftUpLeg", "LeftLeg", "RightLeg"}) {
      EXPECT_GT(cosine_of_bones(skeleton, own.poses[k], clip.poses[k], joint), 0.99) << k << ' ' << joint;
    }
  }
  // The hip joints never turn, and keep the hero's pelvis.
  for (const char* joint : {"LHipJoint", "RHipJoint"}) {
    const auto j = static_cast<std::size_t>(skeleton.find(joint));
    const Quat &bind = skeleton.joints[j].bind.rotation, &turned = clip.poses[300].joints[j].rotation;
    const double same = bind[0] * turned[0] + bind[1] * turned[1] + bind[2] * turned[2] + bind[3] * turned[3];
    EXPECT_NEAR(std::abs(same), 1, 1e-6) << joint;
  }
}

// Other names, and arms that hang at rest: the whole body moves.
TEST(Bvh, RealMotionOfOtherNamesMovesTheRealHuman) {
  const auto human = shared_data("characters/human_muscular.glb"), motion = shared_data("motion/131_01.bvh");
  if (!human || !motion) GTEST_SKIP() << kNeedsRealMotion;
  const Skeleton skeleton = read_character(*human).skeleton;
  const Clip clip = read_clip(motion->string(), skeleton, {.fps = 30});
  EXPECT_TRUE(mentions(clip.notes, "'LeftCollar' moves 'LeftShoulder', 'LeftShoulder' moves 'LeftArm'"));
  EXPECT_FALSE(mentions(clip.notes, "stay at rest"));
  EXPECT_FALSE(mentions(clip.notes, "does not have"));
  // Where the BVH's own joints are, in frame 60: fencing, the right arm and the left leg stretched out.
  const Bvh bvh = read_bvh(*motion);
  std::map<std::string, Vec3> places;
  std::vector<Affine> world;
  for (std::size_t b = 0; b < bvh.joints.size(); ++b) {
    const Affine own = affine_from(bvh.local_at(b, 59 / 30.0));
    world.push_back(bvh.joints[b].parent < 0 ? own : world[static_cast<std::size_t>(bvh.joints[b].parent)] * own);
    places[bvh.joints[b].name] = world[b] * Vec3{0, 0, 0};
  }
  const std::vector<Affine> posed = posed_joints(skeleton, clip.poses[59].joints);
  const auto place = [&](const char* name) {
    return posed[static_cast<std::size_t>(skeleton.find(name))] * Vec3{0, 0, 0};
  };
  const auto cosine_of = [&](const char* from, const char* to, const char* bvh_from, const char* bvh_to) {
    const Vec3 u = place(to) - place(from), v = places.at(bvh_to) - places.at(bvh_from);
    return dot(u, v) / (length(u) * length(v));
  };
  EXPECT_GT(cosine_of("RightArm", "RightForeArm", "RightShoulder", "RightElbow"), 0.9999);
  EXPECT_GT(cosine_of("LeftForeArm", "LeftHand", "LeftElbow", "LeftWrist"), 0.9999);
  EXPECT_GT(cosine_of("LeftUpLeg", "LeftLeg", "LeftHip", "LeftKnee"), 0.9999);
  EXPECT_GT(cosine_of("RightLeg", "RightFoot", "RightKnee", "RightAnkle"), 0.9999);
}

}  // namespace
}  // namespace bodyopt
