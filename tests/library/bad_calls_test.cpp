// Wrong calls of bodyopt.h: each gives the code and a text that names what is wrong, writes nothing, and leaves the
// instance as it was.
#include <algorithm>
#include <functional>

#include "tests/library/c_api.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace bad_calls_test {

// An instance, a call that works, and copies of it to be spoilt.
class BadCalls : public ::testing::Test {
 protected:
  BadCalls() {
    skin_.positions = floats_in(positions_);
    skin_.normals = floats_in(normals_);
  }

  void expect(bodyopt_result result, bodyopt_result expected, const std::string& said) {
    EXPECT_EQ(result, expected);
    EXPECT_NE(std::string(bodyopt_last_error()).find(said), std::string::npos)
        << bodyopt_last_error() << "\ndoes not say: " << said;
    EXPECT_EQ(positions_, std::vector<float>(positions_.size(), -7.0f)) << said;
  }

  void refuses(const std::function<void(bodyopt_poses&, bodyopt_skin&)>& spoil, bodyopt_result expected,
               const std::string& said) {
    bodyopt_poses poses = given_.all;
    bodyopt_skin skin = skin_;
    spoil(poses, skin);
    expect(bodyopt_evaluate(instance_.get(), &poses, &skin), expected, said);
  }

  const Basis basis_ = load_basis(hero());
  const api::Model model_ = api::load_model(hero());
  const api::Instance instance_ = api::create_instance(model_, api::make<bodyopt_instance_options>());
  PoseArrays given_{turning_poses(basis_, 2)};
  std::vector<float> positions_ = std::vector<float>(6 * basis_.mesh.output_count(), -7.0f), normals_ = positions_;
  bodyopt_skin skin_ = api::make<bodyopt_skin>();
};

TEST_F(BadCalls, OfAFrameAreRefusedAndTheInstanceWorksOn) {
  const std::uint32_t joints = given_.all.joint_count;
  refuses([](auto& poses, auto&) { poses.struct_size = 0; }, BODYOPT_USAGE, "struct_size of 'poses' is 0");
  refuses([](auto& poses, auto&) { poses.struct_size = 4000; }, BODYOPT_USAGE, "another version");
  refuses([](auto&, auto& skin) { skin.struct_size = 8; }, BODYOPT_USAGE, "struct_size of 'skin' is 8");
  refuses([](auto& poses, auto&) { poses.joints = nullptr; }, BODYOPT_USAGE, "'poses.joints' is a null pointer");
  refuses([&](auto& poses, auto&) { poses.joint_count = joints + 1; }, BODYOPT_MISMATCH,
          std::to_string(joints + 1) + " joints, the basis has " + std::to_string(joints));
  refuses([](auto& poses, auto&) { poses.joint_count = 0; }, BODYOPT_MISMATCH, "0 joints");
  refuses([](auto& poses, auto&) { poses.control_count = 9; }, BODYOPT_MISMATCH, "9 controls");
  refuses([](auto& poses, auto&) { poses.joint_stride = 72; }, BODYOPT_USAGE, "poses.joint_stride is 72 bytes");
  refuses([](auto& poses, auto&) { poses.joint_stride = 84; }, BODYOPT_USAGE, "no multiple of 8");
  refuses([](auto& poses, auto&) { poses.joint_frame_stride = 80; }, BODYOPT_USAGE, "poses.joint_frame_stride is 80");
  refuses([](auto& poses, auto&) { poses.joint_frame_stride = ~std::size_t{7}; }, BODYOPT_USAGE, "too large");
  refuses(
      [](auto& poses, auto&) {
        poses.joints = reinterpret_cast<const double*>(1 + reinterpret_cast<std::uintptr_t>(poses.joints));
      },
      BODYOPT_USAGE, "not aligned");
  refuses([](auto&, auto& skin) { skin.positions.element_stride = 8; }, BODYOPT_USAGE,
          "skin.positions.element_stride is 8 bytes, at least 12");
  refuses([](auto&, auto& skin) { skin.positions.element_stride = 14; }, BODYOPT_USAGE, "no multiple of 4");
  refuses([](auto&, auto& skin) { skin.positions.frame_stride = 12; }, BODYOPT_USAGE,
          "skin.positions.frame_stride is 12");
  refuses([](auto&, auto& skin) { skin.positions.size -= 4; }, BODYOPT_USAGE, "are needed for 2 frames");
  refuses([](auto&, auto& skin) { skin.positions.element_stride = ~std::size_t{3}; }, BODYOPT_USAGE, "too large");
  refuses([](auto& poses, auto&) { poses.frame_count = 3; }, BODYOPT_USAGE, "are needed for 3 frames");
  for (const double number : {std::nan(""), HUGE_VAL, 1e300}) {
    PoseArrays spoilt = given_;
    spoilt.joints[12] = number;
    refuses([&](auto& poses, auto&) { poses.joints = spoilt.joints.data(); }, BODYOPT_MISMATCH, "finite");
  }
  PoseArrays unturned = given_;
  for (std::size_t i = 3; i < 7; ++i) unturned.joints[10 + i] = 0;
  refuses([&](auto& poses, auto&) { poses.joints = unturned.joints.data(); }, BODYOPT_MISMATCH, "has the length 0");
  expect(bodyopt_evaluate(nullptr, &given_.all, &skin_), BODYOPT_USAGE, "'instance' is a null pointer");
  expect(bodyopt_evaluate(instance_.get(), nullptr, &skin_), BODYOPT_USAGE, "'poses' is a null pointer");
  expect(bodyopt_evaluate(instance_.get(), &given_.all, nullptr), BODYOPT_USAGE, "'skin' is a null pointer");
  expect(bodyopt_jiggle(instance_.get(), &given_.all, &skin_), BODYOPT_USAGE, "without dynamics");
  expect(bodyopt_set_weights(instance_.get(), std::nanf(""), 1), BODYOPT_USAGE, "finite");
  expect(bodyopt_get_state(instance_.get(), nullptr), BODYOPT_USAGE, "'state' is a null pointer");
  expect(bodyopt_set_state(instance_.get(), nullptr), BODYOPT_USAGE, "does not jiggle");
  ASSERT_EQ(bodyopt_evaluate(instance_.get(), &given_.all, &skin_), BODYOPT_OK);
  EXPECT_NE(positions_[0], -7.0f);
  EXPECT_NE(normals_[0], -7.0f);
}

