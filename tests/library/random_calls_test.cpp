// Calls of bodyopt.h with structures at random, most of them wrong: every one gives a code, none writes beyond what is
// the caller's, and the instance works on.
#include <algorithm>
#include <limits>
#include <map>
#include <type_traits>

#include "runtime/basis/attachments.h"
#include "tests/library/c_api.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace random_calls_test {

constexpr float kUntouched = -7;

// Takes one of these, or leaves what was there.
template <typename T>
void maybe(Random& random, T& value, std::initializer_list<std::type_identity_t<T>> others) {
  if (random.below(4) == 0) value = *(others.begin() + random.below(static_cast<std::uint32_t>(others.size())));
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

  const Basis basis_ = load_basis(hero());
  const api::Model model_ = api::load_model(hero(), hero_dynamics(), kept_file("hero.attached.safetensors"));
  PoseArrays given_{turning_poses(basis_, kFrames)};
  // As many as the strides of `joints` and `skinning` reach over.
  std::vector<float> matrices_ = std::vector<float>(kRoom, 0.0f);
  std::vector<double> joints_ = std::vector<double>(kRoom, 0.5);
  std::vector<double> nans_ = std::vector<double>(kRoom, std::numeric_limits<double>::quiet_NaN());
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
  std::map<int, int> codes;
  for (int call = 0; call < 4000; ++call) {
    Random random(static_cast<std::uint32_t>(call));
    memory_.assign(members.size() + 1, std::vector<float>(kRoom, kUntouched));
    bodyopt_poses poses = given_.all;
    poses.joints = joints_.data();
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
    ASSERT_TRUE(result == BODYOPT_OK || result == BODYOPT_MISMATCH || result == BODYOPT_USAGE)
        << call << ": " << bodyopt_last_error();
    expect_within(outputs, call);
  }
  EXPECT_GT(codes[BODYOPT_OK], 50);
  EXPECT_GT(codes[BODYOPT_USAGE], 500);
  EXPECT_GT(codes[BODYOPT_MISMATCH], 100);
  api::check(bodyopt_evaluate(still.get(), &given_.all, &found.all));
  EXPECT_EQ(found.positions, expected.positions);
}

}  // namespace random_calls_test
}  // namespace bodyopt::testing
