#include "trainer/simulate/muscle_volume.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/simulate/tube_field.h"
#include "trainer/simulate/materials.h"
#include "trainer/simulate/quasi_static.h"
#include "trainer/tets/tets.h"

namespace bodyopt::trainer {
namespace {

struct Case {
  Case() : limb(make_limb()), mesh(tetrahedralise(limb.vertices, limb.triangles, 0.05)) {
    fibres = find_tissue(mesh, tube_tissue).fibres;
    for (std::size_t k = 0; k < fibres.size(); k += 3) fibres[k].share = 0.4;
  }
  Character limb;
  TetMesh mesh;
  std::vector<FibreTet> fibres;
};

TEST(MuscleVolume, ScalingAndRigidMotionChangeItAsTheyMust) {
  const Case c;
  const MuscleVolume volume(c.mesh, c.fibres, 1);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(3, 1, 2).normalized()).toRotationMatrix();
  EXPECT_NEAR(volume.largest_change(c.mesh.nodes * turn.transpose()), 0, 1e-12);
  const Positions larger = 1.1 * c.mesh.nodes;
  EXPECT_NEAR(volume.largest_change(larger), std::pow(1.1, 3) - 1, 1e-12);
  double rest = 0;
  for (const FibreTet& fibre : c.fibres) rest += fibre.share * tet_edges(c.mesh, fibre.tet).determinant() / 6;
  Positions gradient = Positions::Zero(larger.rows(), 3);
  const double expected = 0.5 * Materials{}.muscle_bulk * rest * std::pow(std::pow(1.1, 3) - 1, 2);
  EXPECT_NEAR(volume.add_gradient(larger, gradient), expected, 1e-9 * expected);
}

TEST(MuscleVolume, GradientAndModesAreTheDerivative) {
  const Case c;
  const MuscleVolume volume(c.mesh, c.fibres, 1);
  std::srand(4);
  const Positions nodes = 1.05 * c.mesh.nodes + 1e-4 * Positions::Random(c.mesh.nodes.rows(), 3);
  Positions gradient = Positions::Zero(nodes.rows(), 3), unused = gradient;
  volume.add_gradient(nodes, gradient);
  const auto [modes, stiffness] = volume.stiff_modes(nodes);
  ASSERT_EQ(modes.size(), 1u);
  // gradient = stiffness x (V - V_rest) x mode, all of it along the one mode.
  Positions mode = Positions::Zero(nodes.rows(), 3);
  for (const auto& [node, vector] : modes[0]) mode.row(node) += vector;
  EXPECT_NEAR(gradient.cwiseProduct(mode).sum(), gradient.norm() * mode.norm(), 1e-9 * gradient.norm() * mode.norm());
  for (int k = 0; k < 3; ++k) {
    const Positions direction = Positions::Random(nodes.rows(), 3);
    const double step = 1e-7;
    const double slope = (volume.add_gradient(nodes + step * direction, unused) -
                          volume.add_gradient(nodes - step * direction, unused)) /
                         (2 * step);
    EXPECT_NEAR(gradient.cwiseProduct(direction).sum(), slope, 1e-5 * gradient.norm());
  }
}

TEST(MuscleVolume, IsKeptWhenAMuscleShortens) {
  const Character limb = make_limb();
  const QuasiStaticBody body = own_body(limb, {make_flexor()}, 0.05, kLimbAnatomy);
  for (const double angle : {60.0, 120.0}) {
    EXPECT_LT(std::abs(body.solve(bent(limb, degrees(angle))).status.volume_change), 0.02) << angle;
  }
}

}  // namespace
}  // namespace bodyopt::trainer
