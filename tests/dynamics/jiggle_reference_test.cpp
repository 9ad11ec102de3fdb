// The step of the jiggle on a bar that another solve knows, and its energy.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "base/linear_algebra.h"
#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/host/jiggle.h"
#include "tests/simulate/tet_block.h"
#include "tests/support/fem_reference.h"
#include "tests/support/shared_data.h"
#include "trainer/dynamics/block_inverse.h"
#include "trainer/dynamics/jiggle.h"

namespace bodyopt::trainer {
namespace jiggle_reference_test {

TetMaterial material(double young, double poisson) {
  return {young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))};
}

// A body without bones, some of whose nodes stand still: the others alone are solved for.
class Bar {
 public:
  Bar(const TetMesh& mesh, const std::vector<TetMaterial>& materials, const std::vector<int>& fixed, double density)
      : mesh_(mesh), mass_(lumped_mass(mesh, density)), stiffness_(elastic_stiffness(mesh, materials)) {
    std::vector<bool> is_fixed(static_cast<std::size_t>(mesh.nodes.rows()), false);
    for (const int n : fixed) is_fixed[static_cast<std::size_t>(n)] = true;
    for (int n = 0; n < mesh.nodes.rows(); ++n) {
      if (is_fixed[static_cast<std::size_t>(n)]) continue;
      free_.push_back(n);
      for (int i = 0; i < 3; ++i) unknowns_.push_back(3 * n + i);
    }
    rotations_.resize(static_cast<std::size_t>(9 * mesh.nodes.rows()));
    for (std::size_t k = 0; k < rotations_.size(); k += 9) rotations_[k] = rotations_[k + 4] = rotations_[k + 8] = 1;
    u.assign(static_cast<std::size_t>(3 * mesh.nodes.rows()), 0.0f);
    v = u;
  }

  // damping: alpha (1/s) and beta (s).
  void set_step(JiggleStep step, double alpha = 0, double beta = 0) {
    step.stiffness_damping = static_cast<float>(beta);
    table_ = {};
    table_.step = step;
    const double d = static_cast<double>(step.stage());
    Positions points(static_cast<Eigen::Index>(free_.size()), 3);
    for (std::size_t k = 0; k < free_.size(); ++k) points.row(static_cast<Eigen::Index>(k)) = mesh_.nodes.row(free_[k]);
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<int> place(u.size(), -1);
    for (std::size_t k = 0; k < unknowns_.size(); ++k)
      place[static_cast<std::size_t>(unknowns_[k])] = static_cast<int>(k);
    for (Eigen::Index n = 0; n < mass_.size(); ++n) {
      const double inertia = mass_[n] * (1 / (d * d) + alpha / d);
      table_.nodes.push_back({static_cast<float>(mass_[n]), static_cast<float>(inertia), 0, 0, kNoControl, 0});
      for (Eigen::Index i = 3 * n; i < 3 * n + 3; ++i) {
        const int at = place[static_cast<std::size_t>(i)];
        if (at >= 0) entries.emplace_back(at, at, inertia);
      }
    }
    for (Eigen::Index column = 0; column < stiffness_.cols(); ++column) {
      for (SparseMatrix::InnerIterator entry(stiffness_, column); entry; ++entry) {
        const int row_at = place[static_cast<std::size_t>(entry.row())], at = place[static_cast<std::size_t>(column)];
        if (row_at >= 0 && at >= 0) entries.emplace_back(row_at, at, (1 + beta / d) * entry.value());
      }
    }
    SparseMatrix matrix(static_cast<Eigen::Index>(unknowns_.size()), static_cast<Eigen::Index>(unknowns_.size()));
    matrix.setFromTriplets(entries.begin(), entries.end());
    table_.inverse = invert(matrix, {points, free_, static_cast<int>(mesh_.nodes.rows())}, 3);
  }

