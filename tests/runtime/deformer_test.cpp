#include "runtime/deformer/deformer.h"

#include "runtime/basis/basis.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/paths.h"

namespace bodyopt::testing {
namespace deformer_test {

// Of the same poses, with and without.
TEST(DeformerNormals, AreLeftOutWhereNobodyWantsThem) {
  const Basis basis = load_basis(kSourceFolder + "/tests/old_files/hero.safetensors");
  const std::vector<Pose> poses(3, bind_pose(basis.skeleton));
  for (const DeviceChoice& choice : {DeviceChoice{.name = "cpu"}, test_device()}) {
    Deformer deformer(basis, choice);
    const Evaluation with = deformer.evaluate(poses);
    deformer.set_normals(false);
    const Evaluation without = deformer.evaluate(poses);
    EXPECT_EQ(with.normals.size(), with.positions.size());
    EXPECT_TRUE(without.normals.empty());
    EXPECT_EQ(without.positions, with.positions);
    deformer.set_normals(true);
    EXPECT_EQ(deformer.evaluate(poses).normals, with.normals);
  }
}

}  // namespace deformer_test
}  // namespace bodyopt::testing
