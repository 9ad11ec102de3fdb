// What the trainer makes of modifiers.json, and what the runtime then shows.
#include "trainer/modifiers/bake_stack.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "assets/caches/pc2.h"
#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "assets/clips/shot_modifiers.h"
#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "runtime/basis/skin_modifiers.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/modifiers/driven_small_basis.h"
#include "tests/support/error_kind.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/same_basis.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/measure_modifiers.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::testing {
namespace bake_stack_test {

using namespace trainer;

namespace fs = std::filesystem;

fs::path write_stack(const TemporaryFolder& folder, const std::string& modifiers) {
  std::ofstream(folder / "stack.json") << R"({"schema": "bodyopt-modifiers-1", "modifiers": [)" << modifiers << "]}";
  return folder / "stack.json";
}

Basis baked(const TemporaryFolder& folder, Basis basis, const std::string& modifiers) {
  std::vector<std::string> notes;
  basis.modifiers = bake_stack(write_stack(folder, modifiers), basis, notes);
  validate(basis, "the test's basis");
  return basis;
}

std::vector<float> shown(const Basis& basis, std::vector<Pose> poses, const std::vector<std::string>& channels = {}) {
  drive_modifiers(basis, channels, 24, poses);
  for (Pose& pose : poses) pose.controls.clear();
  DeviceChoice cpu;
  cpu.name = "cpu";
  return Deformer(basis, cpu).evaluate(poses).positions;
}

void write_shape(const std::vector<float>& points, const fs::path& path) {
  Pc2Writer writer(path, static_cast<std::uint32_t>(points.size() / 3), 1);
  writer.append(points);
  writer.close();
}

float largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  float largest = 0;
  EXPECT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

Pose bent(const Basis& basis, double angle) {
  Pose pose = bind_pose(basis.skeleton);
  pose.joints[1].rotation = axis_angle({0, 0, 1}, angle) * pose.joints[1].rotation;
  return pose;
}

// An artist's mesh of the pose bent by 0.8: 20 mm out around the bend.
struct Sculpted {
  explicit Sculpted(const TemporaryFolder& folder) : basis(small_basis()) {
    Clip clip;
    clip.name = "bend";
    clip.poses = {bind_pose(basis.skeleton), bent(basis, 0.8)};
    write_clip(clip, basis.skeleton, folder / "bend.glb");
    mesh = shown(basis, {bent(basis, 0.8)});
    for (std::size_t o = 0; o < basis.mesh.output_count(); ++o) {
      const float height = basis.mesh.rest[3 * basis.mesh.output_vertex[o] + 1] - 0.5f;
      mesh[3 * o + 2] += 0.02f * std::exp(-height * height / 0.02f);
    }
    write_shape(mesh, folder / "sculpt.pc2");
  }