  void step(double gravity_y) {
    const std::size_t count = u.size();
    JiggleStepPush frame{};
    frame.node_count = static_cast<std::uint32_t>(mass_.size());
    frame.gravity_y = static_cast<float>(gravity_y);
    const JiggleStages stages = jiggle_stages(table_.step, frame);
    std::vector<float> own_u(count), own_v(count), next_u(count), next_v(count), right(count), z(count), scratch;
    cpu::jiggle_begin(table_, stages.begin, rotations_, {}, {}, u, v, own_u, own_v, right);
    cpu::block_solve(table_.inverse, right, 1, 1, scratch, z);
    if (stages.advance) {
      cpu::jiggle_advance(table_, *stages.advance, rotations_, z, own_u, own_v, next_u, next_v, right);
      own_u.swap(next_u);
      cpu::block_solve(table_.inverse, right, 1, 1, scratch, z);
    }
    cpu::jiggle_end(stages.end, rotations_, z, own_u, u, v);
  }

  // Turns every node by itself: strain is then that of R^T u.
  void turn_nodes(std::mt19937& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    for (std::size_t n = 0; n < rotations_.size() / 9; ++n) {
      const Vec3 axis{unit(random), unit(random), unit(random) + 2};
      const auto r = rotation_matrix(normalized(axis_angle((1 / std::sqrt(dot(axis, axis))) * axis, 2 * unit(random))));
      for (std::size_t i = 0; i < 9; ++i) rotations_[9 * n + i] = static_cast<float>(r[i / 3][i % 3]);
    }
  }

  // Of motion and strain, joules.
  double energy() const {
    Eigen::VectorXd uu(static_cast<Eigen::Index>(u.size()));
    double moving = 0;
    for (std::size_t k = 0; k < u.size(); ++k) {
      double& own = uu[static_cast<Eigen::Index>(k)] = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        own += static_cast<double>(rotations_[9 * (k / 3) + 3 * i + k % 3]) * static_cast<double>(u[k / 3 * 3 + i]);
      }
      moving += mass_[static_cast<Eigen::Index>(k / 3)] * std::pow(static_cast<double>(v[k]), 2) / 2;
    }
    return moving + uu.dot(stiffness_ * uu) / 2;
  }

  // The lowest modes of the lumped masses: how far each is swung, exactly, under gravity that is switched on at time 0.
  // (Of all modes together the sum is no smooth motion, and no order shows.)
  class Modes {
   public:
    Modes(const Bar& bar, Eigen::Index count) : bar_(bar) {
      const auto n = static_cast<Eigen::Index>(bar.unknowns_.size());
      Eigen::VectorXd root(n), pull = Eigen::VectorXd::Zero(n);
      for (Eigen::Index k = 0; k < n; ++k) {
        const int unknown = bar.unknowns_[static_cast<std::size_t>(k)];
        root[k] = std::sqrt(bar.mass_[unknown / 3]);
        if (unknown % 3 == 1) pull[k] = -9.81 * root[k];
      }
      const Eigen::MatrixXd scaled = root.cwiseInverse().asDiagonal() *
                                     Eigen::MatrixXd(bar.stiffness_)(bar.unknowns_, bar.unknowns_) *
                                     root.cwiseInverse().asDiagonal();
      const SymmetricEigen modes = symmetric_eigen(scaled);
      squared_ = modes.values.head(count);
      measures_ = modes.vectors.leftCols(count).transpose() * root.asDiagonal();
      loads_ = modes.vectors.leftCols(count).transpose() * pull;
    }
    Eigen::VectorXd exact(double seconds) const {
      return loads_.array() / squared_.array() * (1 - (squared_.array().sqrt() * seconds).cos());
    }
    Eigen::VectorXd of(const std::vector<float>& displacement) const {
      Eigen::VectorXd own(measures_.cols());
      for (Eigen::Index k = 0; k < own.size(); ++k) {
        own[k] =
            static_cast<double>(displacement[static_cast<std::size_t>(bar_.unknowns_[static_cast<std::size_t>(k)])]);
      }
      return measures_ * own;
    }

   private:
    const Bar& bar_;
    Eigen::VectorXd squared_, loads_;
    Eigen::MatrixXd measures_;
  };

  std::vector<float> u, v;

 private:
  TetMesh mesh_;
  Eigen::VectorXd mass_;
  SparseMatrix stiffness_;
  std::vector<int> free_, unknowns_;
  std::vector<float> rotations_;
  JiggleTable table_;
};

struct ReferenceBar {
  explicit ReferenceBar(const Tensors& file) : mesh(reference_mesh(file)) {
    for (const std::int32_t n : file.get<std::int32_t>("fixed")) fixed.push_back(n);
  }
  // Young's modulus is the one with which the frequencies of the file come out.
  Bar bar(double young) const {
    return Bar(mesh, std::vector<TetMaterial>(static_cast<std::size_t>(mesh.tets.rows()), material(young, 0.3)), fixed,
               1000);
  }
  TetMesh mesh;
  std::vector<int> fixed;
};

