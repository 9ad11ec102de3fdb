// What a region's map listens to.
#include "trainer/train/fit/choose_map.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/random_tables.h"

namespace bodyopt::trainer {
namespace {

constexpr Eigen::Index kPoses = 150, kJointFeatures = 3, kStrains = 40;

// Joints that swing and strains at random, of muscles or of curves; `strain`: how much of the motion the first strain
// makes.
class Heard {
 public:
  Heard(double strain, bool of_curves) {
    testing::Random random(5);
    const auto noise = [&](Eigen::Index rows, Eigen::Index columns) {
      return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.uniform(-1.7, 1.7); }));
    };
    features_.values = noise(kPoses, kJointFeatures + kStrains);
    features_.rest = Eigen::RowVectorXd::Zero(kJointFeatures + kStrains);
    model_.region = {"part", {0, 1}, {1, 1}};
    model_.components.coefficients = 0.05 * noise(kPoses, 2);
    model_.components.coefficients.col(0) += features_.values.col(0) + strain * features_.values.col(kJointFeatures);
    model_.components.coefficients.col(1) += features_.values.col(1).cwiseAbs2();
    std::vector<std::uint32_t> joints = {0, 1, 2}, all = joints;
    for (std::uint32_t s = 0; s < kStrains; ++s) all.push_back(static_cast<std::uint32_t>(kJointFeatures) + s);
    const std::vector<int> folds = blocked_folds(std::vector<int>(kPoses, 0), 20, 5);
    choose_map(features_, {kJointFeatures, kStrains, of_curves}, {joints, all}, model_.components.coefficients, folds,
               {}, {.centres = 40}, model_);
  }

  std::size_t strains() const {
    std::size_t count = 0;
    for (const std::uint32_t feature : model_.features) count += feature >= kJointFeatures;
    return count;
  }
  bool has(std::uint32_t feature) const {
    return std::find(model_.features.begin(), model_.features.end(), feature) != model_.features.end();
  }

 private:
  FeatureSamples features_;
  RegionModel model_;
};

TEST(ChooseMap, StrainsThatTellTheMotionAreHeard) {
  EXPECT_TRUE(Heard(0.8, false).has(kJointFeatures));
  EXPECT_TRUE(Heard(0.8, true).has(kJointFeatures));
}

TEST(ChooseMap, CurvesThatTellNothingAreNot) { EXPECT_EQ(Heard(0, true).strains(), 0u); }

}  // namespace
}  // namespace bodyopt::trainer
