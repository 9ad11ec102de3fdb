// Calls of bodyopt.h with structures at random, most of them wrong: every one gives a code, none writes beyond what is
// the caller's, and the instance works on.
#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <type_traits>

#include "runtime/basis/attachments.h"
#include "tests/library/c_api.h"
#include "tests/support/breathing.h"
#include "tests/support/random_tables.h"
#include "tests/support/read_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace random_calls_test {

constexpr float kUntouched = -7;

// Takes one of these, or leaves what was there.
template <typename T>
void maybe(Random& random, T& value, std::initializer_list<std::type_identity_t<T>> others) {
  if (random.below(4) == 0) value = *(others.begin() + random.below(static_cast<std::uint32_t>(others.size())));
}

// The limb, which breathes.
Basis breathing_hero() {
  Basis basis = load_basis(hero());
  add_breathing(basis);
  return basis;
}

std::string bytes_of(const Basis& basis) {
  const TemporaryFolder folder;
  save_basis(basis, folder / "hero.safetensors");
  return read_bytes(folder / "hero.safetensors");
}

class RandomCalls : public ::testing::Test {
 protected:
  static constexpr std::size_t kFrames = 3, kRoom = 16384;  // numbers of an output

  void spoil(Random& random, bodyopt_poses& poses) {
    maybe(random, poses.struct_size, {0, 8, BODYOPT_POSES_FIRST_SIZE, sizeof(poses) - 4, sizeof(poses) + 8});
    maybe(random, poses.frame_count, {0u, 1u, 2u});
    maybe(random, poses.joint_count, {0u, poses.joint_count + 1, ~0u});
    maybe(random, poses.control_count, {0u, 1u, ~0u});
    maybe(random, poses.joint_stride, {0, 8, 80, 84, 96, ~std::size_t{7}});
    maybe(random, poses.joint_frame_stride, {0, 8, 800, ~std::size_t{0}, ~std::size_t{7}});
    maybe(random, poses.shows_modifiers, {0u, 1u, 2u});
    maybe(random, poses.goes_on, {0u, 1u, 2u});
    maybe(random, poses.channels, {nullptr, channels_.data(), nan_channels_.data()});
    maybe(random, poses.channel_count, {0u, 1u, channel_count() + 1, ~0u});
    maybe(random, poses.channel_frame_stride, {0, 4, 14, 6000, 6002, ~std::size_t{0}, ~std::size_t{3}});
    maybe(random, poses.frames_per_second, {24.0, 0.0, -1.0, std::numeric_limits<double>::quiet_NaN()});
    maybe(random, poses.skinning, {matrices_.data()});
    maybe(random, poses.joints, {nullptr, nullptr, nans_.data()});
    maybe(random, poses.skinning_stride, {0, 4, 48, 50, 64, ~std::size_t{3}});
  }

  void spoil(Random& random, bodyopt_floats& output) {
    maybe(random, output.data, {nullptr});
    maybe(random, output.size, {0, 4, output.size - 4, output.size / 2});
    maybe(random, output.element_stride, {0, 4, 12, 14, 20, ~std::size_t{3}, std::size_t{1} << 62});
    maybe(random, output.frame_stride, {0, 4, 6000, 6002, ~std::size_t{3}, std::size_t{1} << 62});
  }

