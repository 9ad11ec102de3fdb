#include "trainer/dynamics/jiggle.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "base/linear_algebra.h"
#include "geometry/mesh.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "tests/simulate/limb.h"

namespace bodyopt::trainer {
namespace {

// The limb's tets, and what is made of them with some settings.
struct LimbJiggle {
  explicit LimbJiggle(const JiggleSettings& given = {}, const std::vector<RegionWeights>& painted = {})
      : settings(given),
        tets(make_dynamics_tets(limb.vertices, limb.triangles, limb.weights, 25000)),
        anatomy(find_anatomy(limb, AnatomyField(limb, muscles, kLimbAnatomy), muscles.size(), tets.cage, {})),
        fields(spread_settings(settings, limb, muscles, painted, tets, anatomy)),
        system(make_jiggle_system(settings, fields, limb.skeleton, mesh, anatomy, {}, notes)) {}

  Character limb = make_limb();
  std::vector<Muscle> muscles = {make_flexor()};
  JiggleSettings settings;
  DynamicsTets tets;
  const TetMesh& mesh = tets.cage.mesh;
  JiggleAnatomy anatomy;
  JiggleFields fields;
  std::vector<std::string> notes;
  JiggleSystem system;
};

// A giant's tissue is as many times squared stiffer as he is larger: he swings as a person does.
TEST(Jiggle, BodiesOfAnySizeSwingAlike) {
  const LimbJiggle person;
  TetMesh giant = person.mesh;
  const double extent = longest_extent(giant.nodes);
  giant.nodes *= 9 / extent;
  std::vector<std::string> notes;
  const JiggleSystem system =
      make_jiggle_system({}, person.fields, person.limb.skeleton, giant, person.anatomy, {}, notes);
  EXPECT_NEAR(system.materials[0].mu, 25 * person.system.materials[0].mu, 1e-6 * system.materials[0].mu);
}

// Half of what is thin is held, however small the body's flesh is elsewhere.
TEST(Jiggle, ThinTissueHasItsOwnFleshAndLimit) {
  JiggleSettings flesh;
  flesh.flesh = 0.02;
  const LimbJiggle given(flesh), open;
  EXPECT_NEAR(given.fields.flesh.maxCoeff(), 0.02, 1e-12);
  EXPECT_NEAR(given.fields.flesh.minCoeff(), 0.02, 1e-12);
  const JiggleSettings chosen = chosen_settings(open.settings, open.fields, open.limb, open.anatomy);
  EXPECT_EQ(chosen.flesh, 0);
  EXPECT_LE(open.fields.flesh.maxCoeff(), kFleshOfSize * longest_extent(open.limb.vertices) * (1 + 1e-12));
  for (std::size_t v = 0; v < open.fields.skin_limit.size(); ++v) {
    EXPECT_GT(open.fields.skin_limit[v], 0);
    EXPECT_LT(open.fields.skin_limit[v], 0.06);  // the limb is 10 cm thick
  }
}

// A limb whose last tenth follows a joint of its own, as a hand.
Character limb_with_hand() {
  Character limb = make_limb();
  Joint hand = limb.skeleton.joints[1];
  const double wrist = 0.9 * kTubeLength;
  hand.name = "hand";
  hand.parent = 1;
  hand.bind.translation = {wrist - kTubeLength / 2, 0, 0};
  hand.inverse_bind.m[0][3] = -wrist;
  hand.default_local = hand.bind;
  limb.skeleton.joints.push_back(hand);
  for (Eigen::Index v = 0; v < limb.vertices.rows(); ++v) {
    if (limb.vertices(v, 0) > wrist) limb.weights[static_cast<std::size_t>(v)] = {{2, 1.0f}};
  }
  return limb;
}

// Half of a limb that no joint comes after is flesh still; a hand at its end is skin over bone, unless somebody says
// otherwise.
TEST(Jiggle, WhereALimbEndsSkinLiesOnBone) {
  const Character limb = limb_with_hand();
  const DynamicsTets tets = make_dynamics_tets(limb.vertices, limb.triangles, limb.weights, 25000);
  const JiggleAnatomy anatomy = find_anatomy(limb, AnatomyField(limb, {}, kLimbAnatomy), 0, tets.cage, {});
  EXPECT_EQ(anatomy.is_end, (std::vector<bool>{false, false, true}));
  EXPECT_EQ(LimbJiggle().anatomy.is_end, (std::vector<bool>{false, false}));

  const JiggleFields open = spread_settings({}, limb, {}, {}, tets, anatomy);
  const auto mean = [&](int joint) {
    const Eigen::VectorXd share = anatomy.joint_share.col(joint);
    return share.dot(open.flesh) / share.sum();
  };
  EXPECT_LT(mean(2), 0.3 * mean(0));
  const JiggleSettings chosen = chosen_settings({}, open, limb, anatomy);
  ASSERT_FALSE(chosen.regions.empty());
  EXPECT_EQ(chosen.regions.back().name, "hand");
  EXPECT_NE(chosen.regions.back().comment.find("a limb ends there"), std::string::npos);

  EXPECT_EQ(spread_settings(chosen, limb, {}, {}, tets, anatomy).flesh, open.flesh);  // to the bit
  EXPECT_EQ(jiggle_json(chosen_settings(chosen, open, limb, anatomy)), jiggle_json(chosen));
  JiggleSettings doubled = chosen;
  doubled.regions.back().flesh_factor = 2;
  const Eigen::VectorXd share = anatomy.joint_share.col(2).cwiseMax(0).cwiseMin(1);
  const Eigen::VectorXd twice = open.flesh.array() * (std::log(2.0) * share.array()).exp();
  EXPECT_NEAR((spread_settings(doubled, limb, {}, {}, tets, anatomy).flesh - twice).cwiseAbs().maxCoeff(), 0, 1e-12);

  JiggleSettings given;
  given.flesh = 0.02;
  EXPECT_NEAR(spread_settings(given, limb, {}, {}, tets, anatomy).flesh.minCoeff(), 0.02, 1e-12);
}

// `values` on x, y and z.
SparseMatrix on_axes(const SparseMatrix& values) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < values.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(values, column); entry; ++entry) {
      for (int i = 0; i < 3; ++i) {
        entries.emplace_back(3 * static_cast<int>(entry.row()) + i, 3 * column + i, entry.value());
      }
    }
  }
  SparseMatrix matrix(3 * values.rows(), 3 * values.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// M / d^2 + (alpha M + beta S) / d + S of the textbook, S all stiffness.
SparseMatrix textbook_system(const TetMesh& mesh, const JiggleSystem& system, double d) {
  const SparseMatrix stiffness = elastic_stiffness(mesh, system.materials) + on_axes(system.springs);
  const Eigen::VectorXd damped = system.mass.cwiseProduct(system.mass_damping);
  const SparseMatrix mass(system.mass.asDiagonal()), damping(damped.asDiagonal());
  return on_axes(mass) / (d * d) + on_axes(damping) / d + (system.stiffness_damping / d) * stiffness + stiffness;
}

double solve_error(const SparseMatrix& matrix, const BlockInverse& inverse) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<float> right(static_cast<std::size_t>(matrix.rows())), solution(right.size()), scratch;
  for (float& value : right) value = unit(random);
  cpu::block_solve(inverse, right, 1, 1, scratch, solution);
  const auto as_double = [](const std::vector<float>& values) {
    return Eigen::Map<const Eigen::VectorXf>(values.data(), static_cast<Eigen::Index>(values.size()))
        .cast<double>()
        .eval();
  };
  const SparseSolver factor(matrix);
  const Eigen::VectorXd expected = factor.solve(as_double(right));
  return (as_double(solution) - expected).norm() / expected.norm();
}

