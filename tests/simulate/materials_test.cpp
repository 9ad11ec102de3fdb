#include "trainer/simulate/materials.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/simulate/limb.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"
#include "trainer/simulate/quasi_static.h"

namespace bodyopt::trainer {
namespace {

using namespace testing;

std::string file_of(const std::string& entries) { return R"({"schema": "bodyopt-materials-1", )" + entries + "}"; }

TEST(Materials, TheShippedFileSaysWhatTheDefaultsAre) {
  const Materials shipped = read_materials(kSourceFolder + "/rigs/materials.json"), defaults;
  EXPECT_EQ(std::memcmp(&shipped, &defaults, sizeof(Materials)), 0);  // doubles only: no padding
}

TEST(Materials, EveryValueOfTheFileReachesTheShape) {
  const TemporaryFolder folder;
  const Character limb = make_limb();
  const Cage cage = own_cage(limb.vertices, limb.triangles, limb.weights, 0.05);
  Muscle extensor = make_flexor();
  extensor.name = "extensor";
  for (MusclePoint& point : extensor.path) point.position[1] *= -1;
  const std::vector<Muscle> muscles{make_flexor(), extensor};
  const AnatomyField anatomy(limb, muscles, kLimbAnatomy);
  const Pose pose = bent(limb, degrees(40));
  const std::vector<double> flex{0.5, 0};
  const auto solved = [&](const Materials& materials) {
    return QuasiStaticBody(limb, muscles, anatomy, cage, materials).solve(pose, flex);
  };
  const QuasiStaticBody body(limb, muscles, anatomy, cage);
  const SolvedPose standard = body.solve(pose, flex);
  for (const char* entry :
       {R"("fat": {"shear_modulus_pa": 6e3})", R"("fat": {"lame_lambda_pa": 40e3})",
        R"("muscle": {"shear_modulus_pa": 20e3})", R"("muscle": {"lame_lambda_pa": 40e3})",
        R"("muscle": {"bulk_modulus_pa": 1e5})", R"("active_fibres": {"stiffness_pa": 100e3, "source": "a test"})",
        R"("active_fibres": {"slack_stretch": 0.9})", R"("passive_fibres": {"stiffness_pa": 200e3})",
        R"("bone_springs": {"stiffness_n_per_m4": 1e7})", R"("skin": {"bending_stiffness_n_m": 0.04})"}) {
    write_bytes(folder / "m.json", file_of(entry));
    const Materials materials = read_materials(folder / "m.json");
    const SolvedPose other = solved(materials);
    EXPECT_TRUE(other.status.converged) << entry;
    EXPECT_GT((other.nodes - standard.nodes).rowwise().norm().maxCoeff(), 2e-5) << entry;
    EXPECT_NE(QuasiStaticBody(limb, muscles, anatomy, cage, materials).hash(), body.hash()) << entry;
  }
  // Contact is felt in a fold only.
  write_bytes(folder / "m.json", file_of(R"("contact": {"stiffness_pa_per_m": 1e6})"));
  const AnatomyField passive(limb, {}, kLimbAnatomy);
  const Pose folded = bent(limb, degrees(140));
  const SolvedPose hard = QuasiStaticBody(limb, {}, passive, cage).solve(folded),
                   soft = QuasiStaticBody(limb, {}, passive, cage, read_materials(folder / "m.json")).solve(folded);
  EXPECT_GT(soft.status.contact_depth, 1.5 * hard.status.contact_depth);
}

TEST(Materials, DamagedFilesAreRefused) {
  const TemporaryFolder folder;
  const auto read = [](const std::filesystem::path& path) { read_materials(path); };
  for (const char* entry : {R"("fat": {"shear_modulus_pa": 0})", R"("fat": {"shear_modulus": 4e3})",
                            R"("fat": {"shear_modulus_pa": "4e3"})", R"("fat": 4)", R"("bone": {})",
                            R"("active_fibres": {"slack_stretch": 1})", R"("skin": {"bending_stiffness_n_m": -1})"}) {
    expect_refused(read, folder / "m.json", file_of(entry), "");
  }
  expect_every_truncation_refused(read, folder / "m.json", file_of(R"("fat": {"shear_modulus_pa": 4e3})"));
}

}  // namespace
}  // namespace bodyopt::trainer
