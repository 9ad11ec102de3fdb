#include "trainer/simulate/tissue.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "base/linear_algebra.h"
#include "runtime/core/json.h"
#include "tests/simulate/limb.h"
#include "tests/simulate/tet_block.h"
#include "tests/support/read_bytes.h"
#include "tests/support/shared_data.h"
#include "trainer/simulate/lbfgs.h"
#include "trainer/tets/second_order.h"

namespace bodyopt::trainer {
namespace {

std::vector<TetMaterial> all(const TetMesh& mesh, const TetMaterial& material) {
  return std::vector<TetMaterial>(static_cast<std::size_t>(mesh.tets.rows()), material);
}

std::vector<FibreTet> fibres_everywhere(const TetMesh& mesh, const Eigen::Vector3d& direction) {
  std::vector<FibreTet> fibres;
  for (int t = 0; t < mesh.tets.rows(); ++t) fibres.push_back({t, 0, direction.normalized()});
  return fibres;
}

Positions shaken(const Positions& nodes, double amplitude, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-amplitude, amplitude);
  return nodes.unaryExpr([&](double x) { return x + uniform(random); });
}

Positions mapped(const Positions& nodes, const Eigen::Matrix3d& linear, const Eigen::RowVector3d& shift) {
  return (nodes * linear.transpose()).rowwise() + shift;
}

// Central differences along random directions.
void expect_gradient(const Tissue& tissue, const Positions& nodes, const std::vector<FibreDrive>& drives,
                     const Tissue::BarrierShape& shape = Tissue::kBarrier) {
  Positions gradient = Positions::Zero(nodes.rows(), 3), unused = gradient;
  ASSERT_TRUE(std::isfinite(tissue.add_gradient(nodes, drives, gradient, shape).energy));
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Positions direction = shaken(Positions::Zero(nodes.rows(), 3), 1, seed);
    const double step = 1e-7;
    const double up = tissue.add_gradient(nodes + step * direction, drives, unused, shape).energy;
    const double down = tissue.add_gradient(nodes - step * direction, drives, unused, shape).energy;
    const double expected = (up - down) / (2 * step);
    EXPECT_NEAR(gradient.cwiseProduct(direction).sum(), expected, 1e-5 * gradient.norm() * direction.norm());
  }
}

TEST(Tissue, PassiveGradientIsTheEnergysDerivative) {
  const TetMesh mesh = tet_block(3, 2, 2, 0.01);
  expect_gradient(Tissue(mesh, all(mesh, Materials{}.fat), {}), shaken(mesh.nodes, 0.001, 7), {});
}

TEST(Tissue, BarrierGradientIsTheEnergysDerivative) {
  const TetMesh mesh = tet_block(3, 2, 2, 0.01);
  const Positions squashed = mapped(mesh.nodes, Eigen::Vector3d(0.25, 1, 0.9).asDiagonal(), {0, 0, 0});
  expect_gradient(Tissue(mesh, all(mesh, Materials{}.fat), {}), shaken(squashed, 0.0001, 8), {});
}

TEST(Tissue, FibreGradientsAreTheEnergysDerivative) {
  const TetMesh mesh = tet_block(3, 2, 2, 0.01);
  std::vector<FibreTet> fibres = fibres_everywhere(mesh, {1, 0.3, -0.2});
  for (const int t : {0, 7, 7, 11}) fibres.push_back({t, 0, Eigen::Vector3d(0.2, -1, 0.4).normalized(), 0.5});
  const Tissue tissue(mesh, all(mesh, Materials{}.muscle), fibres);
  expect_gradient(tissue, shaken(mesh.nodes, 0.0005, 9), {{0.7, 0.7}});       // active alone, near rest
  expect_gradient(tissue, shaken(1.2 * mesh.nodes, 0.0005, 10), {{0, 0.7}});  // passive alone, stretched
  expect_gradient(tissue, shaken(1.2 * mesh.nodes, 0.0005, 11), {{1, 0.7}});  // both
  const Eigen::Vector3d shorter(0.65, 1.2, 1.2);
  expect_gradient(tissue, shaken(mapped(mesh.nodes, shorter.asDiagonal(), {0, 0, 0}), 0.0003, 12), {{1, 0.7}});
}