TEST(Jiggle, InverseSolvesTheTextbooksSystem) {
  const LimbJiggle limb;
  for (const bool euler : {false, true}) {
    const JiggleStep step{.frames_per_second = 30, .substeps = 2, .implicit_euler = euler};
    const JiggleTable table = make_jiggle_table(limb.mesh, limb.system, step);
    const double h = 1.0 / 60, d = euler ? h : h * (1 - std::numbers::sqrt2 / 2);
    EXPECT_LT(solve_error(textbook_system(limb.mesh, limb.system, d), table.inverse), 1e-5);
  }
}

TEST(Jiggle, InverseSolvesStiffnessOverSixDecades) {
  LimbJiggle limb;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> decades(-3, 3);
  for (TetMaterial& material : limb.system.materials) {
    const double by = std::pow(10, decades(random));
    material = {by * material.mu, by * material.lambda};
  }
  const JiggleTable table = make_jiggle_table(limb.mesh, limb.system, {});
  EXPECT_LT(solve_error(textbook_system(limb.mesh, limb.system, (1 - std::numbers::sqrt2 / 2) / 24), table.inverse),
            1e-3);
}

// In every mode of 3 Hz the damping ratio is the one asked for, wherever it lives.
TEST(Jiggle, DampingRatiosAreMetAtThreeHertz) {
  const double w = 6 * std::numbers::pi;
  JiggleSettings settings;
  settings.damping = 0.4;
  settings.regions = {{JiggleRegion::By::joint, "lower", {}, 0.1, {}}};
  const LimbJiggle limb(settings);
  EXPECT_GT(limb.system.stiffness_damping, 0);
  double least = 1, most = 0;
  for (Eigen::Index n = 0; n < limb.system.mass.size(); ++n) {
    const double ratio = limb.system.mass_damping[n] / (2 * w) + limb.system.stiffness_damping * w / 2;
    EXPECT_NEAR(ratio, limb.fields.damping[n], 1e-12);
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  EXPECT_NEAR(least, 0.1, 0.01);
  EXPECT_NEAR(most, 0.4, 0.01);
}

TEST(Jiggle, NodesHoldMassInertiaAndSprings) {
  const LimbJiggle limb;
  const JiggleStep step{.frames_per_second = 25};
  const JiggleTable table = make_jiggle_table(limb.mesh, limb.system, step);
  const double d = (1 - std::numbers::sqrt2 / 2) / 25;
  const double springs = limb.system.springs.coeffs().maxCoeff();
  double total = 0;
  for (std::size_t n = 0; n < table.nodes.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    const double inertia = limb.system.mass[row] * (1 / (d * d) + limb.system.mass_damping[row] / d);
    EXPECT_NEAR(static_cast<double>(table.nodes[n].inertia) / inertia, 1, 1e-6);
    total += static_cast<double>(table.nodes[n].mass);
    EXPECT_NEAR(static_cast<double>(table.springs[n]), limb.system.springs.col(row).sum(), 1e-6 * springs) << n;
  }
  EXPECT_NEAR(total, limb.system.mass.sum(), 1e-5 * total);
  EXPECT_EQ(table.step.stiffness_damping, static_cast<float>(limb.system.stiffness_damping));
}

// How far gravity pulls every node, metres.
Eigen::VectorXd sag(const LimbJiggle& limb) {
  const SparseMatrix stiffness = elastic_stiffness(limb.mesh, limb.system.materials) + on_axes(limb.system.springs);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(stiffness.rows());
  for (Eigen::Index n = 0; n < limb.system.mass.size(); ++n) force[3 * n + 1] = -9.81 * limb.system.mass[n];
  const SparseSolver factor(stiffness);
  const Eigen::VectorXd moved = factor.solve(force);
  Eigen::VectorXd distance(limb.system.mass.size());
  for (Eigen::Index n = 0; n < distance.size(); ++n) distance[n] = moved.segment<3>(3 * n).norm();
  return distance;
}

TEST(Jiggle, HeldPartsDoNotMoveAndOthersStayFree) {
  JiggleSettings settings;
  settings.regions = {{JiggleRegion::By::joint, "lo*", {}, {}, 0.0}};
  const LimbJiggle free, held(settings);
  const Eigen::VectorXd before = sag(free), after = sag(held);
  for (std::size_t v = 0; v < held.fields.skin_amount.size(); ++v) {
    const double x = held.limb.vertices(static_cast<Eigen::Index>(v), 0);
    if (x < 0.2) {
      EXPECT_EQ(held.fields.skin_amount[v], 1) << x;
    }
    if (x > 0.3) {
      EXPECT_EQ(held.fields.skin_amount[v], 0) << x;
    }
  }
  double held_most = 0, free_most = 0;
  for (Eigen::Index n = 0; n < after.size(); ++n) {
    const double x = held.mesh.nodes(n, 0);
    if (x > 0.35) {
      held_most = std::max(held_most, after[n]);
      free_most = std::max(free_most, before[n]);
    }
    if (x < 0.15) {
      EXPECT_NEAR(after[n] / before[n], 1, 0.2) << x;
    }
  }
  EXPECT_LT(held_most, 0.5e-3);  // springs of 30 Hz alone: 9.81 / (60 pi)^2 m
  EXPECT_GT(free_most, 2 * held_most);
}

TEST(Jiggle, SoftnessDividesTheStiffnessWhereItIs) {
  const LimbJiggle standard;
  JiggleSettings settings;
  settings.softness = 2;
  const LimbJiggle soft(settings);
  for (std::size_t t = 0; t < soft.system.materials.size(); ++t) {
    EXPECT_NEAR(soft.system.materials[t].mu * 2 / standard.system.materials[t].mu, 1, 1e-12);
    EXPECT_NEAR(soft.system.materials[t].lambda / soft.system.materials[t].mu, 9, 1e-9);  // Poisson 0.45
  }
  settings.softness = 1;
  settings.regions = {{JiggleRegion::By::muscle, "flex*", 8.0, {}, {}}};
  const LimbJiggle muscle(settings);
  double softest = 1;
  for (std::size_t t = 0; t < muscle.system.materials.size(); ++t) {
    const double ratio = muscle.system.materials[t].mu / standard.system.materials[t].mu;
    double share = 0;
    for (int a = 0; a < 4; ++a) {
      share += muscle.anatomy.muscle_share(muscle.mesh.tets(static_cast<Eigen::Index>(t), a), 0) / 4;
    }
    EXPECT_NEAR(ratio, std::pow(8, -share), 1e-9);
    softest = std::min(softest, ratio);
  }
  EXPECT_LT(softest, 0.5);
}

TEST(Jiggle, PaintedRegionsAreCarriedInwards) {
  RegionWeights painted{"end", {}, {}};
  const Character limb = make_limb();
  for (std::uint32_t v = 0; v < limb.vertices.rows(); ++v) {
    if (limb.vertices(v, 0) < 0.25) continue;
    painted.vertices.push_back(v);
    painted.weights.push_back(1);
  }
  JiggleSettings settings;
  settings.regions = {{JiggleRegion::By::painted, "end", {}, {}, 3.0}};
  const LimbJiggle jiggle(settings, {painted});
  int inside = 0;
  for (Eigen::Index n = 0; n < jiggle.mesh.nodes.rows(); ++n) {
    const double x = jiggle.mesh.nodes(n, 0);
    if (x > 0.05 && x < 0.18) {
      EXPECT_NEAR(jiggle.fields.amount[n], 1, 0.2) << x;
    }
    if (x > 0.32 && x < 0.45) {
      EXPECT_NEAR(jiggle.fields.amount[n], 3, 0.2) << x;
    }
    inside += n >= static_cast<Eigen::Index>(jiggle.tets.surface.size()) ? 1 : 0;
  }
  EXPECT_GT(inside, 0);
}

TEST(Jiggle, ActiveMusclesHoldTheirNodes) {
  const LimbJiggle limb;
  Basis basis;
  basis.strain.names = {"other/1", "flexor/1", "flexor/2"};
  basis.strain.rest_length = {1, 1, 1};
  basis.residual.controls = {"breath", "flex*"};
  std::vector<JiggleNode> nodes(static_cast<std::size_t>(limb.mesh.nodes.rows()),
                                JiggleNode{1, 1, 0, 0, kNoControl, 0});
  set_muscles(limb.anatomy, limb.muscles, basis, 4, nodes);
  int muscle = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const double share = limb.anatomy.muscle_share(static_cast<Eigen::Index>(n), 0);
    ASSERT_GE(share, 0);
    ASSERT_LE(share, 1 + 1e-12);
    EXPECT_NEAR(static_cast<double>(nodes[n].stiffening), share * std::pow(8 * std::numbers::pi, 2), 1e-3);
    EXPECT_EQ(nodes[n].fibre_count, share > 0 ? 2u : 0u);
    EXPECT_EQ(nodes[n].first_fibre, share > 0 ? 1u : 0u);
    EXPECT_EQ(nodes[n].control, share > 0 ? 1u : kNoControl);
    muscle += share > 0 ? 1 : 0;
  }
  EXPECT_GT(muscle, 10);
  // A muscle that neither fibres nor controls know can never be active.
  std::vector<JiggleNode> idle(nodes.size(), JiggleNode{1, 1, 0, 0, kNoControl, 0});
  set_muscles(limb.anatomy, limb.muscles, Basis{}, 4, idle);
  for (const JiggleNode& node : idle) EXPECT_EQ(node.stiffening, 0);
}

