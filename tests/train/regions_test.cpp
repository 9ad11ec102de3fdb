// Fibres, features and regions of a synthetic limb.
#include "trainer/train/regions/regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "geometry/mesh.h"
#include "geometry/nearest_skin.h"
#include "runtime/cpu/kernels.h"
#include "runtime/host/rig.h"
#include "tests/support/capsule_limb.h"
#include "trainer/train/features/features.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

// The limb in runtime order, up to its fibres.
struct Limb {
  Limb() {
    const Character character = limb_character();
    ordered = in_order(character, morton_order(character.vertices));
    basis = build_ddm_basis(character, {});
    basis.strain = make_strain_table(basis, muscles);
    moments = ddm_moments(ordered.vertices, ordered.triangles, ordered.weights, {.radius = 0.02});
    for (const Sample& sample : limb_samples(60, 0).train) poses.push_back(sample.pose);
    std::vector<const Pose*> pointers;
    for (const Pose& pose : poses) pointers.push_back(&pose);
    features = measure_features(basis, pointers);
    displacements.resize(60, 3 * ordered.vertices.rows());
    for (Eigen::Index n = 0; n < 60; ++n) {
      const Pose& pose = poses[static_cast<std::size_t>(n)];
      const Positions delta = unpose_ddm(basis, pose, limb_truth(ordered, muscles, pose));
      displacements.row(n) = Eigen::Map<const Eigen::RowVectorXd>(delta.data(), delta.size()).cast<float>();
    }
    groups = make_feature_groups(basis, moments, muscles, features.values, displacements);
  }

  std::vector<Muscle> muscles = limb_muscles();
  Character ordered;
  Basis basis;
  std::vector<VertexMoments> moments;
  std::vector<Pose> poses;
  FeatureSamples features;
  Displacements displacements;
  std::vector<FeatureGroup> groups;
};

const Limb& limb() {
  static const Limb instance;
  return instance;
}

TEST(NearestSkin, FindsTheNearestOfAllPoints) {
  const Character character = limb_character();
  const NearestSkin nearest(character.vertices, character.triangles);
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0.02, 0.01, 0.3), {0.2, 0, 0.1}, {0, 0, -1}, {0.01, -0.06, 0.55}}) {
    const SkinPoint found = nearest(point);
    EXPECT_NEAR(found.weights.sum(), 1, 1e-12);
    EXPECT_GE(found.weights.minCoeff(), 0);
    Eigen::Vector3d rebuilt = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      rebuilt += found.weights[static_cast<Eigen::Index>(k)] * character.vertices.row(found.vertices[k]).transpose();
    }
    EXPECT_LT((rebuilt - found.position).norm(), 1e-12);
    // A dense sampling of every triangle finds nothing nearer.
    double best = 1e9;
    for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) {
      for (int i = 0; i <= 8; ++i) {
        for (int j = 0; i + j <= 8; ++j) {
          const Eigen::RowVector3d sample = (i * character.vertices.row(character.triangles(t, 0)) +
                                             j * character.vertices.row(character.triangles(t, 1)) +
                                             (8 - i - j) * character.vertices.row(character.triangles(t, 2))) /
                                            8;
          best = std::min(best, (sample.transpose() - point).norm());
        }
      }
    }
    EXPECT_LE((found.position - point).norm(), best + 1e-12);
  }
}

TEST(Strain, FibresLieOnTheSkinAboveTheirMuscle) {
  const StrainTable& strain = limb().basis.strain;
  ASSERT_EQ(strain.fibre_count(), 6u);
  EXPECT_EQ(strain.names[0], "flexor/1");
  EXPECT_EQ(strain.names[5], "extensor/3");
  for (std::uint32_t k = 0; k < strain.fibre_count(); ++k) {
    EXPECT_GE(strain.fibre_begin[k + 1] - strain.fibre_begin[k], 10u);
    const double side = k < 3 ? 1 : -1;  // the flexor faces +Y, the extensor -Y
    for (std::uint32_t p = strain.fibre_begin[k]; p < strain.fibre_begin[k + 1]; ++p) {
      const FibrePoint& point = strain.points[p];
      const float weights[] = {point.wa, point.wb, point.wc};
      const std::uint32_t corners[] = {point.a, point.b, point.c};
      double y = 0, sum = 0;
      for (int i = 0; i < 3; ++i) {
        y += double{weights[i]} * limb().ordered.vertices(strain.vertices[corners[i]], 1);
        sum += double{weights[i]};
      }
      EXPECT_NEAR(sum, 1, 1e-6);
      EXPECT_GT(side * y, 0.01);
    }
    // A muscle of 0.36 m; its fibres run beside it.
    EXPECT_NEAR(strain.rest_length[k], 0.36, 0.04);
  }
}