// Against a plain evaluation, tet by tet, of the energy in the header.
TEST(Tissue, EnergyIsTheDocumentedOne) {
  const TetMesh mesh = tet_block(2, 2, 2, 0.01);
  const Eigen::Vector3d fibre = Eigen::Vector3d(0.2, 1, 0.4).normalized();
  std::vector<FibreTet> fibres = fibres_everywhere(mesh, fibre);
  fibres.resize(13);                                                          // the rest is passive
  const Eigen::Vector3d second = Eigen::Vector3d(1, -0.3, 0.1).normalized();  // of another muscle in two of them
  for (const int t : {4, 9}) fibres.push_back({t, 1, second, 0.25});
  std::vector<TetMaterial> materials = all(mesh, Materials{}.fat);
  for (const FibreTet& of_muscle : fibres) materials[static_cast<std::size_t>(of_muscle.tet)] = Materials{}.muscle;
  const Positions nodes = shaken(mapped(mesh.nodes, Eigen::Vector3d(0.3, 1.1, 0.9).asDiagonal(), {1, 2, 3}), 0.0002, 3);
  TetMesh posed = mesh;
  posed.nodes = nodes;
  double mean_volume = 0;
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    mean_volume += tet_edges(mesh, t).determinant() / 6 / static_cast<double>(mesh.tets.rows());
  }
  for (const Tissue::BarrierShape& shape : {Tissue::kBarrier, Tissue::BarrierShape{0.002, 3}}) {
    double expected = 0;
    for (int t = 0; t < mesh.tets.rows(); ++t) {
      const Eigen::Matrix3d f = tet_edges(posed, t) * tet_edges(mesh, t).inverse();
      const double j = f.determinant(), volume = tet_edges(mesh, t).determinant() / 6;
      const auto& [mu, lambda] = materials[static_cast<std::size_t>(t)];
      double density =
          mu / 2 * (f.squaredNorm() - 3) + lambda / 2 * (std::pow(j - 1 - mu / lambda, 2) - std::pow(mu / lambda, 2));
      const double firm = std::max(1.0, shape.least_volume * mean_volume / volume);
      if (j < 0.3) density -= 2 * firm * lambda * std::pow(j - 0.3, 2) * std::log(j / 0.3);
      if (t < 13) {
        const double s = (f * fibre).norm();
        density += 0.6 * Materials{}.active_fibre / 2 * std::pow(std::max(s - 0.7, 0.0), 2) +
                   Materials{}.passive_fibre / 2 * std::pow(std::max(s - 1, 0.0), 2);
      }
      if (t == 4 || t == 9) {
        const double s = (f * second).norm();
        density += 0.25 * (0.9 * Materials{}.active_fibre / 2 * std::pow(std::max(s - 0.85, 0.0), 2) +
                           Materials{}.passive_fibre / 2 * std::pow(std::max(s - 1, 0.0), 2));
      }
      expected += volume * density;
    }
    Positions gradient = Positions::Zero(nodes.rows(), 3);
    const Tissue tissue(mesh, materials, fibres);
    const double found =
        tissue.add_gradient(nodes, std::vector<FibreDrive>{{0.6, 0.7}, {0.9, 0.85}}, gradient, shape).energy;
    EXPECT_NEAR(found, expected, 1e-10 * std::abs(expected));
  }
}

TEST(Tissue, RigidMotionMakesNoForce) {
  const TetMesh mesh = tet_block(3, 3, 3, 0.01);
  const Tissue tissue(mesh, all(mesh, Materials{}.muscle), fibres_everywhere(mesh, {0, 1, 1}));
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Positions gradient = Positions::Zero(mesh.nodes.rows(), 3);
  const TissueSum sum =
      tissue.add_gradient(mapped(mesh.nodes, turn, {5, -3, 1}), std::vector<FibreDrive>{{0, 1}}, gradient);
  EXPECT_NEAR(sum.energy, 0, 1e-12);
  EXPECT_LT(gradient.cwiseAbs().maxCoeff(), 1e-9);  // newtons; a strain of one percent makes 1e-2
}

// A homogeneous deformation is in balance inside; on the boundary its tractions sum to zero.
TEST(Tissue, PassesThePatchTest) {
  const TetMesh mesh = tet_block(4, 4, 4, 0.01);
  TetMesh skewed = mesh;
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) {
    const Eigen::RowVector3d p = mesh.nodes.row(n);
    if (p.minCoeff() > 0.001 && p.maxCoeff() < 0.039)
      skewed.nodes.row(n) += shaken(p, 0.001, static_cast<unsigned>(n)) - p;
  }
  Eigen::Matrix3d strain;
  strain << 1.1, 0.1, 0, -0.05, 0.9, 0.07, 0.02, 0, 1.05;
  const Tissue tissue(skewed, all(skewed, Materials{}.fat), {});
  Positions gradient = Positions::Zero(mesh.nodes.rows(), 3);
  tissue.add_gradient(mapped(skewed.nodes, strain, {0, 0, 0}), {}, gradient);
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) {
    const Eigen::RowVector3d p = mesh.nodes.row(n);
    if (p.minCoeff() > 0.001 && p.maxCoeff() < 0.039) {
      EXPECT_LT(gradient.row(n).norm(), 1e-12);
    }
  }
  EXPECT_LT(gradient.colwise().sum().norm(), 1e-12);
  EXPECT_GT(gradient.norm(), 1e-3);
}