// RMS over the frames of a second of the distance from the exact swing of the modes, over the largest swing.
double step_error(Bar bar, const Bar::Modes& modes, std::uint32_t substeps) {
  bar.set_step({.frames_per_second = 24, .substeps = substeps});
  double sum = 0, largest = 0;
  for (int frame = 1; frame <= 24; ++frame) {
    for (std::uint32_t s = 0; s < substeps; ++s) bar.step(-9.81);
    const Eigen::VectorXd exact = modes.exact(frame / 24.0);
    sum += (modes.of(bar.u) - exact).squaredNorm() / 24;
    largest = std::max(largest, exact.norm());
  }
  return std::sqrt(sum) / largest;
}

TEST(JiggleReference, BarFallsAsItsModesSayToSecondOrder) {
  const auto path = shared_data("reference/fem/bar-651_transient.safetensors");
  if (!path) GTEST_SKIP() << kNeedsReferences;
  const Tensors file(*path);
  const Bar bar = ReferenceBar(file).bar(1e9);
  const Bar::Modes modes(bar, 2);  // of 1.5 and 2 Hz
  const double one = step_error(bar, modes, 1), two = step_error(bar, modes, 2), four = step_error(bar, modes, 4);
  EXPECT_LT(one, 0.02);
  EXPECT_NEAR(one / two, 4, 0.4);
  EXPECT_NEAR(two / four, 4, 0.4);
}

// The file's masses are consistent ones, ours lumped: near, not equal.
TEST(JiggleReference, BarFallsNearlyAsWithConsistentMasses) {
  const auto path = shared_data("reference/fem/bar-651_transient.safetensors");
  if (!path) GTEST_SKIP() << kNeedsReferences;
  const Tensors file(*path);
  Bar bar = ReferenceBar(file).bar(1e9);
  const std::vector<double> expected = file.get<double>("displacement");
  bar.set_step({.frames_per_second = 24, .substeps = 16});
  double largest = 0, worst = 0;
  for (std::size_t frame = 1; frame < 49; ++frame) {
    for (int s = 0; s < 16; ++s) bar.step(-9.81);
    for (std::size_t k = 0; k < bar.u.size(); ++k) {
      const double exact = expected[frame * bar.u.size() + k];
      largest = std::max(largest, std::abs(exact));
      worst = std::max(worst, std::abs(static_cast<double>(bar.u[k]) - exact));
    }
  }
  RecordProperty("difference", std::to_string(worst / largest));
  EXPECT_LT(worst, 0.02 * largest);
}

// Without input it never grows by more than rounding, in stiffness of six decades, whatever the state, also where every
// node is turned by itself.
TEST(JiggleReference, EnergyNeverGrows) {
  const TetMesh mesh = tet_block(1, 1, 3, 0.05);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const bool euler : {false, true}) {
    std::vector<TetMaterial> materials;
    for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t)
      materials.push_back(material(std::pow(10, 5 + 3 * unit(random)), 0.45));
    Bar bar(mesh, materials, {0, 4, 8, 12}, 1000);
    bar.set_step({.implicit_euler = euler}, 0, 0);
    for (int round = 0; round < 100; ++round) {
      if (round % 2 == 1) bar.turn_nodes(random);
      for (std::size_t k = 0; k < bar.u.size(); ++k) {
        const bool is_fixed = k / 3 == 0 || k / 3 == 4 || k / 3 == 8 || k / 3 == 12;
        bar.u[k] = is_fixed ? 0.0f : static_cast<float>(0.01 * unit(random));
        bar.v[k] = is_fixed ? 0.0f : static_cast<float>(unit(random));
      }
      const double start = bar.energy();
      double before = start;
      for (int s = 0; s < 100; ++s) {
        bar.step(0);
        const double after = bar.energy();
        ASSERT_LE(after, before * (1 + 1e-5) + 1e-9 * start) << "round " << round << ", step " << s;
        before = after;
      }
    }
  }
}

}  // namespace jiggle_reference_test
}  // namespace bodyopt::trainer
