// Wrong calls of bodyopt.h: each gives the code and a text that names what is wrong, writes nothing, and leaves the
// instance as it was.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>

#include "include/bodyopt/vulkan.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/text.h"
#include "tests/library/c_api.h"
#include "tests/support/small_basis.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace bad_calls_test {

template <typename T>
T* misaligned(T* data) {
  return reinterpret_cast<T*>(1 + reinterpret_cast<std::uintptr_t>(data));
}

// An output of a skin: so many elements a frame, of so many numbers each.
struct Output {
  std::string name;
  bodyopt_floats bodyopt_skin::*floats;
  std::size_t elements, numbers;
};

// A character of which all that the library can tell can be asked, but for jiggle; a call that works and asks it of two
// frames, and copies of that to be spoilt.
class BadCalls : public ::testing::Test {
 protected:
  BadCalls() {
    save_basis(basis_, file());
    const std::vector<float> texture = texture_of(basis_);
    auto options = api::make<bodyopt_load_options>();
    options.texture = texture.data();
    options.texture_size = texture.size() * sizeof(float);
    options.texture_count = texture.size() / 2;
    bodyopt_model* model = nullptr;
    api::check(bodyopt_load_model(file().c_str(), &options, &model));
    model_.reset(model);
    instance_ = make_instance(model_);
    for (const Output& output : outputs_) values_.emplace_back(2 * output.elements * output.numbers, -7.0f);
    for (std::size_t k = 0; k < outputs_.size(); ++k) skin_.*outputs_[k].floats = floats_in(values_[k]);
  }

  std::string file() const { return folder_ / "knowing.safetensors"; }

  void expect(bodyopt_result result, bodyopt_result expected, const std::string& said) {
    EXPECT_EQ(result, expected);
    EXPECT_NE(std::string(bodyopt_last_error()).find(said), std::string::npos)
        << bodyopt_last_error() << "\ndoes not say: " << said;
    for (std::size_t k = 0; k < outputs_.size(); ++k) {
      EXPECT_EQ(values_[k], std::vector<float>(values_[k].size(), -7.0f)) << outputs_[k].name << ": " << said;
    }
  }

  void refuses(const std::function<void(bodyopt_poses&, bodyopt_skin&)>& spoil, bodyopt_result expected,
               const std::string& said) {
    bodyopt_poses poses = given_.all;
    bodyopt_skin skin = skin_;
    spoil(poses, skin);
    expect(bodyopt_evaluate(instance_.get(), &poses, &skin), expected, said);
  }

  const TemporaryFolder folder_;
  const Basis basis_ = knowing_basis();
  const std::size_t vertices_ = basis_.mesh.output_count(), fibres_ = basis_.strain.fibre_count();
  const std::vector<Output> outputs_ = {{"positions", &bodyopt_skin::positions, vertices_, 3},
                                        {"normals", &bodyopt_skin::normals, vertices_, 3},
                                        {"strains", &bodyopt_skin::strains, fibres_, 1},
                                        {"outside", &bodyopt_skin::outside, 1, 1},
                                        {"fades", &bodyopt_skin::fades, 1, 1},
                                        {"expected_errors", &bodyopt_skin::expected_errors, 1, 1},
                                        {"tangents", &bodyopt_skin::tangents, vertices_, 4},
                                        {"vertex_errors", &bodyopt_skin::vertex_errors, vertices_, 1},
                                        {"outside_features", &bodyopt_skin::outside_features, 1, 1},
                                        {"excess", &bodyopt_skin::excess, basis_.residual.feature_count(), 1}};
  api::Model model_;
  api::Instance instance_;
  PoseArrays given_{turning_poses(basis_, 2)};
  std::vector<std::vector<float>> values_;  // of the outputs
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
  refuses([](auto& poses, auto&) { poses.joints = misaligned(poses.joints); }, BODYOPT_USAGE, "not aligned");
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
  expect(bodyopt_get_state(instance_.get(), nullptr), BODYOPT_USAGE, "'state' is a null pointer");
  expect(bodyopt_set_state(instance_.get(), nullptr), BODYOPT_USAGE, "does not jiggle");
  ASSERT_EQ(bodyopt_evaluate(instance_.get(), &given_.all, &skin_), BODYOPT_OK);
  for (std::size_t k = 0; k < outputs_.size(); ++k) {
    EXPECT_EQ(std::ranges::count(values_[k], -7.0f), 0) << outputs_[k].name;
  }
}