TEST(Tissue, ForceScaleIsTheSumOverTetsAlone) {
  const TetMesh mesh = tet_block(2, 1, 1, 0.01);
  const Positions nodes = shaken(mesh.nodes, 0.001, 4);
  double expected = 0;
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    TetMesh one;
    one.nodes = mesh.nodes;
    one.tets = mesh.tets.row(t);
    Positions gradient = Positions::Zero(nodes.rows(), 3);
    Tissue(one, {Materials{}.fat}, {}).add_gradient(nodes, {}, gradient);
    expected += gradient.squaredNorm();
  }
  Positions gradient = Positions::Zero(nodes.rows(), 3);
  const double found = Tissue(mesh, all(mesh, Materials{}.fat), {}).add_gradient(nodes, {}, gradient).force_square;
  EXPECT_NEAR(found, expected, 1e-12 * expected);
}

// Below the barrier's steepest point, through flat, to inside out.
TEST(Tissue, InvertedGradientIsTheEnergysDerivative) {
  const TetMesh mesh = tet_block(3, 2, 2, 0.01);
  const Tissue tissue(mesh, all(mesh, Materials{}.fat), {});
  for (const double height : {0.06, 0.02, 0.003, -0.01, -0.5}) {
    const Positions squashed = mapped(mesh.nodes, Eigen::Vector3d(height, 1, 0.9).asDiagonal(), {0, 0, 0});
    for (const Tissue::BarrierShape& shape :
         {Tissue::kBarrier, Tissue::kSteepBarrier, Tissue::BarrierShape{0.002, 50}}) {
      expect_gradient(tissue, shaken(squashed, 0.00001, 8), {}, shape);
    }
  }
}

// An inverted tet has more energy than any that is upright, and is pushed back.
TEST(Tissue, InvertedTetsRecoverAndAreCounted) {
  const TetMesh mesh = tet_block(2, 2, 2, 0.01);
  const Tissue tissue(mesh, all(mesh, Materials{}.fat), {});
  Positions gradient = Positions::Zero(mesh.nodes.rows(), 3);
  const Positions mirrored = mapped(mesh.nodes, Eigen::Vector3d(-1, 1, 1).asDiagonal(), {0, 0, 0});
  double last = std::numeric_limits<double>::infinity();
  for (double height = -1; height <= 1; height += 0.01) {
    const Positions stretched = mapped(mesh.nodes, Eigen::Vector3d(height, 1, 1).asDiagonal(), {0, 0, 0});
    const double energy = tissue.add_gradient(stretched, {}, gradient).energy;
    EXPECT_LT(energy, last) << height;
    last = energy;
  }
  EXPECT_EQ(tissue.inverted(mirrored).tets, mesh.tets.rows());
  EXPECT_EQ(tissue.inverted(mesh.nodes).tets, 0);
  EXPECT_NEAR(tissue.inverted(mirrored).share, 1, 1e-12);
  const Positions flat = mapped(mesh.nodes, Eigen::Vector3d(0, 1, 1).asDiagonal(), {0, 0, 0});
  EXPECT_EQ(tissue.inverted(flat).tets, mesh.tets.rows());
}