TEST(Jiggle, PiecesWithoutBonesArePinnedAndNamed) {
  const Character both = make_two_limbs(0.2);
  const DynamicsTets tets = make_dynamics_tets(both.vertices, both.triangles, both.weights, 25000);
  const TetMesh& mesh = tets.cage.mesh;
  JiggleAnatomy anatomy = find_anatomy(both, AnatomyField(both, {}, kLimbAnatomy), 0, tets.cage, {});
  const JiggleFields fields = spread_settings({}, both, {}, {}, tets, anatomy);
  const auto is_first = [&](int n) { return mesh.nodes(n, 1) < 0.1; };
  anatomy.bone_springs.prune([&](Eigen::Index n, Eigen::Index, double) { return is_first(static_cast<int>(n)); });
  std::vector<std::string> notes;
  const JiggleSystem system = make_jiggle_system({}, fields, both.skeleton, mesh, anatomy, {}, notes);
  ASSERT_EQ(notes.size(), 1u);
  int second = 0;
  for (int n = 0; n < mesh.nodes.rows(); ++n) {
    if (is_first(n)) continue;
    ++second;
    EXPECT_NEAR(system.springs.coeff(n, n) / system.mass[n], std::pow(std::numbers::pi, 2), 1e-6);
  }
  EXPECT_NE(notes[0].find(std::to_string(second) + " nodes near the joint 'upper'"), std::string::npos) << notes[0];
  EXPECT_TRUE(LimbJiggle().notes.empty());
  EXPECT_NO_THROW(make_jiggle_table(mesh, system, {}));
}