TEST_F(BadCalls, OfControlsAreRefused) {
  const std::size_t packed = given_.all.control_count * sizeof(float);
  ASSERT_GT(packed, 0u);
  refuses([](auto& poses, auto&) { poses.controls = nullptr; }, BODYOPT_USAGE, "'poses.controls' is a null pointer");
  refuses([](auto& poses, auto&) { poses.controls = misaligned(poses.controls); }, BODYOPT_USAGE,
          "'poses.controls' is not aligned");
  refuses([&](auto& poses, auto&) { poses.control_frame_stride = packed - 2; }, BODYOPT_USAGE,
          "poses.control_frame_stride is " + std::to_string(packed - 2) + " bytes, at least");
  refuses([&](auto& poses, auto&) { poses.control_frame_stride = packed + 2; }, BODYOPT_USAGE, "no multiple of 4");
  refuses([](auto& poses, auto&) { poses.control_frame_stride = ~std::size_t{3}; }, BODYOPT_USAGE, "too large");
  for (const float number : {std::nanf(""), HUGE_VALF}) {
    std::vector<float> spoilt = given_.controls;
    spoilt.back() = number;
    refuses([&](auto& poses, auto&) { poses.controls = spoilt.data(); }, BODYOPT_MISMATCH, "is not a finite number");
  }
}

TEST_F(BadCalls, OfEveryOutputAreRefused) {
  for (const Output& output : outputs_) {
    const std::size_t element = output.numbers * sizeof(float), frame = output.elements * element;
    const auto refuses_output = [&](const std::function<void(bodyopt_floats&)>& spoil, const std::string& said) {
      refuses([&](auto&, auto& skin) { spoil(skin.*output.floats); }, BODYOPT_USAGE, said);
    };
    const std::string name = "skin." + output.name;
    refuses_output([&](auto& floats) { floats.element_stride = element - 2; },
                   name + ".element_stride is " + std::to_string(element - 2) + " bytes, at least");
    refuses_output([&](auto& floats) { floats.element_stride = element + 2; }, name + ".element_stride is ");
    refuses_output([&](auto& floats) { floats.frame_stride = frame - 2; },
                   name + ".frame_stride is " + std::to_string(frame - 2) + " bytes, at least");
    refuses_output([&](auto& floats) { floats.frame_stride = frame + 2; }, name + ".frame_stride is ");
    refuses_output([&](auto& floats) { floats.frame_stride = ~std::size_t{3}; }, "'" + name + "' are too large");
    refuses_output([](auto& floats) { floats.size -= 4; }, "'" + name + "' has ");
    refuses_output([](auto& floats) { floats.data = misaligned(floats.data); }, "'" + name + "' is not aligned");
    if (output.elements == 1) continue;
    refuses_output([](auto& floats) { floats.element_stride = ~std::size_t{3}; }, "'" + name + "' are too large");
  }
}

