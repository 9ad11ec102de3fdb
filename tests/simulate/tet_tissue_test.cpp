#include "trainer/simulate/tet_tissue.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numbers>

#include "geometry/mend_surface.h"
#include "tests/simulate/tube_field.h"
#include "trainer/tets/lattice_cage.h"
#include "trainer/tets/tets.h"

namespace bodyopt::trainer {
namespace {

double volume_of(const TetMesh& mesh, std::size_t tet) {
  return tet_edges(mesh, static_cast<Eigen::Index>(tet)).determinant() / 6;
}

// Cubic metres of all tets.
TissueShares volumes(const TetMesh& mesh, const TetTissue& tissue) {
  TissueShares sum;
  for (std::size_t t = 0; t < tissue.shares.size(); ++t) {
    const TissueShares& share = tissue.shares[t];
    const double volume = volume_of(mesh, t);
    sum.bone += volume * share.bone;
    sum.fat += volume * share.fat;
    sum.cavity += volume * share.cavity;
    sum.muscle += volume * share.muscle;
    sum.lean += volume * share.lean;
  }
  return sum;
}

double cylinder(double radius, double length) { return std::numbers::pi * radius * radius * length; }

class OfTube : public ::testing::Test {
 protected:
  Character limb_ = make_limb();
  TetMesh mesh_ = tetrahedralise(limb_.vertices, limb_.triangles, 0.05);
};

TEST_F(OfTube, SharesAreTheFieldsVolumesHoweverLargeTheTets) {
  const double bone = cylinder(kBoneRadius, kTubeLength), muscle = cylinder(kBellyRadius, kBellyTo - kBellyFrom);
  for (const auto& [size, error] : {std::pair(0.05, 0.1), std::pair(0.012, 0.03)}) {  // of tets: metres, of volumes
    const TetMesh mesh = tetrahedralise(limb_.vertices, limb_.triangles, size);
    const TetTissue tissue = find_tissue(mesh, tube_tissue);
    ASSERT_EQ(tissue.shares.size(), static_cast<std::size_t>(mesh.tets.rows()));
    for (const TissueShares& share : tissue.shares) EXPECT_NEAR(share.sum(), 1, 1e-12);
    const TissueShares sum = volumes(mesh, tissue);
    EXPECT_NEAR(sum.bone, bone, error * bone) << size;
    EXPECT_NEAR(sum.muscle, muscle, error * muscle) << size;
    EXPECT_LT(sum.lean, 0.03 * muscle) << size;  // slivers
    EXPECT_EQ(sum.cavity, 0);
  }
}

// Of a tet that is all bone: as if integrated.
TEST_F(OfTube, MomentsOfFullTetsAreExact) {
  const TetTissue tissue = find_tissue(mesh_, [](const Eigen::Vector3d&) {
    return PointTissue{{TissueKind::bone, 0, -1}};
  });
  ASSERT_EQ(tissue.bones.size(), tissue.shares.size());
  for (const BonePart& part : tissue.bones) {
    const Eigen::Matrix4d exact = (Eigen::Matrix4d::Ones() + Eigen::Matrix4d::Identity()) / 20;
    EXPECT_LT((part.moments / part.volume() - exact).cwiseAbs().maxCoeff(), 1e-4);
  }
}

TEST_F(OfTube, BonesGoWithTheirJointsWhereTheyLie) {
  const TetTissue tissue = find_tissue(mesh_, tube_tissue);
  std::vector<double> bone(tissue.shares.size(), 0);
  double of_joint[2] = {0, 0}, along[2] = {0, 0};
  for (const BonePart& part : tissue.bones) {
    bone[static_cast<std::size_t>(part.tet)] += part.volume();
    of_joint[part.joint] += part.volume();
    const Eigen::Vector4d first = part.moments.rowwise().sum();
    for (int a = 0; a < 4; ++a) along[part.joint] += first[a] * mesh_.nodes(mesh_.tets(part.tet, a), 0);
  }
  for (std::size_t t = 0; t < bone.size(); ++t) {
    EXPECT_NEAR(bone[t], tissue.shares[t].bone * volume_of(mesh_, t), 1e-15);
  }
  EXPECT_NEAR(along[0] / of_joint[0], 0.25 * kTubeLength, 0.004);
  EXPECT_NEAR(along[1] / of_joint[1], 0.75 * kTubeLength, 0.004);
}

TEST_F(OfTube, FibresAreMeansOfWhatIsInTheTet) {
  const TetTissue tissue = find_tissue(mesh_, [](const Eigen::Vector3d& point) {
    PointTissue at = tube_tissue(point);
    if (at.at.kind == TissueKind::muscle) at.fibre = Eigen::Vector3d(1, point.z() > 0 ? 0.2 : -0.2, 0).normalized();
    return at;
  });
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double volume = 0;
  for (const FibreTet& fibre : tissue.fibres) {
    const double part = fibre.share * volume_of(mesh_, static_cast<std::size_t>(fibre.tet));
    EXPECT_NEAR(fibre.direction.norm(), 1, 1e-12);
    mean += part * fibre.direction;
    volume += part;
  }
  EXPECT_NEAR(volume, volumes(mesh_, tissue).muscle, 1e-15);
  EXPECT_LT((mean / volume - Eigen::Vector3d::UnitX()).norm(), 0.05);
}

// A thread in every tet that another muscle fills: it pulls nowhere if it is a sliver everywhere, unless it is kept.
TEST_F(OfTube, SliversOfAMuscleAreLeanUnlessItIsNothingElse) {
  const auto threaded = [](double radius) {
    return [radius](const Eigen::Vector3d& point) {
      PointTissue at = tube_tissue(point);
      if (at.at.kind == TissueKind::muscle && (point.tail<2>() - Eigen::Vector2d(kBellyOff, 0)).norm() < radius) {
        at.at.muscle = 1;
      }
      return at;
    };
  };
  const auto shares_of_thread = [&](double radius) {
    std::vector<double> shares;
    for (const FibreTet& fibre : find_tissue(mesh_, threaded(radius)).fibres) {
      if (fibre.muscle == 1) shares.push_back(fibre.share);
    }
    return shares;
  };
  const std::vector<double> thin = shares_of_thread(0.0012), thick = shares_of_thread(0.006);
  ASSERT_FALSE(thin.empty());
  ASSERT_FALSE(thick.empty());
  EXPECT_GE(*std::ranges::min_element(thick), TetTissue::kLeastShare);
}

// Tets that mirror each other, of a field that is its own mirror image.
TEST_F(OfTube, MirrorImagesHaveEqualShares) {
  TetMesh other = mesh_;
  other.nodes.col(2) *= -1;
  orient(other);
  const TetTissue here = find_tissue(mesh_, tube_tissue), there = find_tissue(other, tube_tissue);
  for (std::size_t t = 0; t < here.shares.size(); ++t) {
    EXPECT_NEAR(here.shares[t].bone, there.shares[t].bone, 1e-12);
    EXPECT_NEAR(here.shares[t].fat, there.shares[t].fat, 1e-12);
    EXPECT_NEAR(here.shares[t].muscle, there.shares[t].muscle, 1e-12);
  }
  ASSERT_EQ(here.fibres.size(), there.fibres.size());
}

TEST_F(OfTube, ALatticeIsAsFullAsItsSamples) {
  const Cage cage = lattice_cage(limb_.vertices, limb_.triangles, limb_.weights, 300);
  const TetTissue tissue = find_tissue(cage, tube_tissue);
  double tets = 0;
  for (std::size_t t = 0; t < tissue.shares.size(); ++t) tets += volume_of(cage.mesh, t);
  const TissueShares sum = volumes(cage.mesh, tissue);
  EXPECT_LT(sum.sum(), 0.9 * tets);
  EXPECT_NEAR(sum.sum(), enclosed_volume(limb_.vertices, limb_.triangles), 0.08 * sum.sum());
  const double bone = cylinder(kBoneRadius, kTubeLength);
  EXPECT_NEAR(sum.bone, bone, 0.1 * bone);
}

TEST(TetMaterials, AreMeansOfTheTissues) {
  const Materials materials;
  TissueShares half;
  half.fat = half.cavity = 0.5;
  TissueShares lean;
  lean.lean = lean.bone = 0.25;
  lean.muscle = 0.5;
  const std::vector<TetMaterial> found = tet_materials({half, lean}, materials);
  EXPECT_DOUBLE_EQ(found[0].mu, 0.5 * (materials.fat.mu + materials.cavity.mu));
  EXPECT_DOUBLE_EQ(found[1].mu, materials.muscle.mu);
  EXPECT_DOUBLE_EQ(found[1].lambda, materials.muscle.lambda);
}

}  // namespace
}  // namespace bodyopt::trainer