  Basis basis;
  std::vector<float> mesh;
};

constexpr const char* kSculpt =
    R"({"name": "elbow", "type": "sculpt", "mesh": "sculpt.pc2", "clip": "bend.glb", "frame": 2, "spread_degrees": 30})";

TEST(BakeSculpt, ShowsTheMeshAtItsPoseAndNothingBeyondItsSpread) {
  const TemporaryFolder folder;
  const Sculpted sculpted(folder);
  const Basis basis = baked(folder, sculpted.basis, kSculpt);
  EXPECT_LT(largest_difference(shown(basis, {bent(basis, 0.8)}), sculpted.mesh), 1e-5f);
  const float half =
      largest_difference(shown(basis, {bent(basis, 0.8 - 0.2618)}), shown(sculpted.basis, {bent(basis, 0.8 - 0.2618)}));
  EXPECT_NEAR(half, 0.01f, 0.002f);
  EXPECT_EQ(shown(basis, {bent(basis, 0.2)}), shown(sculpted.basis, {bent(basis, 0.2)}));
  // But where it is asked for.
  std::vector<Pose> always = {bent(basis, 0.2)};
  add_channel(always, {1});
  EXPECT_GT(largest_difference(shown(basis, always, {"elbow.always"}), shown(sculpted.basis, {bent(basis, 0.2)})),
            0.015f);
}

TEST(BakeMorph, ShowsTheMeshAtRest) {
  const TemporaryFolder folder;
  const Basis plain = small_basis();
  std::vector<float> mesh = shown(plain, {bind_pose(plain.skeleton)});
  for (std::size_t o = 0; o < mesh.size() / 3; ++o) mesh[3 * o] *= 1.1f;
  write_shape(mesh, folder / "fat.pc2");
  const Basis basis = baked(folder, plain, R"({"name": "fat", "type": "morph", "mesh": "fat.pc2"})");
  EXPECT_LT(largest_difference(shown(basis, {bind_pose(basis.skeleton)}), mesh), 1e-5f);
}

TEST(BakeFlex, BulgesByAsMuchAsItIsActivated) {
  const TemporaryFolder folder;
  const Basis plain = small_basis();
  Muscle muscle;
  muscle.name = "along";
  muscle.path = {{0, {0, 0.2, 0.06}}, {0, {0, 0.45, 0.07}}};
  muscle.radius = 0.03;
  write_muscles({muscle}, plain.skeleton, folder / "muscles.json");
  const std::string flex = R"({"name": "tense", "type": "flex", "muscles": "muscles.json", "bulge_mm": 4, "muscle": )";
  const Basis basis = baked(folder, plain, flex + "\"along\"}");
  const std::vector<float> rest = shown(plain, {bind_pose(basis.skeleton)});
  EXPECT_EQ(shown(basis, {bind_pose(basis.skeleton)}), rest);  // at ease
  for (const float activation : {1.0f, 0.5f}) {
    std::vector<Pose> poses = {bind_pose(basis.skeleton)};
    add_channel(poses, {activation});
    const std::vector<float> tense = shown(basis, poses, {"tense.activation"});
    float out = 0, away = 0;
    for (std::size_t k = 0; k < rest.size(); k += 3) {
      out = std::max(out, tense[k + 2] - rest[k + 2]);
      if (rest[k + 2] < 0) away = std::max(away, std::abs(tense[k + 2] - rest[k + 2]));  // behind the limb
    }
    EXPECT_NEAR(out, 0.004f * activation, 2e-5f);
    EXPECT_LT(away, 2e-4f);
  }
  EXPECT_THROW(baked(folder, plain, flex + "\"across\"}"), Error);
  muscle.path = {{0, {3, 0.2, 0}}, {0, {3, 0.45, 0}}};
  write_muscles({muscle}, plain.skeleton, folder / "muscles.json");
  EXPECT_EQ(kind_of([&] { baked(folder, plain, flex + "\"along\"}"); }), ErrorKind::mismatch);
}

TEST(BakeStack, IsKeptInTheFileAndOldFilesStayAsTheyWere) {
  const TemporaryFolder folder;
  const Sculpted sculpted(folder);
  const Basis basis = baked(folder, sculpted.basis, kSculpt);
  save_basis(basis, folder / "with.safetensors");
  EXPECT_EQ(difference(load_basis(folder / "with.safetensors"), basis), "");
  save_basis(sculpted.basis, folder / "without.safetensors");
  EXPECT_TRUE(load_basis(folder / "without.safetensors").modifiers.empty());
}

TEST(BakeStack, RefusesWhatDoesNotSuit) {
  const TemporaryFolder folder;
  const Sculpted sculpted(folder);
  const auto refused = [&](const std::string& modifiers, const std::string& said) {
    try {
      baked(folder, sculpted.basis, modifiers);
      ADD_FAILURE() << "took " << modifiers;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
    }
  };
  refused("", "no modifiers");
  refused(R"({"name": "b", "type": "levitation"})", "levitation");
  refused(R"({"name": "b", "type": "breathing"})", "as the hips");
  refused(R"({"name": "breath", "type": "breathing"})", "trained with");
  refused(R"({"name": "b", "type": "breathing", "rate": 3})", "unknown key 'rate'");
  refused(R"({"name": "b", "type": "breathing", "controls": {"rat": 3}})", "unknown control 'rat'");
  refused(std::string(kSculpt) + "," + kSculpt, "of another");
  write_shape(std::vector<float>(30, 0.0f), folder / "other.pc2");
  refused(R"({"name": "m", "type": "morph", "mesh": "other.pc2"})", "of another mesh");
  refused(R"({"name": "m", "type": "morph"})", "needs either");
}

TEST(BakeStack, DamagedStacksAreRefused) {
  const TemporaryFolder folder;
  const Sculpted sculpted(folder);
  const std::string text = std::string(R"({"schema": "bodyopt-modifiers-1", "modifiers": [)") + kSculpt + "]}";
  const auto bake = [&](const fs::path& path) {
    std::vector<std::string> notes;
    bake_stack(path, sculpted.basis, notes);
  };
  expect_every_truncation_refused(bake, folder / "stack.json", text);
}

// As a file of a defective program may hold it: each is refused when the basis is read.
TEST(BakeStack, ForgedTablesAreRefused) {
  const TemporaryFolder folder;
  const Sculpted sculpted(folder);
  const Basis sound = baked(folder, sculpted.basis, kSculpt);
  const auto refused = [&](const std::function<void(SkinModifiers&)>& forge) {
    Basis forged = sound;
    forge(forged.modifiers);
    EXPECT_EQ(kind_of([&] { validate(forged, "forged"); }), ErrorKind::file);
  };
  refused([](SkinModifiers& m) { m.blend[0].scale_coefficient |= 7u << 16; });  // a component that is not there
  refused([](SkinModifiers& m) { m.blend[0].scale_coefficient |= 0x7c00; });    // an infinite scale
  refused([](SkinModifiers& m) { m.blend_begin.pop_back(); });
  refused([](SkinModifiers& m) { m.blend_begin[1] = 1u << 30; });
  refused([](SkinModifiers& m) { m.stack[0].joints.push_back(99); });
  refused([](SkinModifiers& m) { m.stack[0].numbers[0] = std::numeric_limits<float>::infinity(); });
  refused([](SkinModifiers& m) { m.stack[0].component_count = 0xffffffffu; });
  refused([](SkinModifiers& m) { m.stack[0].first_component = 3; });  // nobody has those before

  refused([](SkinModifiers& m) { m.stack[0].turns.push_back({99, 0, 0, 0, 0}); });
  refused([](SkinModifiers& m) { m.stack.push_back(m.stack[0]); });  // twice the same components
  refused([](SkinModifiers& m) { m.stack.clear(); });                // tables of none
  refused([](SkinModifiers& m) { m.stack[0].name.clear(); });
  for (const char* text : {"{}", "[1]", "[{}]", "[{\"name\": 3}]", "[", ""}) {
    EXPECT_EQ(kind_of([&] { stack_from_text(text, "the metadata of a file"); }), ErrorKind::file) << text;
  }
}

TEST(ChooseModifiers, ReordersSwitchesAndSetsConstants) {
  const TemporaryFolder folder;
  const Sculpted sculpted(folder);
  write_shape(sculpted.mesh, folder / "other.pc2");
  Basis basis =
      baked(folder, sculpted.basis,
            std::string(kSculpt) + R"(, {"name": "m", "type": "morph", "mesh": "other.pc2", "strength": 0.5})");
  choose_modifiers(write_stack(folder, R"({"name": "m", "on": false}, {"name": "elbow", "controls": {"always": 1}})"),
                   basis.modifiers);
  ASSERT_EQ(basis.modifiers.stack.size(), 2u);
  EXPECT_EQ(basis.modifiers.stack[0].name, "m");
  EXPECT_FALSE(basis.modifiers.stack[0].on);
  EXPECT_EQ(basis.modifiers.stack[0].constants.at("strength"), 0.5f);
  EXPECT_EQ(basis.modifiers.stack[1].constants.at("always"), 1);
  validate(basis, "reordered");
  const auto refuse = [&](const std::string& text) {
    return kind_of([&] { choose_modifiers(write_stack(folder, text), basis.modifiers); });
  };
  EXPECT_EQ(refuse(R"({"name": "arm"})"), ErrorKind::mismatch);
  EXPECT_EQ(refuse(R"({"name": "m"}, {"name": "m"})"), ErrorKind::mismatch);
  EXPECT_EQ(refuse(R"({"name": "m", "strength": 9})"), ErrorKind::file);
}

TEST(SetChannels, ReplacesWhatTheClipHas) {
  Clip clip;
  clip.controls = {"breath"};
  clip.poses.resize(2);
  for (Pose& pose : clip.poses) pose.controls = {0.25f};
  set_channels({"breath=0.5", "breath.rate=20"}, {"breath", "breath.rate"}, clip);
  EXPECT_EQ(clip.controls, (std::vector<std::string>{"breath", "breath.rate"}));
  EXPECT_EQ(clip.poses[1].controls, (std::vector<float>{0.5f, 20}));
  for (const char* bad : {"breath", "breath=", "=1", "breath=nan", "breath=1x", "breth=1"}) {
    EXPECT_EQ(kind_of([&] { set_channels({bad}, {"breath"}, clip); }), ErrorKind::usage) << bad;
  }
}

// The hero is 1.75 m tall. What it gains is measured on the skin that the runtime shows.
TEST(BakeBreathing, AHumanBreathesWithinPublishedRanges) {
  const auto file = shared_data("characters/human_muscular.glb");
  if (!file) GTEST_SKIP() << kNeedsRealBodies;
  const TemporaryFolder folder;
  TrainOptions options;
  options.smoothing_steps = 4;  // quick; at rest it makes no difference
  const Basis plain = build_ddm_basis(read_character(*file), options);
  const Basis basis = baked(folder, plain, R"({"name": "breath", "type": "breathing"})");
  const std::vector<BreathMeasure> breaths = measure_breathing(basis, basis.modifiers.stack[0]);
  ASSERT_EQ(breaths.size(), 2u);
  EXPECT_NEAR(breaths[0].litres, 0.5, 0.1);
  EXPECT_GE(breaths[0].girth_share, 0.02);
  EXPECT_LE(breaths[0].girth_share, 0.05);
  EXPECT_GE(breaths[0].belly_mm, 10);
  EXPECT_NEAR(breaths[1].litres, 2.5, 0.5);
  EXPECT_LE(breaths[1].girth_share, 0.12);
  EXPECT_LE(breaths[1].belly_mm, 40);
  // By the runtime, a quiet breath in: the volume of the skin that it shows.
  Pose pose = bind_pose(basis.skeleton);
  pose.modifiers = {0.3f, 0.2f};
  DeviceChoice cpu;
  cpu.name = "cpu";
  const auto volume = [&](const Pose& p) {
    const std::vector<float> skin = Deformer(basis, cpu).evaluate({&p, 1}).positions;
    Positions points = rows_of(basis.mesh.rest);
    for (std::size_t o = 0; o < basis.mesh.output_vertex.size(); ++o) {
      for (std::size_t i = 0; i < 3; ++i) {
        points(basis.mesh.output_vertex[o], static_cast<Eigen::Index>(i)) = static_cast<double>(skin[3 * o + i]);
      }
    }
    return enclosed_volume(points, rows_of(basis.mesh.triangles));
  };
  EXPECT_NEAR(1e3 * (volume(pose) - volume(bind_pose(basis.skeleton))), 0.5, 0.02);
  // Hands and feet stay.
  std::vector<Pose> poses(40, bind_pose(basis.skeleton));
  const std::vector<float> moved = shown(basis, poses), still = shown(plain, {bind_pose(basis.skeleton)});
  float feet = 0;
  for (std::size_t k = 0; k < still.size(); k += 3) {
    if (still[k + 1] < 0) feet = std::max(feet, std::abs(moved[moved.size() - still.size() + k + 2] - still[k + 2]));
  }
  EXPECT_LT(feet, 1e-3f);
}

// Its trunk is long and slender: by the trunk's length alone the belly would come out by 44 mm.
TEST(BakeBreathing, ASlenderBellyStaysWithinItsRange) {
  const auto file = shared_data("characters/human_163_joints.glb");
  if (!file) GTEST_SKIP() << kNeedsRealBodies;
  const TemporaryFolder folder;
  TrainOptions options;
  options.smoothing_steps = 4;
  const Basis basis =
      baked(folder, build_ddm_basis(read_character(*file), options), R"({"name": "breath", "type": "breathing"})");
  const std::vector<BreathMeasure> breaths = measure_breathing(basis, basis.modifiers.stack[0]);
  EXPECT_GE(breaths[0].belly_mm, 10);
  EXPECT_LE(breaths[1].belly_mm, 40);
  EXPECT_GE(breaths[0].litres, 0.4);
  EXPECT_LE(breaths[0].litres, 0.605);
  EXPECT_GE(breaths[1].litres, 2);
}

}  // namespace bake_stack_test
}  // namespace bodyopt::testing