// Joints without a size, and turned inside out: a skin of numbers all the same.
TEST_F(BadCalls, OfZeroAndReflectedScaleGiveFiniteNumbers) {
  for (const double scale : {0.0, -1.0}) {
    for (std::size_t i = 7; i < 10; ++i) given_.joints[10 + i] = scale;
    api::check(bodyopt_evaluate(instance_.get(), &given_.all, &skin_));
    EXPECT_TRUE(std::ranges::all_of(positions_, [](float x) { return std::isfinite(x); })) << scale;
    EXPECT_TRUE(std::ranges::all_of(normals_, [](float x) { return std::isfinite(x); })) << scale;
  }
}

TEST_F(BadCalls, OfLoadingAndOpeningAreRefused) {
  bodyopt_model* model = nullptr;
  bodyopt_device* device = nullptr;
  bodyopt_instance* instance = nullptr;
  const TemporaryFolder folder;
  expect(bodyopt_load_model(nullptr, nullptr, &model), BODYOPT_USAGE, "'path' is a null pointer");
  expect(bodyopt_load_model(hero().c_str(), nullptr, nullptr), BODYOPT_USAGE, "'model' is a null pointer");
  expect(bodyopt_load_model((folder / "no.safetensors").c_str(), nullptr, &model), BODYOPT_FILE, "no.safetensors");
  expect(bodyopt_load_model(kept_file("limb.glb").c_str(), nullptr, &model), BODYOPT_FILE, "limb.glb");
  auto load = api::make<bodyopt_load_options>();
  load.level = 3;
  expect(bodyopt_load_model(hero().c_str(), &load, &model), BODYOPT_USAGE, "no level of detail 3");
  load.level = 0;
  load.dynamics = "/no/such.file";
  expect(bodyopt_load_model(hero().c_str(), &load, &model), BODYOPT_FILE, "/no/such.file");
  EXPECT_EQ(model, nullptr);

  auto open = api::make<bodyopt_device_options>();
  open.name = "9999";
  expect(bodyopt_open_device(&open, &device), BODYOPT_DEVICE, "'9999'");
  expect(bodyopt_open_device(nullptr, nullptr), BODYOPT_USAGE, "'device' is a null pointer");
  EXPECT_EQ(device, nullptr);

  auto create = api::make<bodyopt_instance_options>();
  create.jiggles = 1;
  expect(bodyopt_create_instance(model_.get(), &create, &instance), BODYOPT_USAGE, "without dynamics");
  create.jiggles = 0;
  bodyopt_executor executor{};
  create.executor = &executor;
  expect(bodyopt_create_instance(model_.get(), &create, &instance), BODYOPT_USAGE, "'options.executor'");
  executor.struct_size = sizeof(executor);
  expect(bodyopt_create_instance(model_.get(), &create, &instance), BODYOPT_USAGE, "parallel_for' is a null pointer");
  expect(bodyopt_create_instance(nullptr, nullptr, &instance), BODYOPT_USAGE, "'model' is a null pointer");
  EXPECT_EQ(instance, nullptr);

  bodyopt_description description{};
  expect(bodyopt_describe(model_.get(), &description), BODYOPT_USAGE, "struct_size of 'description' is 0");
  double joints[10];
  expect(bodyopt_get_bind_pose(model_.get(), joints, sizeof(joints)), BODYOPT_USAGE, "'joints' has 80 bytes");
  expect(bodyopt_get_triangles(model_.get(), nullptr, 0), BODYOPT_USAGE, "'triangles' is a null pointer");
  bodyopt_release_model(nullptr);
  bodyopt_release_device(nullptr);
  bodyopt_release_instance(nullptr);
  bodyopt_release_state(nullptr);
}

