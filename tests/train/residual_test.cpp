// Packing of the residual table: what the runtime makes of the entries against the columns they were made from.
#include "trainer/train/pack/residual.h"

#include <gtest/gtest.h>

#include "runtime/core/half.h"
#include "runtime/cpu/kernels.h"
#include "tests/support/random_tables.h"

namespace bodyopt::trainer {
namespace {

constexpr std::uint32_t kVertices = 37, kBlocks = 3;  // of 16, 16 and 5 vertices
constexpr Eigen::Index kColumns = 4;

// Every `stride`th vertex from `first` on. Columns are 1 at their largest, ever smaller along the vertices, and shared
// by all regions of the model; all coefficients have a root mean square of 1.
RegionModel region_model(testing::Random& random, std::uint32_t first, std::uint32_t stride, double fade) {
  RegionModel model;
  for (std::uint32_t v = first; v < kVertices; v += stride) model.region.vertices.push_back(v);
  model.region.weights.assign(model.region.vertices.size(), 1.0);
  model.components.coefficients = Eigen::MatrixXd::Ones(10, kColumns);
  model.components.basis.resize(kColumns, 3 * static_cast<Eigen::Index>(model.region.vertices.size()));
  for (Eigen::Index c = 0; c < model.components.basis.cols(); ++c) {
    for (Eigen::Index k = 0; k < kColumns; ++k) {
      model.components.basis(k, c) = random.uniform(-1, 1) * std::exp(-fade * static_cast<double>(c));
    }
  }
  for (auto column : model.components.basis.rowwise()) column /= column.cwiseAbs().maxCoeff();
  model.fits.resize(1);
  model.fits[0].weights = Eigen::MatrixXd::Zero(0, kColumns);
  return model;
}

ResidualModel residual_model() {
  testing::Random random(5);
  ResidualModel model;
  model.vertices = kVertices;
  model.regions = {region_model(random, 0, 1, 0.05), region_model(random, 3, 2, 0.1)};
  return model;
}

// Every component in every block of its region.
Selection everything(const ResidualModel& model) {
  Selection selection;
  for (const RegionModel& region : model.regions) {
    std::vector<std::uint32_t> blocks;
    for (const std::uint32_t v : region.region.vertices) {
      if (blocks.empty() || blocks.back() != v / kBlockSize) blocks.push_back(v / kBlockSize);
    }
    const auto columns = static_cast<std::size_t>(kColumns);
    selection.push_back({0, std::vector(columns, blocks), std::vector(columns, std::vector<std::uint32_t>{})});
  }
  return selection;
}

// Fitted to noise; some features are far too small and too large for a half.
Regression random_regression(testing::Random& random, Eigen::Index features) {
  const Eigen::Index frames = 40;
  RegressionData data;
  data.features = Eigen::MatrixXd::NullaryExpr(frames, features, [&] { return random.uniform(-3, 3); });
  data.features.row(4) *= 1e-6;
  data.features(9, 1) = 1e5;
  data.rest = Eigen::RowVectorXd::Constant(features, 0.3);
  data.targets = Eigen::MatrixXd::NullaryExpr(frames, kColumns, [&] { return random.uniform(-1, 1); });
  data.folds = blocked_folds(std::vector<int>(static_cast<std::size_t>(frames), 0), 4, 5);
  return fit_regression(data, 30);
}

// 3 V: the basis vectors of a coefficient, as the runtime reads them.
std::vector<float> unpacked_column(const ResidualTable& table, std::uint32_t coefficient) {
  std::vector<float> coefficients(table.coefficient_count()), column(3 * kVertices);
  coefficients[coefficient] = 1;
  cpu::residual_blend(table, coefficients, 1, 1, column);
  return column;
}

// 3 V: column k of a region, before it is packed.
Eigen::VectorXd whole_column(const RegionModel& model, Eigen::Index k) {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(3 * kVertices);
  for (std::size_t v = 0; v < model.region.vertices.size(); ++v) {
    column.segment<3>(3 * model.region.vertices[v]) =
        model.components.basis.row(k).segment<3>(3 * static_cast<Eigen::Index>(v)).transpose();
  }
  return column;
}

int number_at(const BlendEntry& entry, std::uint32_t component, std::uint32_t lane) {
  const std::uint32_t byte = component * kBlockSize + lane;
  return static_cast<std::int8_t>(entry.numbers[byte / 4] >> 8 * (byte % 4));
}

int largest_number(const BlendEntry& entry) {
  int largest = 0;
  for (std::uint32_t k = 0; k < 3 * kBlockSize; ++k) largest = std::max(largest, std::abs(number_at(entry, 0, k)));
  return largest;
}

TEST(PackResidual, NumbersAreWithinHalfAStepOfTheirEntry) {
  const ResidualModel model = residual_model();
  const ResidualTable table = pack_residual(model, everything(model)).table;
  ASSERT_EQ(table.coefficient_count(), 2 * kColumns);
  ASSERT_EQ(table.blend_begin.size(), kBlocks + 1);
  ASSERT_EQ(table.blend.size(), kBlocks * 2 * kColumns);
  for (std::uint32_t block = 0; block < kBlocks; ++block) {
    for (std::uint32_t e = table.blend_begin[block]; e < table.blend_begin[block + 1]; ++e) {
      const std::uint32_t coefficient = table.blend[e].scale_coefficient >> 16;
      EXPECT_EQ(coefficient, e - table.blend_begin[block]);
      const double half_step = 0.5 * double{half_low(table.blend[e].scale_coefficient)} / 128;
      EXPECT_EQ(largest_number(table.blend[e]), 127);
      const std::vector<float> found = unpacked_column(table, coefficient);
      const Eigen::VectorXd expected = whole_column(model.regions[coefficient / kColumns], coefficient % kColumns);
      for (std::uint32_t k = 3 * kBlockSize * block; k < std::min(3 * kBlockSize * (block + 1), 3 * kVertices); ++k) {
        EXPECT_NEAR(found[k], expected[k], half_step * (1 + 1e-12)) << "block " << block << ", entry " << e;
      }
    }
  }
}

TEST(PackResidual, LanesWithoutAVertexHoldZeros) {
  const ResidualModel model = residual_model();
  const ResidualTable table = pack_residual(model, everything(model)).table;
  for (std::uint32_t block = 0; block < kBlocks; ++block) {
    for (std::uint32_t e = table.blend_begin[block]; e < table.blend_begin[block + 1]; ++e) {
      const bool second = (table.blend[e].scale_coefficient >> 16) >= kColumns;
      for (std::uint32_t lane = 0; lane < kBlockSize; ++lane) {
        const std::uint32_t vertex = block * kBlockSize + lane;
        if (vertex < kVertices && !(second && (vertex < 3 || vertex % 2 == 0))) continue;
        for (std::uint32_t i = 0; i < 3; ++i) EXPECT_EQ(number_at(table.blend[e], i, lane), 0);
      }
    }
  }
}

TEST(PackResidual, HoldsWhatIsSelected) {
  const ResidualModel model = residual_model();
  Selection selection = everything(model);
  selection[0].blocks[1].clear();
  selection[0].blocks[2] = {0, 2};
  const ResidualTable table = pack_residual(model, selection).table;
  EXPECT_EQ(table.coefficient_count(), 2 * kColumns - 1);
  EXPECT_EQ(table.blend.size(), kBlocks * (2 * kColumns - 1) - 1);
  const std::vector<float> third = unpacked_column(table, 1);
  const Eigen::VectorXd whole = whole_column(model.regions[0], 2);
  for (std::uint32_t k = 0; k < 3 * kVertices; ++k) {
    EXPECT_NEAR(third[k], k / 3 / kBlockSize == 1 ? 0 : whole[k], 0.005) << k;
  }
  selection[0].blocks.clear();
  const PackedResidual second = pack_residual(model, selection);
  EXPECT_EQ(second.regions, std::vector<std::size_t>{1});
  EXPECT_EQ(second.table.coefficient_count(), kColumns);
}

// A second entry of the same coefficient takes the rounding to 16 bits, where it is selected.
TEST(PackResidual, RoundingMayHaveAnEntryOfItsOwn) {
  const ResidualModel model = residual_model();
  Selection selection = everything(model);
  const ResidualTable coarse = pack_residual(model, selection).table;
  selection[0].fine[1] = {0, 2};
  const ResidualTable table = pack_residual(model, selection).table;
  EXPECT_EQ(table.coefficient_count(), coarse.coefficient_count());
  EXPECT_EQ(table.blend.size(), coarse.blend.size() + 2);
  const std::vector<float> found = unpacked_column(table, 1), rounded = unpacked_column(coarse, 1);
  const Eigen::VectorXd whole = whole_column(model.regions[0], 1);
  std::vector<double> left(kBlocks);
  for (std::uint32_t k = 0; k < 3 * kVertices; ++k) {
    const std::uint32_t block = k / 3 / kBlockSize;
    left[block] += std::pow(rounded[k] - whole[k], 2);
    if (block == 1) {
      EXPECT_EQ(found[k], rounded[k]);
    } else {
      EXPECT_NEAR(found[k], whole[k], 2e-5);
    }
  }
  const std::vector<BlockRounding> rounding = rounding_of(model.regions[0], 1);
  ASSERT_EQ(rounding.size(), kBlocks);
  for (const BlockRounding& r : rounding) {
    EXPECT_GT(left[r.block], 1e-10);
    EXPECT_NEAR(r.left, left[r.block], 1e-3 * left[r.block]);  // floats
  }
}

// Of both an odd and an even number of features, one after the other.
TEST(PackResidual, CentresAreThoseOfTheRegression) {
  ResidualModel model = residual_model();
  testing::Random random(6);
  const std::vector<std::uint32_t> features = {0, 2, 3, 5};
  for (std::size_t r = 0; r < 2; ++r) {
    const auto count = static_cast<Eigen::Index>(3 + r);
    model.regions[r].features.assign(features.begin(), features.begin() + count);
    model.regions[r].projection = Eigen::MatrixXd::Identity(count, count);
    model.regions[r].fits[0] = random_regression(random, count);
  }
  const ResidualTable table = pack_residual(model, everything(model)).table;
  ASSERT_EQ(table.regions.size(), 2u);
  std::size_t words = 0;
  for (std::size_t r = 0; r < 2; ++r) {
    const Eigen::MatrixXd& centres = model.regions[r].fits[0].centres;
    EXPECT_EQ(table.regions[r].centre_values, words);
    ASSERT_EQ(table.regions[r].centre_count, centres.rows());
    for (Eigen::Index m = 0; m < centres.rows(); ++m) {
      for (Eigen::Index k = 0; k < centres.cols(); ++k) {
        const float packed =
            testing::centre_value(table, table.regions[r], static_cast<std::size_t>(m), static_cast<std::size_t>(k));
        EXPECT_EQ(double{packed}, centres(m, k)) << "region " << r << ", centre " << m << ", value " << k;
      }
    }
    words += 2 * static_cast<std::size_t>(centres.rows());
  }
  EXPECT_EQ(table.centres.size(), words);
  for (std::size_t w = 1; w < table.regions[1].centre_values; w += 2) EXPECT_EQ(table.centres[w] >> 16, 0u);
}

// Entries far below the largest of their column: their scale is the smallest that every device reads as it is.
TEST(PackResidual, ScalesAreNeverSubnormal) {
  ResidualModel model = residual_model();
  for (RegionModel& region : model.regions) region.components.basis.rightCols(15) *= 1e-9;
  const ResidualTable table = pack_residual(model, everything(model)).table;
  int smallest = 0;
  for (const BlendEntry& entry : table.blend) {
    EXPECT_GE(half_low(entry.scale_coefficient), 0x1p-14f);
    if (half_low(entry.scale_coefficient) == 0x1p-14f) ++smallest;
  }
  EXPECT_GE(smallest, kColumns);
}

TEST(DropUnusedFibres, KeepsWhatTheOthersAre) {
  // Two joint features, three fibres, a control; no region listens to the second fibre.
  StrainTable strain;
  strain.vertices = {10, 11, 12, 13};
  strain.points = {{0, 1, 2, 1, 0, 0}, {1, 2, 3, 1, 0, 0}, {2, 1, 0, 1, 0, 0},
                   {0, 0, 0, 1, 0, 0}, {3, 2, 1, 1, 0, 0}, {3, 3, 3, 1, 0, 0}};
  strain.fibre_begin = {0, 2, 4, 6};
  strain.rest_length = {0.1f, 0.2f, 0.3f};
  strain.names = {"a/1", "b/1", "c/1"};
  ResidualTable table;
  for (int f = 0; f < 6; ++f) table.features.push_back({0, 1, static_cast<float>(f), 1});
  table.region_features = {0, 2, 5, 4, 5};
  drop_unused_fibres(strain, table, 2);
  EXPECT_EQ(strain.names, (std::vector<std::string>{"a/1", "c/1"}));
  EXPECT_EQ(strain.rest_length, (std::vector<float>{0.1f, 0.3f}));
  EXPECT_EQ(strain.fibre_begin, (std::vector<std::uint32_t>{0, 2, 4}));
  const auto vertex = [&](std::size_t point) { return strain.vertices[strain.points[point].a]; };
  EXPECT_EQ(vertex(0), 10u);
  EXPECT_EQ(vertex(1), 11u);
  EXPECT_EQ(vertex(2), 13u);
  EXPECT_EQ(vertex(3), 13u);
  EXPECT_EQ(table.region_features, (std::vector<std::uint32_t>{0, 2, 4, 3, 4}));
  ASSERT_EQ(table.features.size(), 5u);
  for (std::size_t f = 0; f < 5; ++f) EXPECT_EQ(table.features[f].mean, static_cast<float>(f < 3 ? f : f + 1));
}

}  // namespace
}  // namespace bodyopt::trainer