// Inside out, a tiny tet is pushed back by the firm barrier at least as hard as one just large enough to do without; by
// the others next to not at all. Larger tets do not feel it.
TEST(Tissue, TheFirmBarrierHoldsUpTinyTets) {
  constexpr double kLarge = 0.03, kTiny = 1e-6, kLeast = Tissue::kFirmBarrier.least_volume;  // metres; of the large tet
  // Three apart: large, just not tiny, and tiny.
  const double least = 1.001 * kLeast * (1 + kTiny) / (3 - kLeast);
  const double sizes[3] = {kLarge, kLarge * std::cbrt(least), kLarge * std::cbrt(kTiny)};
  TetMesh mesh;
  mesh.nodes = Positions::Zero(12, 3);
  mesh.tets.resize(3, 4);
  for (int t = 0; t < 3; ++t) {
    mesh.nodes.middleRows(4 * t + 1, 3) = sizes[t] * Eigen::Matrix3d::Identity();
    mesh.tets.row(t) << 4 * t, 4 * t + 1, 4 * t + 2, 4 * t + 3;
  }
  const Tissue tissue(mesh, all(mesh, Materials{}.fat), {});
  const Positions nodes = mapped(mesh.nodes, Eigen::Vector3d(-0.1, 0.9, 1.1).asDiagonal(), {0, 0, 0});
  const auto push = [&](const Tissue::BarrierShape& shape) {
    Positions gradient = Positions::Zero(12, 3);
    tissue.add_gradient(nodes, {}, gradient, shape);
    return Eigen::Vector3d(-gradient(1, 0), -gradient(5, 0), -gradient(9, 0));  // towards upright, newtons
  };
  const Eigen::Vector3d firm = push(Tissue::kFirmBarrier), steep = push(Tissue::kSteepBarrier);
  EXPECT_GT(firm[1], 0);
  EXPECT_GE(firm[2], firm[1]);
  EXPECT_LT(steep[2], 0.03 * firm[1]);
  EXPECT_EQ(firm.head<2>(), steep.head<2>());
  expect_gradient(tissue, nodes, {}, Tissue::kFirmBarrier);
}

// Linear elasticity is its small-strain limit: an independent solver's displacement balances the loads. The energy's
// Lamé parameters at rest are mu and lambda - mu.
TEST(Tissue, AgreesWithAnIndependentLinearSolution) {
  const auto path = shared_data("reference/fem/bar-651_static.safetensors");
  if (!path) GTEST_SKIP() << kNeedsReferences;
  const std::string bytes = testing::read_bytes(*path);
  std::uint64_t header_size = 0;
  std::memcpy(&header_size, bytes.data(), 8);
  const auto header = Json::parse(bytes.substr(8, header_size));
  const auto data = [&](const std::string& name) {
    return bytes.data() + 8 + header_size + header[name]["data_offsets"][0].get<std::size_t>();
  };
  const auto number = [&](const std::string& key) { return std::stod(header["__metadata__"][key].get<std::string>()); };
  const auto rows = [&](const std::string& name) { return header[name]["shape"][0].get<Eigen::Index>(); };

  TetMesh mesh;
  mesh.nodes.resize(rows("vertices"), 3);
  std::memcpy(mesh.nodes.data(), data("vertices"), sizeof(double) * static_cast<std::size_t>(mesh.nodes.size()));
  mesh.tets.resize(rows("tets"), 4);
  std::memcpy(mesh.tets.data(), data("tets"), sizeof(int) * static_cast<std::size_t>(mesh.tets.size()));
  Positions displacement(mesh.nodes.rows(), 3);
  std::memcpy(displacement.data(), data("displacement_p1"),
              sizeof(double) * static_cast<std::size_t>(displacement.size()));

  const double young = number("E_pa"), poisson = number("nu");
  const double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  Positions load = Positions::Zero(mesh.nodes.rows(), 3);
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    if (tet_edges(mesh, t).determinant() < 0) std::swap(mesh.tets(t, 2), mesh.tets(t, 3));
    const double weight = number("rho") * 9.81 * tet_edges(mesh, t).determinant() / 6;
    for (int a = 0; a < 4; ++a) load(mesh.tets(t, a), 1) -= weight / 4;
  }
  for (Eigen::Index k = 0; k < rows("load_newton"); ++k) {
    int node_axis[2];
    double newton = 0;
    std::memcpy(node_axis, data("load_node_axis") + 8 * k, 8);
    std::memcpy(&newton, data("load_newton") + 8 * k, 8);
    load(node_axis[0], node_axis[1]) += newton;
  }
  std::set<int> fixed;
  for (Eigen::Index k = 0; k < rows("fixed"); ++k) {
    int node = 0;
    std::memcpy(&node, data("fixed") + 4 * k, 4);
    fixed.insert(node);
  }

  // The stiffness at rest, column by column, by central differences of the forces.
  const Tissue tissue(mesh, all(mesh, {mu, lambda + mu}), {});
  constexpr double kStep = 1e-6;
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<int> unknown(static_cast<std::size_t>(mesh.nodes.size()), -1);
  int unknowns = 0;
  for (Eigen::Index k = 0; k < mesh.nodes.size(); ++k) {
    if (!fixed.contains(static_cast<int>(k / 3))) unknown[static_cast<std::size_t>(k)] = unknowns++;
  }
  Eigen::VectorXd right(unknowns), expected(unknowns);
  for (Eigen::Index k = 0; k < mesh.nodes.size(); ++k) {
    const int column = unknown[static_cast<std::size_t>(k)];
    if (column < 0) continue;
    Positions moved = mesh.nodes, up = Positions::Zero(mesh.nodes.rows(), 3), down = up;
    moved.data()[k] += kStep;
    tissue.add_gradient(moved, {}, up);
    moved.data()[k] -= 2 * kStep;
    tissue.add_gradient(moved, {}, down);
    for (Eigen::Index i = 0; i < mesh.nodes.size(); ++i) {
      const double value = (up.data()[i] - down.data()[i]) / (2 * kStep);
      if (unknown[static_cast<std::size_t>(i)] >= 0 && std::abs(value) > 0) {
        entries.emplace_back(unknown[static_cast<std::size_t>(i)], column, value);
      }
    }
    right[column] = load.data()[k];
    expected[column] = displacement.data()[k];
  }
  SparseMatrix stiffness(unknowns, unknowns);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd found = SparseSolver(stiffness).solve(right);
  EXPECT_LT((found - expected).norm(), 1e-5 * expected.norm());
}