TEST(Strain, TheFlexorShortensAsTheExtensorStretches) {
  for (const float strain : measure_strains(limb().basis, bind_pose(limb().ordered.skeleton)))
    EXPECT_NEAR(strain, 0, 1e-6);
  const auto strains = measure_strains(limb().basis, limb_pose(limb().ordered.skeleton, -1.2, 0, 0));
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(strains[k], -0.02);
    EXPECT_GT(strains[k + 3], 0.02);
  }
}

TEST(Strain, WithoutMusclesThereIsNone) {
  const StrainTable strain = make_strain_table(limb().basis, {});
  EXPECT_EQ(strain.fibre_count(), 0u);
  EXPECT_EQ(strain.fibre_begin, std::vector<std::uint32_t>{0});
}

TEST(Strain, MusclesOfOnePointOrNoLengthGiveNoFibre) {
  std::vector<Muscle> muscles = limb_muscles();
  muscles[0].path.resize(1);
  for (MusclePoint& point : muscles[1].path) point.position = {0, 0, 0.2};
  EXPECT_EQ(make_strain_table(limb().basis, muscles).fibre_count(), 0u);
}

TEST(Features, AreStandardisedAndCoverTheirPoses) {
  const FeatureSamples& features = limb().features;
  ASSERT_EQ(features.values.cols(), 9 * 2 + 6);
  EXPECT_TRUE(features.values.allFinite());
  for (Eigen::Index k = 0; k < features.values.cols(); ++k) {
    const FeatureRange& range = features.ranges[static_cast<std::size_t>(k)];
    EXPECT_LE(range.low, range.high);
    EXPECT_NEAR(features.values.col(k).mean(), 0, 1e-3);
    EXPECT_LT(features.values.col(k).squaredNorm() / 60, 1.001);
  }
  // The wrist only turns about Y: what it does to Y never changes and must say nothing.
  EXPECT_LT(features.values.col(9 + 4).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(Regions, AreASmoothPartitionOfUnity) {
  const std::vector<RegionWeights> regions = make_regions(limb().ordered, limb().groups, {});
  EXPECT_GE(regions.size(), 2u);
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(limb().ordered.vertices.rows());
  for (const RegionWeights& region : regions) {
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(sums.size());
    for (std::size_t k = 0; k < region.vertices.size(); ++k) {
      EXPECT_TRUE(k == 0 || region.vertices[k - 1] < region.vertices[k]);
      EXPECT_GT(region.weights[k], 0);
      weights[region.vertices[k]] = region.weights[k];
    }
    sums += weights;
    for (Eigen::Index t = 0; t < limb().ordered.triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_LT(std::abs(weights[limb().ordered.triangles(t, k)] - weights[limb().ordered.triangles(t, (k + 1) % 3)]),
                  0.6);
      }
    }
  }
  EXPECT_LT((sums.array() - 1).abs().maxCoeff(), 1e-12);
}

// All of the limb above 0.4 m, fading out below it.
RegionWeights painted_hand(const Character& character) {
  RegionWeights hand{"joint0", {}, {}};  // the name that a region of training would have
  for (std::uint32_t v = 0; v < character.vertices.rows(); ++v) {
    const double weight = std::min(1.0, (character.vertices(v, 2) - 0.35) / 0.05);
    if (weight < kNegligibleRegionWeight) continue;
    hand.vertices.push_back(v);
    hand.weights.push_back(weight);
  }
  return hand;
}

TEST(Regions, PaintedOnesKeepTheirShareAndTrainingCoversTheRest) {
  const RegionWeights hand = painted_hand(limb().ordered);
  const std::vector<RegionWeights> regions = make_regions(limb().ordered, limb().groups, {hand});
  std::set<std::string> names;
  double lowest = 1e9, highest = 0;  // of what training covers
  for (const RegionWeights& region : regions) {
    EXPECT_TRUE(names.insert(region.name).second) << region.name;
    if (region.name == hand.name) {
      EXPECT_EQ(region.vertices, hand.vertices);
      for (std::size_t k = 0; k < hand.weights.size(); ++k) {
        // What is below 3 % of a region of training goes to the others.
        EXPECT_NEAR(region.weights[k], hand.weights[k], hand.weights[k] < 1 ? kNegligibleRegionWeight : 0);
      }
      continue;
    }
    for (const std::uint32_t v : region.vertices) {
      lowest = std::min(lowest, limb().ordered.vertices(v, 2));
      highest = std::max(highest, limb().ordered.vertices(v, 2));
    }
  }
  EXPECT_TRUE(names.contains("joint0"));
  EXPECT_TRUE(names.contains("joint0 2"));  // the lower end lies at the first joint, whose name is taken
  EXPECT_LT(lowest, 0.01);
  EXPECT_LT(highest, 0.4);
  const Eigen::VectorXd sums = sum_of_weights(regions, limb().ordered.vertices.rows());
  EXPECT_LT((sums.array() - 1).abs().maxCoeff(), 1e-9);
}

TEST(Regions, WhereAllIsPaintedTrainingAddsNone) {
  const std::vector<RegionWeights> own = make_regions(limb().ordered, limb().groups, {});
  const std::vector<RegionWeights> again = make_regions(limb().ordered, limb().groups, own);
  ASSERT_EQ(again.size(), own.size());
  for (std::size_t r = 0; r < own.size(); ++r) {
    EXPECT_EQ(again[r].name, own[r].name);
    EXPECT_EQ(again[r].vertices, own[r].vertices);
    EXPECT_EQ(again[r].weights, own[r].weights);
  }
}

TEST(Regions, FaintOnesSeeWhatIsNearToo) {
  RegionWeights faint;
  for (std::uint32_t v = 0; v < limb().ordered.vertices.rows(); ++v) {
    if (limb().ordered.vertices(v, 2) < 0.57) continue;
    faint.vertices.push_back(v);
    faint.weights.push_back(0.2);
  }
  RegionWeights strong = faint;
  strong.weights.assign(strong.vertices.size(), 1.0);
  EXPECT_EQ(region_features(limb().ordered, faint, limb().groups, 0.1),
            region_features(limb().ordered, strong, limb().groups, 0.1));
}

TEST(Regions, MusclesActAboveTheirBellyAndAcrossTheirJoints) {
  const auto& groups = limb().groups;
  ASSERT_EQ(groups.size(), 4u);                             // two joints, two muscles
  EXPECT_EQ(groups[2].spans, std::vector<std::size_t>{0});  // both muscles cross the elbow only
  const auto mean_influence = [&](std::size_t group, double low, double high) {
    double sum = 0, count = 0;
    for (Eigen::Index v = 0; v < limb().ordered.vertices.rows(); ++v) {
      const double z = limb().ordered.vertices(v, 2), y = limb().ordered.vertices(v, 1);
      if (z < low || z > high || std::abs(y) < 0.03) continue;
      sum += groups[group].influence[v];
      count += 1;
    }
    return sum / count;
  };
  for (const std::size_t muscle : {2u, 3u})
    EXPECT_GT(mean_influence(muscle, 0.1, 0.25), 5 * mean_influence(muscle, 0.5, 0.6));
}

TEST(Regions, SeeWhatIsNearAndNeverNothing) {
  RegionWeights tip;
  for (std::uint32_t v = 0; v < limb().ordered.vertices.rows(); ++v) {
    if (limb().ordered.vertices(v, 2) < 0.57) continue;
    tip.vertices.push_back(v);
    tip.weights.push_back(1);
  }
  const auto near = region_features(limb().ordered, tip, limb().groups, 0.1);
  for (const std::uint32_t feature : near) EXPECT_TRUE(feature >= 9 && feature < 18) << feature;  // the wrist
  EXPECT_FALSE(region_features(limb().ordered, tip, limb().groups, 0).empty());
  const auto all = region_features(limb().ordered, tip, limb().groups, 10);
  EXPECT_GT(all.size(), near.size());
}

TEST(Unpose, GivesBackWhatWasPosed) {
  // Posing a displaced skin by the runtime and un-posing it again.
  const Basis& basis = limb().basis;
  const Pose pose = limb_pose(basis.skeleton, 1.1, 0.3, -0.4);
  const RigFrame rig = pose_rig(basis.skeleton, pose);
  std::vector<float> delta(3 * basis.mesh.vertex_count()), posed(delta.size());
  for (std::size_t k = 0; k < delta.size(); ++k) delta[k] = 0.003f * std::sin(static_cast<float>(k));
  const float origin[] = {rig.origin[0], rig.origin[1], rig.origin[2], 0};
  cpu::pose_skin(basis.ddm, 3, rig.skinning, origin, delta, posed);
  const Positions unposed = unpose_ddm(basis, pose, rows_of(posed));
  for (std::size_t k = 0; k < delta.size(); ++k) EXPECT_NEAR(unposed.data()[k], delta[k], 2e-6);
  // Linear blend skinning un-posed is the rest skin.
  const Positions skinned = skin_linear(limb().ordered, pose);
  EXPECT_LT(unpose_linear(limb().ordered, pose, skinned).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace bodyopt::trainer
