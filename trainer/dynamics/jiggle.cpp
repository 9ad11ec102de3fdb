#include "trainer/dynamics/jiggle.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "assets/wording.h"
#include "base/disjoint_sets.h"
#include "geometry/extent.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "trainer/dynamics/block_inverse.h"
#include "trainer/simulate/muscle_fibres.h"

namespace bodyopt {
namespace {

// Tissue that jiggles is softer than the simulation's, and its tets, coarse and linear, are stiffer than what they
// stand for: with this the thighs and the chest of a person swing at 6 to 7 Hz, the belly at 5.
constexpr double kSofterThanSimulated = 3.5;
// A body of several times a person's size, in a unit of its own or not, moves as many times as far in a second. Its
// tissue is as many times squared stiffer: it swings as fast, and as far for its size.
constexpr double kPerson = 1.8;         // metres, the longest extent
constexpr double kDampedFrequency = 3;  // Hz: at which damping ratios are met
// Of the least damping ratio, this share comes from the stiffness: it grows with the frequency, as it does in tissue.
constexpr double kStiffnessShare = 0.2;
constexpr double kHeldFrequency = 30;  // Hz, of the springs of nodes that are held
constexpr double kHeldBelow = 0.1;     // amounts: nodes of less are held, the more the less they have
constexpr double kPinFrequency = 0.5;  // Hz, of the springs of a piece that no bone holds

double angular(double hertz) { return 2 * std::numbers::pi * hertz; }

std::vector<TetMaterial> tet_materials(const JiggleSettings& settings, const Eigen::VectorXd& softness,
                                       const TetMesh& mesh, const JiggleAnatomy& anatomy, const Materials& materials) {
  const double stiffer = std::pow(std::max(1.0, longest_extent(mesh.nodes) / kPerson), 2);
  std::vector<TetMaterial> result = tet_materials(anatomy.tissue.shares, materials);
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    double log_softness = 0;
    for (int a = 0; a < 4; ++a) log_softness += std::log(softness[mesh.tets(t, a)]) / 4;
    TetMaterial& material = result[static_cast<std::size_t>(t)];
    material.mu *= stiffer / (kSofterThanSimulated * std::exp(log_softness));
    material.lambda = 2 * material.mu * settings.poisson / (1 - 2 * settings.poisson);
  }
  return result;
}

// The piece of the body that each node is in: its lowest node.
std::vector<int> pieces_of(const TetMesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.nodes.rows());
  DisjointSets sets(count);
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    for (int a = 1; a < 4; ++a) {
      sets.join(static_cast<std::size_t>(mesh.tets(t, 0)), static_cast<std::size_t>(mesh.tets(t, a)));
    }
  }
  std::vector<int> pieces;
  for (std::size_t n = 0; n < count; ++n) pieces.push_back(static_cast<int>(sets.lowest(n)));
  return pieces;
}

// Squared angular frequency of every node's own springs: of those that are held, and of pieces without any.
Eigen::VectorXd own_springs(const JiggleFields& fields, const Skeleton& skeleton, const TetMesh& mesh,
                            const JiggleAnatomy& anatomy, std::vector<std::string>& notes) {
  const Eigen::Index nodes = mesh.nodes.rows();
  Eigen::VectorXd springs(nodes);
  for (Eigen::Index n = 0; n < nodes; ++n) {
    const double held = std::clamp(1 - fields.amount[n] / kHeldBelow, 0.0, 1.0);
    springs[n] = std::pow(angular(kHeldFrequency) * held, 2);
  }
  const std::vector<int> piece = pieces_of(mesh);
  std::vector<bool> has_springs(piece.size(), false);
  std::vector<std::size_t> size(piece.size(), 0);
  for (Eigen::Index n = 0; n < nodes; ++n) {
    const auto p = static_cast<std::size_t>(piece[static_cast<std::size_t>(n)]);
    ++size[p];
    if (springs[n] > 0 || anatomy.bone_springs.coeff(n, n) > 0) has_springs[p] = true;
  }
  for (Eigen::Index n = 0; n < nodes; ++n) {
    const auto p = static_cast<std::size_t>(piece[static_cast<std::size_t>(n)]);
    if (has_springs[p]) continue;
    springs[n] = std::pow(angular(kPinFrequency), 2);
    if (static_cast<Eigen::Index>(p) != n) continue;
    Eigen::Index joint = 0;
    anatomy.joint_share.row(n).maxCoeff(&joint);
    notes.push_back("a piece of " + count_of(size[p], "node", "nodes") + " near the joint '" +
                    skeleton.joints[static_cast<std::size_t>(joint)].name +
                    "' has no bone inside: it is held by soft springs of 0.5 Hz");
  }
  return springs;
}

// N: mass / d^2 + alpha mass / d.
Eigen::VectorXd inertia_of(const JiggleSystem& system, double d) {
  return system.mass.array() * (1 / (d * d) + system.mass_damping.array() / d);
}

void require_step(const JiggleStep& step) {
  if (!(step.frames_per_second > 0 && std::isfinite(step.frames_per_second))) {
    throw Error(ErrorKind::usage, "the dynamics are for " + std::to_string(step.frames_per_second) +
                                      " frames a second, expected a number above 0");
  }
  if (step.substeps == 0) throw Error(ErrorKind::usage, "a frame has 0 substeps, expected 1 or more");
}

}  // namespace