// A cantilever with a load at its end that bends it far: the elastica's end moves down by 0.30172 and back by 0.05643
// of its length where load x length^2 = bending stiffness (Mattiasson 1981, by elliptic integrals).
TEST(Tissue, ALargelyBentBeamIsTheElastica) {
  constexpr int kLayers = 14, kLong = 140;
  constexpr double kCell = 1.0 / kLong, kHeight = kLayers * kCell, kLength = kLong * kCell, kMu = 1e5;
  const TetMesh mesh = tet_block(kLong, kLayers, 1, kCell);
  const Tissue tissue(mesh, all(mesh, {kMu, kMu}), {});  // at rest: Young 2 mu, Poisson 0
  const double load = 2 * kMu * kCell * std::pow(kHeight, 3) / 12 / (kLength * kLength);
  std::vector<Eigen::Index> held, end;
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) {
    if (mesh.nodes(n, 0) < kCell / 2) held.push_back(n);
    if (mesh.nodes(n, 0) > kLength - kCell / 2) end.push_back(n);
  }
  SparseMatrix metric = tet_laplacian(mesh, std::vector<double>(static_cast<std::size_t>(mesh.tets.rows()), 2 * kMu));
  for (const Eigen::Index n : held) metric.coeffRef(n, n) += 1e9;
  const Objective objective = [&](const Positions& x, Positions& gradient) {
    gradient.setZero();
    TissueSum sum = tissue.add_gradient(x, {}, gradient);
    for (const Eigen::Index n : held) gradient.row(n).setZero();
    gradient.col(2)
        .setZero();  // so narrow a beam would buckle sideways; without Poisson's effect it does not feel this
    for (const Eigen::Index n : end) {
      gradient(n, 1) += load / static_cast<double>(end.size());
      sum.energy += load / static_cast<double>(end.size()) * x(n, 1);
    }
    return ObjectiveValue{sum.energy, sum.force_square};
  };
  Positions nodes = mesh.nodes;
  const Metric factor(metric);
  const StiffModes plain(factor, nodes.rows(), {}, {});
  EXPECT_LT(Lbfgs(plain, 1e-9).minimise(objective, 1e-5, 20000, nodes).residual, 1e-5);
  Eigen::RowVector3d moved = Eigen::RowVector3d::Zero();
  for (const Eigen::Index n : end) moved += (nodes.row(n) - mesh.nodes.row(n)) / static_cast<double>(end.size());
  RecordProperty("down", std::to_string(-moved[1] / kLength));
  RecordProperty("back", std::to_string(-moved[0] / kLength));
  EXPECT_NEAR(-moved[1] / kLength, 0.30172, 0.02 * 0.30172);
  EXPECT_NEAR(-moved[0] / kLength, 0.05643, 0.02 * 0.05643);
}