  // Memory for the outputs; what of it lies beyond `size` stays untouched.
  void expect_within(const std::vector<bodyopt_floats>& outputs, int call) const {
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      const std::size_t own = outputs[k].data == nullptr ? 0 : (outputs[k].size + 3) / sizeof(float);
      const auto begin = memory_[k].begin() + static_cast<std::ptrdiff_t>(std::min(own, kRoom));
      ASSERT_TRUE(std::all_of(begin, memory_[k].end(), [](float x) { return x == kUntouched; })) << call << ", " << k;
    }
  }

  // Of bytes, with what follows the skin.
  static api::Model load(const std::string& bytes) {
    const std::string attached = kept_file("hero.attached.safetensors"), dynamics = hero_dynamics();
    auto options = api::make<bodyopt_load_options>();
    options.dynamics = dynamics.c_str();
    options.attached = attached.c_str();
    bodyopt_model* model = nullptr;
    api::check(bodyopt_load_model_from_memory(bytes.data(), bytes.size(), &options, &model));
    return api::Model(model);
  }

  std::uint32_t channel_count() const { return api::describe(model_).channel_count; }

  const Basis basis_ = breathing_hero();
  const std::string bytes_ = bytes_of(basis_);
  const api::Model model_ = load(bytes_);
  PoseArrays given_{turning_poses(basis_, kFrames)};
  // As many as the strides of `joints` and `skinning` reach over.
  std::vector<float> matrices_ = std::vector<float>(kRoom, 0.0f);
  std::vector<double> joints_ = std::vector<double>(kRoom, 0.5);
  std::vector<double> nans_ = std::vector<double>(kRoom, std::numeric_limits<double>::quiet_NaN());
  // Some far outside of their ranges.
  std::vector<float> channels_ = Random(1).floats(kRoom, -100, 100);
  std::vector<float> nan_channels_ = std::vector<float>(kRoom, std::numeric_limits<float>::quiet_NaN());
  std::vector<std::vector<float>> memory_;
};

TEST_F(RandomCalls, GiveACodeAndWriteWhatIsTheCallers) {
  const std::vector<bodyopt_floats bodyopt_skin::*> members = {
      &bodyopt_skin::positions, &bodyopt_skin::normals,         &bodyopt_skin::strains,
      &bodyopt_skin::outside,   &bodyopt_skin::expected_errors, &bodyopt_skin::vertex_errors,
      &bodyopt_skin::tangents,  &bodyopt_skin::full_positions,  &bodyopt_skin::excess};
  std::ranges::copy(given_.joints, joints_.begin());
  for (std::size_t k = 0; k + 12 <= kRoom; k += 12)
    matrices_[k] = matrices_[k + 5] = matrices_[k + 10] = 1;  // the bind pose
  const api::Instance still = make_instance(model_), jiggling = make_instance(model_, true);
  Arrays expected(basis_, kFrames), found(basis_, kFrames);
  api::check(bodyopt_evaluate(still.get(), &given_.all, &expected.all));
  std::map<int, int> codes, with_channels;
  for (int call = 0; call < 4000; ++call) {
    Random random(static_cast<std::uint32_t>(call));
    memory_.assign(members.size() + 1, std::vector<float>(kRoom, kUntouched));
    bodyopt_poses poses = given_.all;
    poses.joints = joints_.data();
    poses.frames_per_second = 24;
    poses.shows_modifiers = random.below(2);
    if (random.below(2) == 0) {
      poses.channels = channels_.data();
      poses.channel_count = channel_count();
    }
    spoil(random, poses);
    auto skin = api::make<bodyopt_skin>();
    std::vector<bodyopt_floats> outputs;
    for (std::vector<float>& memory : memory_) {
      outputs.push_back({memory.data(), random.below(2) * 9000 * sizeof(float) / 2 + 7000, 0, 0});
      if (random.below(3) == 0) spoil(random, outputs.back());
      if (random.below(3) == 0) outputs.back().data = nullptr;
    }
    if (random.below(8) != 0) outputs[6].data = outputs[7].data = nullptr;  // which the model does not have
    for (std::size_t k = 0; k < members.size(); ++k) skin.*members[k] = outputs[k];
    skin.attached = random.below(8) == 0 ? nullptr : &outputs.back();
    skin.attached_count = random.below(3);
    maybe(random, skin.struct_size, {8, BODYOPT_SKIN_FIRST_SIZE, sizeof(skin) - 8, sizeof(skin) + 8});
    const auto run = random.below(2) == 0 ? bodyopt_evaluate : bodyopt_jiggle;
    const bodyopt_instance* asked = random.below(2) == 0 ? still.get() : jiggling.get();
    const bodyopt_result result = run(const_cast<bodyopt_instance*>(asked), &poses, &skin);
    ++codes[result];
    const bool breathes = poses.struct_size == sizeof(poses) && poses.shows_modifiers != 0;
    if (result == BODYOPT_OK && breathes) ++with_channels[poses.channels != nullptr];
    ASSERT_TRUE(result == BODYOPT_OK || result == BODYOPT_MISMATCH || result == BODYOPT_USAGE)
        << call << ": " << bodyopt_last_error();
    expect_within(outputs, call);
  }
  EXPECT_GT(codes[BODYOPT_OK], 50);
  EXPECT_GT(codes[BODYOPT_USAGE], 500);
  EXPECT_GT(codes[BODYOPT_MISMATCH], 100);
  EXPECT_GT(with_channels[0], 10);
  EXPECT_GT(with_channels[1], 10);
  api::check(bodyopt_evaluate(still.get(), &given_.all, &found.all));
  EXPECT_EQ(found.positions, expected.positions);
}

