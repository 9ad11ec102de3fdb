#include "trainer/dynamics/jiggle.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/disjoint_sets.h"
#include "base/linear_algebra.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/host/jiggle.h"
#include "trainer/dynamics/block_inverse.h"
#include "trainer/simulate/muscle_fibres.h"

namespace bodyopt::trainer {
namespace {

constexpr double kFullyHeld = 1.25;  // times `flesh`

double blended(const Eigen::VectorXd& values, const Tets& tets, const EmbeddedPoint& point) {
  double sum = 0;
  for (int a = 0; a < 4; ++a) sum += point.weights[a] * values[tets(point.tet, a)];
  return sum;
}

// Tissue that jiggles is softer than the simulation's, and coarse linear tets are too stiff. With this factor the
// thighs and the chest of a person swing at 6 to 7 Hz, the belly at 5.
constexpr double kSofterThanSimulated = 3.5;
// A body of several times a person's size, in a unit of its own or not, moves as many times as far in a second. Its
// tissue is as many times squared stiffer: it swings as fast, and as far for its size.
constexpr double kPerson = 1.8;         // metres, the longest extent
constexpr double kDampedFrequency = 3;  // Hz: at which damping ratios are met
// This share of the least damping ratio comes from the stiffness: it grows with the frequency, as it does in tissue.
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
    throw Error(ErrorKind::usage, "the dynamics are for ", step.frames_per_second,
                " frames a second, expected a number above 0");
  }
  if (step.substeps == 0) throw Error(ErrorKind::usage, "a frame has 0 substeps, expected 1 or more");
}

constexpr int kMostRounds = 8;
constexpr double kNearEnough = 1.2;  // times the give that is allowed: frequencies of a tenth below
constexpr double kNoted = 0.02;      // of a joint's tissue, held: a note names it

// N x N, alike in all directions -> 3N x 3N.
SparseMatrix in_three_axes(const SparseMatrix& matrix) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index n = 0; n < matrix.cols(); ++n) {
    for (SparseMatrix::InnerIterator entry(matrix, n); entry; ++entry) {
      for (Eigen::Index i = 0; i < 3; ++i) entries.emplace_back(3 * entry.row() + i, 3 * n + i, entry.value());
    }
  }
  return sparse_matrix(3 * matrix.rows(), 3 * matrix.cols(), entries);
}

// Every node's give along the axis that it gives way most to, 1/s^-2.
Eigen::VectorXd give_of(const TetMesh& mesh, const SparseMatrix& elastic, const JiggleSystem& system) {
  const Eigen::Index nodes = mesh.nodes.rows();
  const SparseSolver factor(in_three_axes(system.springs) + elastic);
  if (!factor.is_solvable()) {
    throw Error(ErrorKind::mismatch, "the stiffness of the tetrahedra cannot be factorised: some of them are flat");
  }
  Eigen::VectorXd give = Eigen::VectorXd::Zero(nodes);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * nodes);
    for (Eigen::Index n = 0; n < nodes; ++n) force[3 * n + axis] = system.mass[n];
    const Eigen::VectorXd moved = factor.solve(force);
    for (Eigen::Index n = 0; n < nodes; ++n) give[n] = std::max(give[n], moved.segment<3>(3 * n).norm());
  }
  return give;
}

// Names joints by the tissue that was held, the slowest first.
std::string note_of(double lowest, const Eigen::VectorXd& give, const Eigen::VectorXd& own, const Eigen::VectorXd& mass,
                    const Skeleton& skeleton, const NodeWeights& joint_share) {
  std::multimap<double, std::string> slow;  // by Hz
  for (Eigen::Index j = 0; j < joint_share.cols(); ++j) {
    double all = 0, held = 0, most = 0;
    for (Eigen::Index n = 0; n < give.size(); ++n) {
      const double part = joint_share(n, j) * mass[n];
      all += part;
      if (own[n] == 0) continue;
      held += part;
      if (joint_share(n, j) > 0.5) most = std::max(most, give[n]);
    }
    if (!(held > kNoted * all) || most == 0) continue;
    slow.emplace(1 / (2 * std::numbers::pi * std::sqrt(most)), skeleton.joints[static_cast<std::size_t>(j)].name);
  }
  if (slow.empty()) return {};
  std::vector<std::string> names;
  for (const auto& [hertz, name] : slow) names.push_back(name);
  return "tissue at the " + std::string(names.size() > 1 ? "joints " : "joint ") + list_names(names) +
         " would swing at " + rounded(slow.begin()->first) +
         " Hz: springs hold it so that nothing swings slower than " + rounded(lowest) +
         " Hz over the root of its softness";
}

constexpr double kAtLimit = 0.75;  // of the limit: what is shown of a displacement as large as the limit

std::uint32_t count_inverted(const TetTable& tets, const std::vector<float>& nodes) {
  const auto node = [&](std::uint32_t n) {
    return Eigen::Map<const Eigen::Vector3f>(nodes.data() + std::size_t{3} * n).cast<double>().eval();
  };
  std::uint32_t inverted = 0;
  for (std::size_t t = 0; t < tets.tets.size(); t += 4) {
    const Eigen::Vector3d origin = node(tets.tets[t]);
    const Eigen::Vector3d a = node(tets.tets[t + 1]) - origin, b = node(tets.tets[t + 2]) - origin,
                          c = node(tets.tets[t + 3]) - origin;
    inverted += a.cross(b).dot(c) > 0 ? 0 : 1;
  }
  return inverted;
}

}  // namespace