TEST_F(BadCalls, StatesOfOtherCharactersAreRefused) {
  const api::Model model = api::load_model(hero(), hero_dynamics());
  auto options = api::make<bodyopt_instance_options>();
  options.jiggles = 1;
  const api::Instance instance = api::create_instance(model, options);
  bodyopt_state* state = nullptr;
  expect(bodyopt_load_state(instance.get(), "/no/such.state", &state), BODYOPT_FILE, "/no/such.state");
  expect(bodyopt_load_state(instance.get(), hero().c_str(), &state), BODYOPT_FILE, "hero.safetensors");
  expect(bodyopt_save_state(instance.get(), nullptr, "/tmp/x"), BODYOPT_USAGE, "'state' is a null pointer");
  EXPECT_EQ(state, nullptr);
  bodyopt_poses poses = given_.all;
  poses.frame_numbers = nullptr;
  expect(bodyopt_jiggle(instance.get(), &poses, &skin_), BODYOPT_USAGE, "'poses.frame_numbers' is a null pointer");
}

// The layout that programs are compiled with: a field may be added at the end, none may move.
TEST(LibraryLayout, IsThatOfTheFirstVersion) {
  EXPECT_EQ(sizeof(bodyopt_floats), 32u);
  EXPECT_GE(sizeof(bodyopt_load_options), 24u);
  EXPECT_EQ(offsetof(bodyopt_load_options, level), 16u);
  EXPECT_EQ(offsetof(bodyopt_description, frames_per_second), 32u);
  EXPECT_EQ(offsetof(bodyopt_device_options, validation), 16u);
  EXPECT_EQ(offsetof(bodyopt_device_options, pipeline_cache), 24u);
  EXPECT_EQ(offsetof(bodyopt_executor, host), 16u);
  EXPECT_EQ(offsetof(bodyopt_instance_options, gravity_change), 40u);
  EXPECT_EQ(offsetof(bodyopt_poses, frame_numbers), 64u);
  EXPECT_EQ(offsetof(bodyopt_skin, fades), 136u);
  EXPECT_EQ(offsetof(bodyopt_skin, expected_errors), 168u);
  EXPECT_EQ(offsetof(bodyopt_description, knows_error), 36u);
  EXPECT_EQ(offsetof(bodyopt_call, result), 36u);
  EXPECT_EQ(BODYOPT_MISMATCH, 3);
  EXPECT_EQ(BODYOPT_USAGE, 64);
}

}  // namespace bad_calls_test
}  // namespace bodyopt::testing