// A block of its own for each file, so that a byte read beyond it is seen by the sanitizers.
struct SpoiltFile {
  SpoiltFile(Random& random, const std::string& file) : bytes(file.begin(), file.end()) {
    if (random.below(3) == 0) bytes.resize(random.below(static_cast<std::uint32_t>(file.size() + 1)));
    for (std::uint32_t k = random.below(3); k > 0 && !bytes.empty(); --k) {
      const std::uint32_t ends = random.below(2) == 0 ? 64 : static_cast<std::uint32_t>(bytes.size());
      bytes[random.below(std::min(ends, static_cast<std::uint32_t>(bytes.size())))] =
          static_cast<char>(random.below(256));
    }
    bytes.shrink_to_fit();
  }

  std::vector<char> bytes;
};

TEST_F(RandomCalls, LoadWhatIsSoundOfMemory) {
  const std::string dynamics = read_bytes(hero_dynamics()), worn = read_bytes(kept_file("hero.attached.safetensors"));
  std::map<int, int> codes;
  for (std::uint32_t call = 0; call < 600; ++call) {
    Random random(call);
    const SpoiltFile basis(random, bytes_), jiggle(random, dynamics), attached(random, worn);
    auto options = api::make<bodyopt_load_options>();
    maybe(random, options.struct_size, {0, BODYOPT_LOAD_OPTIONS_FIRST_SIZE, sizeof(options) - 8, sizeof(options) + 8});
    maybe(random, options.level, {1u, ~0u});
    if (random.below(2) == 0) {
      options.dynamics_data = jiggle.bytes.data();
      options.dynamics_size = jiggle.bytes.size();
    }
    if (random.below(2) == 0) {
      options.attached_data = attached.bytes.data();
      options.attached_size = attached.bytes.size();
    }
    const std::vector<float> texture(random.below(3000), random.below(9) == 0 ? std::nanf("") : 0.5f);
    if (random.below(3) == 0) {
      options.texture = texture.data();
      options.texture_size = texture.size() * sizeof(float);
      options.texture_count = texture.size() / 2;
      maybe(random, options.texture_stride, {0, 4, 8, 10, 12, ~std::size_t{3}});
      maybe(random, options.texture_count, {0, 1, ~std::size_t{0}});
    }
    bodyopt_model* model = nullptr;
    const bodyopt_result result = bodyopt_load_model_from_memory(basis.bytes.data(), basis.bytes.size(),
                                                                 random.below(5) == 0 ? nullptr : &options, &model);
    ++codes[result];
    EXPECT_EQ(model != nullptr, result == BODYOPT_OK) << call;
    ASSERT_TRUE(result == BODYOPT_OK || result == BODYOPT_FILE || result == BODYOPT_MISMATCH || result == BODYOPT_USAGE)
        << call << ": " << bodyopt_last_error();
    bodyopt_release_model(model);
  }
  EXPECT_GT(codes[BODYOPT_OK], 20);
  EXPECT_GT(codes[BODYOPT_FILE], 100);
  EXPECT_GT(codes[BODYOPT_USAGE], 20);
}