SparseMatrix elastic_stiffness(const TetMesh& mesh, const std::vector<TetMaterial>& materials) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(144 * static_cast<std::size_t>(mesh.tets.rows()));
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const Eigen::Matrix3d edges = tet_edges(mesh, t);
    Eigen::Matrix<double, 4, 3> slopes;
    slopes.bottomRows<3>() = edges.inverse();
    slopes.row(0) = -slopes.bottomRows<3>().colwise().sum();
    const double volume = edges.determinant() / 6;
    const TetMaterial& material = materials[static_cast<std::size_t>(t)];
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const Eigen::Vector3d of_a = slopes.row(a), of_b = slopes.row(b);
        Eigen::Matrix3d block = material.lambda * of_a * of_b.transpose() + material.mu * of_b * of_a.transpose();
        block.diagonal().array() += material.mu * of_a.dot(of_b);
        for (int i = 0; i < 3; ++i) {
          for (int k = 0; k < 3; ++k) {
            entries.emplace_back(3 * mesh.tets(t, a) + i, 3 * mesh.tets(t, b) + k, volume * block(i, k));
          }
        }
      }
    }
  }
  SparseMatrix matrix(3 * mesh.nodes.rows(), 3 * mesh.nodes.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::VectorXd lumped_mass(const TetMesh& mesh, double density) {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(mesh.nodes.rows());
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const double quarter = density * tet_edges(mesh, t).determinant() / 24;
    for (int a = 0; a < 4; ++a) mass[mesh.tets(t, a)] += quarter;
  }
  return mass;
}

JiggleSystem make_jiggle_system(const JiggleSettings& settings, const JiggleFields& fields, const Skeleton& skeleton,
                                const TetMesh& mesh, const JiggleAnatomy& anatomy, const Materials& materials,
                                std::vector<std::string>& notes) {
  JiggleSystem system;
  system.materials = tet_materials(settings, fields.softness, mesh, anatomy, materials);
  system.mass = lumped_mass(mesh, settings.density);
  // A mode of angular frequency w is damped by alpha / (2 w) + beta w / 2.
  const double w = angular(kDampedFrequency), by_stiffness = kStiffnessShare * fields.damping.minCoeff();
  system.stiffness_damping = 2 * by_stiffness / w;
  system.mass_damping = 2 * w * (fields.damping.array() - by_stiffness);
  const Eigen::VectorXd own = own_springs(fields, skeleton, mesh, anatomy, notes).cwiseProduct(system.mass);
  system.springs = anatomy.bone_springs + SparseMatrix(own.asDiagonal());
  return system;
}

SparseMatrix jiggle_matrix(const TetMesh& mesh, const JiggleSystem& system, const JiggleStep& step) {
  const double d = step.stage(), b = 1 + system.stiffness_damping / d;
  const SparseMatrix held = b * system.springs + SparseMatrix(inertia_of(system, d).asDiagonal());
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index n = 0; n < held.cols(); ++n) {
    for (SparseMatrix::InnerIterator entry(held, n); entry; ++entry) {
      for (Eigen::Index i = 0; i < 3; ++i) entries.emplace_back(3 * entry.row() + i, 3 * n + i, entry.value());
    }
  }
  SparseMatrix matrix(3 * held.rows(), 3 * held.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix + b * elastic_stiffness(mesh, system.materials);
}

JiggleTable make_jiggle_table(const TetMesh& mesh, const JiggleSystem& system, JiggleStep step) {
  require_step(step);
  step.stiffness_damping = static_cast<float>(system.stiffness_damping);
  JiggleTable table;
  table.step = step;
  const Eigen::VectorXd inertia = inertia_of(system, step.stage()),
                        springs = system.springs * Eigen::VectorXd::Ones(inertia.size());
  for (Eigen::Index n = 0; n < inertia.size(); ++n) {
    table.nodes.push_back({static_cast<float>(system.mass[n]), static_cast<float>(inertia[n]), 0, 0, kNoControl, 0});
    table.springs.push_back(static_cast<float>(springs[n]));
  }
  table.inverse = invert(jiggle_matrix(mesh, system, step), mesh.nodes, 3);
  return table;
}

void set_muscles(const JiggleAnatomy& anatomy, const std::vector<Muscle>& muscles, const Basis& basis, double tension,
                 std::vector<JiggleNode>& nodes) {
  struct Source {
    std::uint32_t first_fibre = 0, fibre_count = 0, control = kNoControl;
  };
  std::vector<Source> sources(muscles.size());
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    Source& source = sources[m];
    for (std::uint32_t f = basis.strain.fibre_count(); f-- > 0;) {
      const std::string& name = basis.strain.names[f];
      if (name.substr(0, name.rfind('/')) != muscles[m].name) continue;
      source.first_fibre = f;  // they stand side by side
      ++source.fibre_count;
    }
    for (std::size_t c = basis.residual.controls.size(); c-- > 0;) {
      if (matches_pattern(basis.residual.controls[c], muscles[m].name)) source.control = static_cast<std::uint32_t>(c);
    }
  }
  for (std::size_t n = 0; n < nodes.size() && !muscles.empty(); ++n) {
    Eigen::Index muscle = 0;
    const double share = anatomy.muscle_share.row(static_cast<Eigen::Index>(n)).maxCoeff(&muscle);
    const Source& source = sources[static_cast<std::size_t>(muscle)];
    if (!(share > 0) || (source.fibre_count == 0 && source.control == kNoControl)) continue;
    nodes[n].first_fibre = source.first_fibre;
    nodes[n].fibre_count = source.fibre_count;
    nodes[n].control = source.control;
    nodes[n].stiffening = static_cast<float>(std::pow(angular(tension), 2) * share);
  }
}

}  // namespace bodyopt
