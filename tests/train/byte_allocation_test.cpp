// What is kept at a price, against arithmetic done by hand, and what is left, against a sum over all vertices.
#include <gtest/gtest.h>

#include "runtime/cpu/kernels.h"
#include "tests/support/random_tables.h"
#include "trainer/train/pack/trade_off.h"

namespace bodyopt::trainer {
namespace byte_allocation_test {

constexpr std::uint32_t kVertices = 32, kBlocks = 2;
constexpr Eigen::Index kFrames = 10, kCentres = 4;

Regression fit_of(Eigen::Index centres, const Eigen::MatrixXd& errors) {
  Regression fit;
  fit.centres = Eigen::MatrixXd::Zero(centres, 1);
  fit.weights = Eigen::MatrixXd::Zero(1 + centres, errors.cols());
  fit.errors = errors;
  return fit;
}

// One region of all vertices and two components, each in a block of its own with a squared length of one there. Their
// coefficients are 2 and 1 m in every frame; the regression is off by 1 and 0.5 m; with fewer centres, by 1.2 and 1 m.
ResidualModel small_model() {
  ResidualModel model;
  model.vertices = kVertices;
  RegionModel& region = model.regions.emplace_back();
  for (std::uint32_t v = 0; v < kVertices; ++v) region.region.vertices.push_back(v);
  region.region.weights.assign(kVertices, 1.0);
  region.features = {0};
  region.projection = Eigen::MatrixXd::Identity(1, 1);
  Components& components = region.components;
  components.coefficients = Eigen::RowVector2d(2, 1).replicate(kFrames, 1);
  components.basis = Eigen::MatrixXd::Zero(2, 3 * kVertices);
  components.basis(0, 5) = components.basis(1, 3 * 20 + 1) = 1;
  components.truncated = Eigen::VectorXd::Constant(kFrames, 0.25);
  components.energy = components.coefficients.rowwise().squaredNorm() + components.truncated;
  region.fits.push_back(fit_of(kCentres, Eigen::RowVector2d(1, 0.5).replicate(kFrames, 1)));
  region.fits.push_back(fit_of(1, Eigen::RowVector2d(1.2, 1).replicate(kFrames, 1)));
  model.folds.assign(kFrames, 0);
  return model;
}

constexpr double kMotion = (4 + 1 + 0.25) / kVertices;
// What the first component saves with all centres; the second one saves a quarter of it.
constexpr double kSaved[] = {4 - 1, 1 - 0.25}, kSavedByFewer = 4 - 1.44;

// Bytes of the tables that come with what is kept.
double bytes(const ResidualModel& model, const Selection& selection) {
  const ResidualTable table = pack_residual(model, selection).table;
  return static_cast<double>(table.blend.size() * sizeof(BlendEntry) + table.regions.size() * sizeof(Region) +
                             sizeof(float) *
                                 (table.region_features.size() + table.projections.size() +
                                  table.coordinate_region.size() + table.centre_region.size() + table.centres.size() +
                                  table.coefficient_region.size() + table.weights.size()));
}

// A price at which nothing but rounding is not worth its bytes.
constexpr double kCheap = 1e-6;

TEST(ByteAllocation, KeepsWhatSavesMoreThanItCosts) {
  const ResidualModel model = small_model();
  const ByteAllocation allocation(model);
  const Selection all = allocation.at(kCheap);
  EXPECT_EQ(all[0].fit, 0u);
  EXPECT_EQ(all[0].blocks, (std::vector<std::vector<std::uint32_t>>{{0}, {1}}));
  Selection one = all;
  one[0].blocks[1].clear();
  const double second = bytes(model, all) - bytes(model, one);
  const double price = kSaved[1] / second / kMotion;  // at which the second component is worth just what it takes
  EXPECT_EQ(allocation.at(0.999 * price)[0].blocks, all[0].blocks);
  EXPECT_EQ(allocation.at(1.001 * price)[0].blocks, one[0].blocks);
}

TEST(ByteAllocation, DearBytesLeaveFewerCentresAndThenNothing) {
  const ResidualModel model = small_model();
  const ByteAllocation allocation(model);
  Selection many = allocation.at(kCheap), few = many;
  many[0].blocks[1].clear();
  few[0] = {1, many[0].blocks, many[0].fine};
  const double saved_bytes = bytes(model, many) - bytes(model, few);
  ASSERT_GT(saved_bytes, 0);
  const double price = (kSaved[0] - kSavedByFewer) / saved_bytes / kMotion;
  EXPECT_EQ(allocation.at(0.999 * price)[0].fit, 0u);
  EXPECT_EQ(allocation.at(1.001 * price)[0].fit, 1u);
  EXPECT_EQ(allocation.with_all_centres(1.001 * price)[0].fit, 0u);
  const double last = kSavedByFewer / bytes(model, few) / kMotion;
  EXPECT_EQ(allocation.at(0.999 * last)[0].blocks, few[0].blocks);
  EXPECT_TRUE(allocation.at(1.001 * last)[0].blocks.empty());
}

// A number between two that 8 bits can tell.
TEST(ByteAllocation, RoundingThatIsWorthItsBytesIsKept) {
  ResidualModel model = small_model();
  model.regions[0].components.basis(0, 4) = 0.5;
  const double left = rounding_of(model.regions[0], 0)[0].left;
  EXPECT_NEAR(left, std::pow(0.5 / 127, 2), 0.1 * left);
  const ByteAllocation allocation(model);
  const double price = 4 * left / sizeof(BlendEntry) / kMotion;
  const Selection cheap = allocation.at(0.98 * price), dear = allocation.at(1.02 * price);
  EXPECT_EQ(cheap[0].fine[0], std::vector<std::uint32_t>{0});
  EXPECT_TRUE(dear[0].fine[0].empty());
  EXPECT_EQ(cheap[0].blocks, dear[0].blocks);
  EXPECT_EQ(bytes(model, cheap) - bytes(model, dear), sizeof(BlendEntry));
}

TEST(ByteAllocation, ComponentsThatDoHarmAreNeverKept) {
  ResidualModel model = small_model();
  for (Regression& fit : model.regions[0].fits) fit.errors.col(1).setConstant(1.1);
  const Selection selection = ByteAllocation(model).at(0);
  EXPECT_FALSE(selection[0].blocks[0].empty());
  EXPECT_TRUE(selection[0].blocks[1].empty());
}

// The first component is kept where it has nothing but zeros, the second one where it moves its vertex, by half.
TEST(FrameEnergies, AreOfWhatIsKeptAndOfWhatIsNot) {
  ResidualModel model = small_model();
  RegionModel& region = model.regions[0];
  region.region.weights[20] = 0.5;
  region.components.coefficients(3, 1) = 7;
  region.fits[0].errors(6, 1) = 0;
  const std::vector<double> energies = frame_energies(region, {0, {{1}, {1}}, {}}, region.fits[0]);
  ASSERT_EQ(energies.size(), 10u);
  for (std::size_t n = 0; n < 10; ++n) EXPECT_NEAR(energies[n], 0.25 + 4 + (n == 6 ? 0 : 0.25 / 0.5), 1e-12) << n;
  const std::vector<double> without = frame_energies(region, {1, {{0}, {}}, {}}, region.fits[1]);
  for (std::size_t n = 0; n < 10; ++n) EXPECT_NEAR(without[n], 0.25 + 1.44 + (n == 3 ? 49 : 1) / 0.5, 1e-12) << n;
}

// Two regions that overlap and err against each other or alike: the sum over regions, vertex by vertex.
TEST(ExpectedError, IsThatOfTheSumOfAllRegions) {
  for (const double sign : {1.0, -1.0}) {
    ResidualModel model = small_model();
    model.regions.push_back(model.regions[0]);
    model.regions[1].fits[0].errors *= sign;
    Selection selection = ByteAllocation(model).at(0);
    selection[1].blocks[1].clear();
    const double first = 1 + sign;  // both kept
    const double second = 0.5 - 1;  // one kept; the other one's metre is missing
    const double expected = std::sqrt((first * first + second * second + 2 * 0.25) / kVertices);
    EXPECT_NEAR(expected_error(model, selection), expected, 1e-12) << sign;
  }
}

}  // namespace byte_allocation_test
}  // namespace bodyopt::trainer