// Has a description written into memory that ends with it. Returns the code.
template <typename Description>
bodyopt_result describe_randomly(Random& random, std::size_t first_size, const auto& describe) {
  auto given = api::make<Description>();
  maybe(random, given.struct_size, {0, 8, first_size, sizeof(given) - 4, sizeof(given) + 8});
  std::vector<std::byte> memory(std::max(given.struct_size, sizeof(std::size_t)), std::byte{7});
  std::memcpy(memory.data(), &given.struct_size, sizeof(std::size_t));
  return describe(random.below(9) == 0 ? nullptr : reinterpret_cast<Description*>(memory.data()));
}

TEST_F(RandomCalls, DescribeIntoWhatIsTheCallers) {
  std::map<int, int> codes;
  for (std::uint32_t call = 0; call < 2000; ++call) {
    Random random(call);
    const bodyopt_model* model = random.below(9) == 0 ? nullptr : model_.get();
    std::uint32_t of = random.below(2);
    maybe(random, of, {channel_count() - 1, channel_count(), ~0u});
    const bodyopt_result results[] = {
        describe_randomly<bodyopt_channel>(random, BODYOPT_CHANNEL_FIRST_SIZE,
                                           [&](auto* into) { return bodyopt_describe_channel(model, of, into); }),
        describe_randomly<bodyopt_attached>(random, BODYOPT_ATTACHED_FIRST_SIZE,
                                            [&](auto* into) { return bodyopt_describe_attached(model, of, into); }),
        describe_randomly<bodyopt_description>(random, BODYOPT_DESCRIPTION_FIRST_SIZE,
                                               [&](auto* into) { return bodyopt_describe(model, into); })};
    for (const bodyopt_result result : results) {
      ++codes[result];
      ASSERT_TRUE(result == BODYOPT_OK || result == BODYOPT_USAGE) << call << ": " << bodyopt_last_error();
    }
  }
  EXPECT_GT(codes[BODYOPT_OK], 500);
  EXPECT_GT(codes[BODYOPT_USAGE], 500);
}

TEST_F(RandomCalls, ListDevicesIntoWhatIsTheCallers) {
  for (std::uint32_t call = 0; call < 100; ++call) {
    Random random(call);
    std::size_t size = sizeof(bodyopt_device_description);
    maybe(random, size, {0, 8, BODYOPT_DEVICE_DESCRIPTION_FIRST_SIZE, size - 8, size + 8});
    const std::size_t room = random.below(4);
    std::vector<std::byte> memory(std::max(size, sizeof(std::size_t)) * room);
    for (std::size_t k = 0; k < room; ++k) std::memcpy(memory.data() + k * size, &size, sizeof(std::size_t));
    std::size_t count = 77;
    const bool has_count = random.below(5) != 0, has_memory = random.below(5) != 0;
    const bodyopt_result result =
        bodyopt_list_devices(has_memory ? reinterpret_cast<bodyopt_device_description*>(memory.data()) : nullptr, room,
                             has_count ? &count : nullptr);
    const bool fits = size >= BODYOPT_DEVICE_DESCRIPTION_FIRST_SIZE && size <= sizeof(bodyopt_device_description);
    const bool is_right = has_count && (room == 0 || (has_memory && fits));
    EXPECT_EQ(result == BODYOPT_OK, is_right) << call << ": " << bodyopt_last_error();
    ASSERT_TRUE(result == BODYOPT_OK || result == BODYOPT_USAGE) << call << ": " << bodyopt_last_error();
    EXPECT_EQ(count == 77, !is_right) << call;
  }
}

}  // namespace random_calls_test
}  // namespace bodyopt::testing
