// The CPU's kernels ask of an address no more than its numbers do. (Those in lanes, and what they are given beside
// tables: instruction_sets_test.cpp.)
#include "tests/support/odd_addresses.h"

#include <gtest/gtest.h>

#include "runtime/cpu/cpu_backend.h"
#include "tests/support/random_basis.h"
#include "tests/support/random_jiggle.h"
#include "tests/support/same_basis.h"
#include "tests/support/small_inverse.h"

namespace bodyopt::testing {
namespace odd_addresses_test {

// Of as many unknowns, some of them nobody's.
BlockInverse random_inverse(Random& random, std::uint32_t own, std::uint32_t unknowns) {
  BlockInverse inverse = SmallInverse(random, own).inverse;
  EXPECT_LE(inverse.unknown_count, unknowns);
  inverse.unknown_count = unknowns;
  return inverse;
}

Dynamics random_dynamics(const Basis& basis) {
  constexpr std::uint32_t kNodes = 150, kSurface = 60;
  Random random(kNodes);
  Dynamics dynamics;
  TetTable& tets = dynamics.tets;
  tets = random_tets(random, kNodes);
  tets.surface = random_surface_points(random, basis.mesh.vertex_count(), kSurface);
  tets.skin = random_tet_points(random, tets.tet_count(), basis.mesh.vertex_count());
  tets.skin_limit = random.floats(basis.mesh.vertex_count(), 0.1, 1);
  DiffuseTable& diffuse = dynamics.diffuse;
  JiggleTable& jiggle = dynamics.jiggle;
  for (std::uint32_t n = 0; n <= kNodes; ++n) diffuse.row_begin.push_back(n < kSurface ? 0 : n - kSurface);
  for (std::uint32_t n = 0; n < kNodes - kSurface; ++n) diffuse.columns.push_back(random.below(kSurface));
  diffuse.values = random.floats(diffuse.columns.size(), -1, 1);
  diffuse.inverse = random_inverse(random, 15, kNodes);
  jiggle.inverse = random_inverse(random, 50, 3 * kNodes);
  jiggle.nodes = random_jiggle_nodes(random, kNodes, basis.strain.fibre_count(), 2);
  return dynamics;
}

std::vector<float> all_of(const BatchResult& result) {
  return joined(
      {result.positions, result.normals, result.tangents, result.strains, result.excess, result.coefficients});
}

// All stages of two frames, by tables of both kinds.
TEST(OddAddresses, ChangeNoBit) {
  const Basis basis = with_on_top(with_on_top(with_random_modifiers(random_basis(20, 70), 6), kRelax), kPushOut);
  const auto model = std::make_shared<CharacterModel>(basis, random_dynamics(basis),
                                                      Random(1).floats(2 * basis.mesh.output_count(), 0, 1));
  Batch batch = random_batch(basis, 2);
  batch.wants_tangents = true;
  JiggleFrame frame;
  frame.steps = 2;
  frame.kick.inverse_interval = 24;
  batch.jiggle = {frame, frame};
  batch.jiggle[1].kick.start = 2;
  const auto run = [&] { return all_of(make_cpu_backend(model, {&*model->dynamics, {}})->run(batch)); };
  const std::vector<float> usual = run();
  for (const float number : usual) ASSERT_TRUE(std::isfinite(number));
  move_to_odd_addresses(model->basis.mesh);
  move_to_odd_addresses(model->basis.ddm);
  move_to_odd_addresses(model->basis.strain);
  move_to_odd_addresses(model->basis.residual);
  move_to_odd_addresses(model->basis.modifiers);
  move_to_odd_addresses(*model->dynamics);
  move_to_odd_addresses(model->folds.triangles, model->folds.sides, model->near.triangles, model->near.vertex_triangles,
                        model->tangents.vertices, model->tangents.corners);
  move_to_odd_addresses(batch.skinning, batch.origins, batch.joint_features, batch.controls, batch.fades,
                        batch.modifiers);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(model->basis.ddm.moments.data()) % 16, 4u);
  EXPECT_TRUE(same_bits(run(), usual));
}

}  // namespace odd_addresses_test
}  // namespace bodyopt::testing