// Joints without a size, and turned inside out: a skin of numbers all the same.
TEST_F(BadCalls, OfZeroAndReflectedScaleGiveFiniteNumbers) {
  for (const double scale : {0.0, -1.0}) {
    for (std::size_t i = 7; i < 10; ++i) given_.joints[10 + i] = scale;
    api::check(bodyopt_evaluate(instance_.get(), &given_.all, &skin_));
    for (std::size_t k = 0; k < outputs_.size(); ++k) {
      EXPECT_TRUE(std::ranges::all_of(values_[k], [](float x) { return std::isfinite(x); }))
          << outputs_[k].name << " at " << scale;
    }
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
  const std::string other = hero_dynamics();
  load.dynamics = other.c_str();
  expect(bodyopt_load_model(file().c_str(), &load, &model), BODYOPT_MISMATCH, "hero.dynamics.safetensors");
  load.dynamics = nullptr;
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
  for (const std::size_t size : {std::size_t{0}, sizeof(std::size_t), std::size_t{4000}}) {
    const std::string said = "struct_size of 'options' is " + std::to_string(size);
    load.struct_size = open.struct_size = create.struct_size = size;
    expect(bodyopt_load_model(hero().c_str(), &load, &model), BODYOPT_USAGE, said);
    expect(bodyopt_open_device(&open, &device), BODYOPT_USAGE, said);
    expect(bodyopt_create_instance(model_.get(), &create, &instance), BODYOPT_USAGE, said);
  }
  EXPECT_TRUE(model == nullptr && device == nullptr && instance == nullptr);
  double joints[10];
  expect(bodyopt_get_bind_pose(model_.get(), joints, sizeof(joints)), BODYOPT_USAGE, "'joints' has 80 bytes");
  expect(bodyopt_get_triangles(model_.get(), nullptr, 0), BODYOPT_USAGE, "'triangles' is a null pointer");
  bodyopt_release_model(nullptr);
  bodyopt_release_device(nullptr);
  bodyopt_release_instance(nullptr);
  bodyopt_release_state(nullptr);
}

// The limb with a joint more, or with dynamics that were made again: each has a file of its own.
api::Model load_other_limb(const TemporaryFolder& folder, bool has_finger) {
  Basis basis = load_basis(hero());
  Dynamics dynamics = load_dynamics(hero_dynamics(), basis);
  if (has_finger) {
    std::vector<Joint>& joints = basis.skeleton.joints;
    for (std::uint32_t j = 1; j < joints.size(); ++j) {
      basis.skeleton.features.push_back({j, static_cast<std::uint32_t>(joints[j].parent)});
    }
    joints.push_back(joints.back());
    joints.back().name = "finger";
    dynamics.metadata["skeleton_hash"] = hexadecimal(skeleton_hash(basis.skeleton));
  } else {
    dynamics.jiggle.step.stiffness_damping *= 2;
  }
  save_basis(basis, folder / "other.safetensors");
  save_dynamics(dynamics, folder / "other.dynamics.safetensors");
  return api::load_model(folder / "other.safetensors", folder / "other.dynamics.safetensors");
}

// After a frame.
api::State state_of(const api::Instance& instance, const PoseArrays& given) {
  auto skin = api::make<bodyopt_skin>();
  api::check(bodyopt_jiggle(instance.get(), &given.all, &skin));
  bodyopt_state* state = nullptr;
  api::check(bodyopt_get_state(instance.get(), &state));
  return api::State(state);
}

TEST_F(BadCalls, StatesOfOtherCharactersAreRefused) {
  const api::Instance instance = make_instance(api::load_model(hero(), hero_dynamics()), true);
  const api::State own = state_of(instance, PoseArrays(turning_poses(load_basis(hero()), 1)));
  const std::string file = folder_ / "other.state", refused = folder_ / "refused.state";
  for (const bool has_finger : {true, false}) {
    SCOPED_TRACE(has_finger ? "with a finger" : "made again");
    const api::Model model = load_other_limb(folder_, has_finger);
    const api::Instance other = make_instance(model, true);
    const api::State state = state_of(other, PoseArrays(turning_poses(load_basis(folder_ / "other.safetensors"), 1)));
    api::check(bodyopt_save_state(other.get(), state.get(), file.c_str()));
    expect(bodyopt_save_state(instance.get(), state.get(), refused.c_str()), BODYOPT_MISMATCH, "of other dynamics");
    EXPECT_FALSE(std::filesystem::exists(refused));
    bodyopt_state* loaded = nullptr;
    expect(bodyopt_load_state(instance.get(), file.c_str(), &loaded), BODYOPT_MISMATCH, "of other dynamics");
    EXPECT_EQ(loaded, nullptr);
    if (has_finger) {
      expect(bodyopt_set_state(instance.get(), state.get()), BODYOPT_MISMATCH, "numbers of 'joints'");
    }
  }
  // Of the same dynamics, loaded once more.
  const api::Instance twin = make_instance(api::load_model(hero(), hero_dynamics()), true);
  api::check(bodyopt_save_state(twin.get(), own.get(), refused.c_str()));
}

TEST_F(BadCalls, OfStatesAreRefused) {
  const api::Instance instance = make_instance(api::load_model(hero(), hero_dynamics()), true);
  bodyopt_state* state = nullptr;
  expect(bodyopt_load_state(instance.get(), "/no/such.state", &state), BODYOPT_FILE, "/no/such.state");
  expect(bodyopt_load_state(instance.get(), hero().c_str(), &state), BODYOPT_FILE, "hero.safetensors");
  expect(bodyopt_save_state(instance.get(), nullptr, "/tmp/x"), BODYOPT_USAGE, "'state' is a null pointer");
  EXPECT_EQ(state, nullptr);
  PoseArrays given(turning_poses(load_basis(hero()), 1));
  given.all.frame_numbers = nullptr;
  const auto nothing = api::make<bodyopt_skin>();
  expect(bodyopt_jiggle(instance.get(), &given.all, &nothing), BODYOPT_USAGE,
         "'poses.frame_numbers' is a null pointer");
}

// What would let the body's energy grow, or its positions leave all numbers.
TEST_F(BadCalls, OfTheJigglesOptionsAreRefused) {
  const api::Model model = api::load_model(hero(), hero_dynamics());
  bodyopt_instance* instance = nullptr;
  auto options = api::make<bodyopt_instance_options>();
  options.jiggles = 1;
  const auto refuses_options = [&](const std::string& said) {
    expect(bodyopt_create_instance(model.get(), &options, &instance), BODYOPT_USAGE, said);
    EXPECT_EQ(instance, nullptr);
  };
  options.iterations = ~0u;  // of a mode that there was: no effect
  for (const double g : {std::nan(""), HUGE_VAL, 1e300, -1000.5}) {
    for (double& axis : options.gravity_change) {
      axis = g;
      refuses_options("the change of gravity expects three finite numbers, of 1000 m/s^2 at most");
      axis = -1000;
    }
  }
  EXPECT_EQ(bodyopt_create_instance(model.get(), &options, &instance), BODYOPT_OK) << bodyopt_last_error();
  const api::Instance created(instance);
}

TEST_F(BadCalls, OfWeightsAreRefused) {
  const float most = 1000;
  for (const float weight : {std::nanf(""), HUGE_VALF, 3e38f, std::nextafter(-most, -2 * most)}) {
    expect(bodyopt_set_weights(instance_.get(), weight, 1), BODYOPT_USAGE, "the weight of the correction is");
    expect(bodyopt_set_weights(instance_.get(), 1, weight), BODYOPT_USAGE, "the weight of the jiggle is");
  }
  api::check(bodyopt_set_weights(instance_.get(), -most, most));
  api::check(bodyopt_evaluate(instance_.get(), &given_.all, &skin_));
  EXPECT_TRUE(std::ranges::all_of(values_[0], [](float x) { return std::isfinite(x); }));
}

// As a program of the first version gives it: no byte after it is the library's to read or write.
template <typename Structure>
class OfFirstVersion {
 public:
  OfFirstVersion(const Structure& given, std::size_t size) : size_(size), bytes_(2 * size, 0xee) {
    std::memcpy(bytes_.data(), &given, size);
    get()->struct_size = size;
  }
  Structure* get() { return reinterpret_cast<Structure*>(bytes_.data()); }
  void expect_untouched() const {
    EXPECT_EQ(std::ranges::count(bytes_.begin() + static_cast<std::ptrdiff_t>(size_), bytes_.end(), 0xee),
              static_cast<std::ptrdiff_t>(size_));
  }

 private:
  std::size_t size_;
  std::vector<unsigned char> bytes_;
};

// What follows the structures of the first version would be refused as strides, file names and channels.
TEST_F(BadCalls, AreNotThoseOfTheFirstVersion) {
  OfFirstVersion load(api::make<bodyopt_load_options>(), BODYOPT_LOAD_OPTIONS_FIRST_SIZE);
  bodyopt_model* loaded = nullptr;
  ASSERT_EQ(bodyopt_load_model(file().c_str(), load.get(), &loaded), BODYOPT_OK) << bodyopt_last_error();
  const api::Model model(loaded);
  OfFirstVersion description(api::make<bodyopt_description>(), BODYOPT_DESCRIPTION_FIRST_SIZE);
  EXPECT_EQ(bodyopt_describe(model.get(), description.get()), BODYOPT_OK) << bodyopt_last_error();
  EXPECT_EQ(description.get()->vertex_count, vertices_);
  description.expect_untouched();
  OfFirstVersion create(api::make<bodyopt_instance_options>(), BODYOPT_INSTANCE_OPTIONS_FIRST_SIZE);
  bodyopt_instance* created = nullptr;
  ASSERT_EQ(bodyopt_create_instance(model.get(), create.get(), &created), BODYOPT_OK) << bodyopt_last_error();
  const api::Instance instance(created);
  api::check(bodyopt_evaluate(instance_.get(), &given_.all, &skin_));
  const std::vector<float> expected = values_[0];
  std::ranges::fill(values_[0], -7.0f);
  OfFirstVersion poses(given_.all, BODYOPT_POSES_FIRST_SIZE);
  OfFirstVersion skin(skin_, BODYOPT_SKIN_FIRST_SIZE);
  EXPECT_EQ(bodyopt_evaluate(instance.get(), poses.get(), skin.get()), BODYOPT_OK) << bodyopt_last_error();
  EXPECT_EQ(values_[0], expected);
}

using Offsets = std::vector<std::size_t>;

// The layout that programs are compiled with: a field may be added at the end, none may move.
TEST(LibraryLayout, IsThatOfTheFirstVersion) {
#define AT(field) offsetof(Structure, field)
  {
    using Structure = bodyopt_load_options;
    EXPECT_EQ(Offsets({AT(struct_size), AT(dynamics), AT(level)}), Offsets({0, 8, 16}));
    EXPECT_EQ(Offsets({AT(texture), AT(texture_size), AT(texture_stride), AT(texture_count)}),
              Offsets({24, 32, 40, 48}));
    EXPECT_EQ(Offsets({AT(dynamics_data), AT(dynamics_size), AT(attached), AT(attached_data), AT(attached_size)}),
              Offsets({56, 64, 72, 80, 88}));
  }
  {
    using Structure = bodyopt_device_description;
    EXPECT_EQ(Offsets({AT(struct_size), AT(index), AT(name), AT(type), AT(memory_bytes), AT(problem)}),
              Offsets({0, 8, 12, 268, 288, 296}));
  }
  {
    using Structure = bodyopt_description;
    EXPECT_EQ(Offsets({AT(struct_size), AT(vertex_count), AT(triangle_count), AT(joint_count), AT(control_count)}),
              Offsets({0, 8, 12, 16, 20}));
    EXPECT_EQ(Offsets({AT(strain_count), AT(has_dynamics), AT(frames_per_second), AT(knows_error), AT(has_tangents)}),
              Offsets({24, 28, 32, 36, 40}));
    EXPECT_EQ(Offsets({AT(channel_count), AT(attached_count), AT(full_vertex_count)}), Offsets({44, 48, 52}));
  }
  {
    using Structure = bodyopt_device_options;
    EXPECT_EQ(Offsets({AT(struct_size), AT(name), AT(validation), AT(pipeline_cache)}), Offsets({0, 8, 16, 24}));
  }
  {
    using Structure = bodyopt_executor;
    EXPECT_EQ(Offsets({AT(struct_size), AT(parallel_for), AT(host)}), Offsets({0, 8, 16}));
  }
  {
    using Structure = bodyopt_instance_options;
    EXPECT_EQ(Offsets({AT(struct_size), AT(device), AT(executor), AT(jiggles), AT(iterations), AT(check),
                       AT(gravity_change), AT(recorded_frames)}),
              Offsets({0, 8, 16, 24, 28, 32, 40, 64}));
  }
  {
    using Structure = bodyopt_poses;
    EXPECT_EQ(Offsets({AT(struct_size), AT(frame_count), AT(joint_count), AT(control_count), AT(joints)}),
              Offsets({0, 8, 12, 16, 24}));
    EXPECT_EQ(
        Offsets({AT(joint_stride), AT(joint_frame_stride), AT(controls), AT(control_frame_stride), AT(frame_numbers)}),
        Offsets({32, 40, 48, 56, 64}));
    EXPECT_EQ(Offsets({AT(shows_modifiers), AT(goes_on), AT(frames_per_second), AT(channels), AT(channel_count),
                       AT(channel_frame_stride)}),
              Offsets({72, 76, 80, 88, 96, 104}));
    EXPECT_EQ(Offsets({AT(skinning), AT(skinning_stride), AT(skinning_frame_stride)}), Offsets({112, 120, 128}));
  }
  {
    using Structure = bodyopt_attached;
    EXPECT_EQ(Offsets({AT(struct_size), AT(name), AT(vertex_count), AT(triangle_count)}), Offsets({0, 8, 16, 20}));
    EXPECT_EQ(sizeof(Structure), BODYOPT_ATTACHED_FIRST_SIZE);
  }
  {
    using Structure = bodyopt_channel;
    EXPECT_EQ(Offsets({AT(struct_size), AT(name), AT(what), AT(constant), AT(low), AT(high)}),
              Offsets({0, 8, 16, 24, 28, 32}));
    EXPECT_EQ(sizeof(Structure), BODYOPT_CHANNEL_FIRST_SIZE);
  }
  {
    using Structure = bodyopt_floats;
    EXPECT_EQ(Offsets({AT(data), AT(size), AT(element_stride), AT(frame_stride), sizeof(Structure)}),
              Offsets({0, 8, 16, 24, 32}));
  }
  {
    using Structure = bodyopt_skin;
    EXPECT_EQ(Offsets({AT(struct_size), AT(positions), AT(normals), AT(strains), AT(outside), AT(fades),
                       AT(expected_errors), AT(tangents), AT(vertex_errors), AT(outside_features)}),
              Offsets({0, 8, 40, 72, 104, 136, 168, 200, 232, 264}));
    EXPECT_EQ(Offsets({AT(attached), AT(attached_count), AT(full_positions), AT(excess)}),
              Offsets({296, 304, 312, 344}));
  }
  {
    using Structure = bodyopt_call;
    EXPECT_EQ(Offsets({AT(struct_size), AT(instance), AT(poses), AT(skin), AT(jiggles), AT(result)}),
              Offsets({0, 8, 16, 24, 32, 36}));
  }
  {
    using Structure = bodyopt_vulkan_device;
    EXPECT_EQ(Offsets({AT(struct_size), AT(instance), AT(physical_device), AT(device), AT(queue), AT(queue_family),
                       AT(pipeline_cache), AT(get_instance_proc_addr)}),
              Offsets({0, 8, 16, 24, 32, 40, 48, 56}));
  }
  {
    using Structure = bodyopt_vulkan_output;
    EXPECT_EQ(Offsets({AT(buffer), AT(size), AT(offset), AT(element_stride), sizeof(Structure)}),
              Offsets({0, 8, 16, 24, 32}));
  }
  {
    using Structure = bodyopt_recording;
    EXPECT_EQ(Offsets({AT(struct_size), AT(commands), AT(positions), AT(normals), AT(tangents)}),
              Offsets({0, 8, 16, 48, 80}));
    EXPECT_EQ(Offsets({AT(positions_frame_stride), AT(normals_frame_stride), AT(tangents_frame_stride)}),
              Offsets({112, 120, 128}));
  }
#undef AT
  EXPECT_EQ(
      Offsets({BODYOPT_LOAD_OPTIONS_FIRST_SIZE, BODYOPT_DESCRIPTION_FIRST_SIZE, BODYOPT_DEVICE_DESCRIPTION_FIRST_SIZE,
               BODYOPT_DEVICE_OPTIONS_FIRST_SIZE, BODYOPT_EXECUTOR_FIRST_SIZE, BODYOPT_INSTANCE_OPTIONS_FIRST_SIZE,
               BODYOPT_POSES_FIRST_SIZE, BODYOPT_SKIN_FIRST_SIZE, BODYOPT_CALL_FIRST_SIZE,
               BODYOPT_VULKAN_DEVICE_FIRST_SIZE, BODYOPT_RECORDING_FIRST_SIZE}),
      Offsets({24, 40, 424, 24, 24, 64, 72, 168, 40, 48, 80}));
  const std::vector<int> results = {BODYOPT_OK,    BODYOPT_MISMATCH, BODYOPT_FILE,  BODYOPT_DEVICE,
                                    BODYOPT_USAGE, BODYOPT_INTERNAL, BODYOPT_MEMORY};
  EXPECT_EQ(results, (std::vector<int>{0, 3, 4, 5, 64, 70, 71}));
  const std::vector<int> levels = {BODYOPT_LOG_ERROR, BODYOPT_LOG_WARNING, BODYOPT_LOG_INFO};
  EXPECT_EQ(levels, (std::vector<int>{0, 1, 2}));
}

}  // namespace bad_calls_test
}  // namespace bodyopt::testing