SparseMatrix core_springs(const Positions& vertices, const Triangles& triangles, const Cage& cage,
                          const Eigen::VectorXd& flesh, double stiffness) {
  const NearestSkin nearest(vertices, triangles);
  const TetMesh& mesh = cage.mesh;
  const auto depth = [&](const Eigen::Vector3d& at) { return (nearest(at).position - at).norm(); };
  std::vector<Eigen::Triplet<double>> entries;
  int tet = -1;
  bool is_shallow = false;  // all of the tet
  for (const CageSample& sample : cage.samples) {
    const EmbeddedPoint& point = sample.point;
    const double from = blended(flesh, mesh.tets, point);
    if (point.tet != tet) {
      tet = point.tet;
      const Eigen::Vector3d middle = rest_position(mesh, {tet, Eigen::Vector4d::Constant(0.25)});
      double reach = 0;
      for (int a = 0; a < 4; ++a) {
        reach = std::max(reach, (mesh.nodes.row(mesh.tets(tet, a)).transpose() - middle).norm());
      }
      double least = from;
      for (int a = 0; a < 4; ++a) least = std::min(least, flesh[mesh.tets(tet, a)]);
      is_shallow = depth(middle) + reach < least;
    }
    if (is_shallow) continue;
    const double held = std::clamp((depth(rest_position(mesh, point)) / from - 1) / (kFullyHeld - 1), 0.0, 1.0);
    if (held == 0) continue;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        entries.emplace_back(mesh.tets(tet, a), mesh.tets(tet, b),
                             stiffness * held * sample.volume * point.weights[a] * point.weights[b]);
      }
    }
  }
  return sparse_matrix(mesh.nodes.rows(), mesh.nodes.rows(), entries);
}

SparseMatrix elastic_stiffness(const TetMesh& mesh, const std::vector<TetMaterial>& materials) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(144 * static_cast<std::size_t>(mesh.tets.rows()));
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const Eigen::Matrix3d edges = tet_edges(mesh, t);
    const Eigen::Matrix<double, 4, 3> slopes = corner_slopes(edges);
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
  return sparse_matrix(3 * mesh.nodes.rows(), 3 * mesh.nodes.rows(), entries);
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
  return in_three_axes(held) + b * elastic_stiffness(mesh, system.materials);
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

void hold_slow_parts(double lowest, const Eigen::VectorXd& softness, const Skeleton& skeleton, const TetMesh& mesh,
                     const JiggleAnatomy& anatomy, JiggleSystem& system, std::vector<std::string>& notes) {
  if (lowest == 0) return;
  const SparseMatrix elastic = elastic_stiffness(mesh, system.materials);
  const Eigen::VectorXd allowed = softness / std::pow(2 * std::numbers::pi * lowest, 2);
  Eigen::VectorXd own = Eigen::VectorXd::Zero(mesh.nodes.rows()), first;
  for (int round = 0; round < kMostRounds; ++round) {
    const Eigen::VectorXd give = give_of(mesh, elastic, system);
    if (round == 0) first = give;
    if ((give.array() <= kNearEnough * allowed.array()).all()) break;
    const Eigen::VectorXd more = (give.array() > allowed.array()).select(1 / allowed.array() - 1 / give.array(), 0);
    own += more;
    system.springs += SparseMatrix(more.cwiseProduct(system.mass).asDiagonal());
  }
  const std::string note = note_of(lowest, first, own, system.mass, skeleton, anatomy.joint_share);
  if (!note.empty()) notes.push_back(note);
}

JiggleMeasure measure_jiggle(const Dynamics& dynamics, const NodeMotion& motion) {
  const TetTable& tets = dynamics.tets;
  JiggleMeasure measure{.inverted_tets = count_inverted(tets, motion.nodes)};
  // Displacements do not depend on where the skin is.
  const std::vector<float> nowhere(3 * tets.skin.size(), 0.0f);
  std::vector<float> moved(nowhere.size());
  cpu::jiggle_skin(tets, nowhere, motion.displacement, 1, moved);
  double sum = 0, largest = 0, largest_share = 0;
  for (std::size_t v = 0; v < tets.skin.size(); ++v) {
    const double squared = Eigen::Map<const Eigen::Vector3f>(moved.data() + 3 * v).cast<double>().squaredNorm();
    sum += squared;
    largest = std::max(largest, squared);
    const double share = std::sqrt(squared) / static_cast<double>(tets.skin_limit[v] * tets.skin[v].amount);
    if (!(share > kAtLimit)) continue;
    ++measure.limited;
    if (share > largest_share) measure.most_limited = static_cast<std::uint32_t>(v);
    largest_share = std::max(largest_share, share);
  }
  measure.rms_mm = 1e3 * std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, tets.skin.size())));
  measure.max_mm = 1e3 * std::sqrt(largest);
  return measure;
}

}  // namespace bodyopt::trainer
