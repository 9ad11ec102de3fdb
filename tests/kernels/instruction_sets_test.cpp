// Every set of instructions that the processor has gives the same bits, those of one lane at a time too.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "runtime/cpu/kernels.h"
#include "runtime/cpu/ddm_frames.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace instruction_sets_test {

constexpr std::uint32_t kJoints = 9;

std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

// Runs the kernel with each set in turn, into outputs that hold a NaN before.
void expect_same_bits(std::size_t count, const std::function<void(std::span<float>)>& kernel) {
  std::vector<std::uint32_t> first;
  std::size_t sets = 0;
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    std::vector<float> values(count, std::numeric_limits<float>::quiet_NaN());
    kernel(values);
    for (const float value : values) ASSERT_TRUE(std::isfinite(value)) << hwy::TargetName(target);
    if (first.empty()) first = bits_of(values);
    EXPECT_EQ(bits_of(values), first) << hwy::TargetName(target);
    ++sets;
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  EXPECT_GT(sets, 1u);
}

struct Skin {
  explicit Skin(std::uint32_t vertex_count)
      : random(vertex_count),
        vertices(vertex_count),
        ddm(random_ddm(random, vertices, kJoints)),
        skinning(random_skinning(random, kJoints, 2, 2.5)),
        origins(random.floats(8, -100, 100)),
        displacements(random.floats(std::size_t{6} * vertices, -0.01, 0.01)) {}

  Random random;
  std::uint32_t vertices;
  DdmTable ddm;
  std::vector<float> skinning, origins, displacements;
};

TEST(InstructionSets, PoseSkin) {
  for (const std::uint32_t vertices : {1u, 15u, 16u, 17u, 1237u}) {
    SCOPED_TRACE(vertices);
    const Skin skin(vertices);
    expect_same_bits(skin.displacements.size(), [&](std::span<float> positions) {
      cpu::pose_skin(skin.ddm, kJoints, skin.skinning, skin.origins, skin.displacements, positions);
    });
  }
}

TEST(InstructionSets, VertexFrames) {
  Skin skin(700);
  std::vector<std::uint32_t> some;
  for (int k = 0; k < 300; ++k) some.push_back(skin.random.below(skin.vertices));
  expect_same_bits(12 * some.size(),
                   [&](std::span<float> frames) { cpu::vertex_frames(skin.ddm, some, skin.skinning.data(), frames); });
}

TEST(InstructionSets, ResidualBlend) {
  constexpr std::uint32_t kCoefficients = 90;
  for (const std::uint32_t vertices : {1u, 16u, 1237u}) {
    SCOPED_TRACE(vertices);
    Random random(vertices);
    const ResidualTable table = random_residual(random, 20, 0, kCoefficients, vertices);
    const std::vector<float> coefficients = random.floats(2 * kCoefficients, -1, 1);
    expect_same_bits(std::size_t{6} * vertices, [&](std::span<float> displacements) {
      cpu::residual_blend(table, coefficients, 2, 0.7f, displacements);
    });
  }
}

}  // namespace instruction_sets_test
}  // namespace bodyopt::testing