// Values of the ten shape functions of a tet of second order and their gradients, from the textbook (Zienkiewicz and
// Taylor): corners w_a (2 w_a - 1), middles 4 w_a w_b.
Eigen::Matrix3d textbook_strain(const TetMesh& eighths, Eigen::Index tet, const Positions& nodes,
                                const Eigen::Vector4d& w) {
  const auto row = [&](int a, int b) { return eighths.tets(8 * tet + a, b); };
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) edges.col(a) = eighths.nodes.row(row(a + 1, a + 1)) - eighths.nodes.row(row(0, 0));
  Eigen::Matrix<double, 4, 3> slopes;
  slopes.bottomRows<3>() = edges.inverse();
  slopes.row(0) = -slopes.bottomRows<3>().colwise().sum();
  Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
  for (int a = 0; a < 4; ++a) {
    strain += nodes.row(row(a, a)).transpose() * ((4 * w[a] - 1) * slopes.row(a));
    for (int b = a + 1; b < 4; ++b) {
      strain += nodes.row(row(a, b)).transpose() * (4 * (w[a] * slopes.row(b) + w[b] * slopes.row(a)));
    }
  }
  return strain;
}

TEST(TissueOfSecondOrder, EnergyIsThatOfTheTextbooksElement) {
  const TetMesh linear = tet_block(2, 2, 1, 0.02), mesh = second_order(linear);
  const Positions nodes = shaken(mesh.nodes, 0.0005, 5);
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 2, 2) / 3;
  const Materials materials;
  const FibreDrive drive{0.5, 0.7};
  Positions gradient = Positions::Zero(mesh.nodes.rows(), 3);
  const double found = Tissue(mesh, all(mesh, materials.fat), fibres_everywhere(mesh, direction))
                           .add_gradient(nodes, std::vector{drive}, gradient)
                           .energy;
  double expected = 0;
  for (Eigen::Index t = 0; t < linear.tets.rows(); ++t) {
    const double volume = tet_edges(linear, t).determinant() / 6;
    for (int q = 0; q < 4; ++q) {
      Eigen::Vector4d w = Eigen::Vector4d::Constant(0.1381966011250105);  // Keast 1986, degree 2
      w[q] = 0.5854101966249685;
      const Eigen::Matrix3d f = textbook_strain(mesh, t, nodes, w);
      const double mu = materials.fat.mu, lambda = materials.fat.lambda, beyond = f.determinant() - 1 - mu / lambda;
      double density = mu / 2 * (f.squaredNorm() - 3) + lambda / 2 * (beyond * beyond - mu / lambda * mu / lambda);
      const double stretch = (f * direction).norm();
      density += 0.5 * drive.activation * materials.active_fibre * std::pow(std::max(stretch - drive.slack, 0.0), 2);
      density += 0.5 * materials.passive_fibre * std::pow(std::max(stretch - 1, 0.0), 2);
      expected += volume / 4 * density;
    }
  }
  EXPECT_NEAR(found, expected, 1e-9 * expected);
}

TEST(TissueOfSecondOrder, GradientsAreTheEnergysDerivative) {
  const TetMesh mesh = second_order(tet_block(2, 2, 1, 0.02));
  const Tissue tissue(mesh, all(mesh, Materials{}.fat), fibres_everywhere(mesh, {1, 2, 2}));
  expect_gradient(tissue, shaken(mesh.nodes, 0.001, 7), {{0.5, 0.7}});
  const Positions squashed = mapped(mesh.nodes, Eigen::Vector3d(0.25, 1, 0.9).asDiagonal(), {0, 0, 0});
  expect_gradient(tissue, shaken(squashed, 0.0001, 8), {{0.5, 0.7}});
}

// Which linear tets cannot: each material belongs to its own quarter of a tet, and a field that is not linear is held.
TEST(TissueOfSecondOrder, MaterialsAreSharedByVolume) {
  const TetMesh mesh = second_order(tet_block(1, 1, 1, 0.02));
  std::vector<TetMaterial> soft = all(mesh, {1e3, 1e4}), mixed = soft;
  for (std::size_t t = 0; t < mixed.size(); t += 2) mixed[t] = {3e3, 3e4};
  const Positions stretched = mapped(mesh.nodes, Eigen::Vector3d(1.1, 1, 1).asDiagonal(), {0, 0, 0});
  Positions gradient = Positions::Zero(mesh.nodes.rows(), 3);
  const double of_soft = Tissue(mesh, soft, {}).add_gradient(stretched, {}, gradient).energy;
  const double of_mixed = Tissue(mesh, mixed, {}).add_gradient(stretched, {}, gradient).energy;
  EXPECT_NEAR(of_mixed, 2 * of_soft, 1e-9 * of_soft);  // half of the volume is three times as stiff
}

}  // namespace
}  // namespace bodyopt::trainer