void expect_error(ErrorKind kind, const std::string& named, const std::function<void()>& work) {
  try {
    work();
    ADD_FAILURE() << "accepted: " << named;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
  }
}

TEST(Jiggle, NamesThatAreNotThereAreRefused) {
  using By = JiggleRegion::By;
  for (const auto& [by, name, named] :
       {std::tuple(By::joint, "wrist", "the joint 'wrist'"), std::tuple(By::muscle, "biceps*", "the muscle 'biceps*'"),
        std::tuple(By::painted, "belly", "the painted region 'belly'")}) {
    JiggleSettings settings;
    settings.regions = {{by, name, 2.0, {}, {}}};
    expect_error(ErrorKind::mismatch, named, [&] { LimbJiggle{settings}; });
  }
}

TEST(Jiggle, ImpossibleMaterialsAndStepsAreRefused) {
  const auto expect = [](const char* named, const std::function<void(JiggleSettings&)>& change) {
    JiggleSettings settings;
    change(settings);
    expect_error(ErrorKind::usage, named, [&] { LimbJiggle{settings}; });
  };
  expect("Poisson", [](JiggleSettings& s) { s.poisson = 0.5; });
  expect("Poisson", [](JiggleSettings& s) { s.poisson = -1; });
  expect("Poisson", [](JiggleSettings& s) { s.poisson = std::nan(""); });
  expect("density", [](JiggleSettings& s) { s.density = 0; });
  expect("density", [](JiggleSettings& s) { s.density = -1000; });
  expect("tension", [](JiggleSettings& s) { s.tension = -1; });
  expect("softness", [](JiggleSettings& s) { s.softness = 0; });
  expect("softness", [](JiggleSettings& s) { s.softness = -2; });
  expect("damping", [](JiggleSettings& s) { s.damping = -0.1; });
  expect("amount", [](JiggleSettings& s) { s.amount = -1; });
  const LimbJiggle limb;
  for (const float fps : {0.0f, -24.0f, std::nanf(""), HUGE_VALF}) {
    expect_error(ErrorKind::usage, "frames a second",
                 [&] { make_jiggle_table(limb.mesh, limb.system, {.frames_per_second = fps}); });
  }
  expect_error(ErrorKind::usage, "substeps", [&] { make_jiggle_table(limb.mesh, limb.system, {.substeps = 0}); });
}

}  // namespace
}  // namespace bodyopt::trainer
