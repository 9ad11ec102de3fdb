#include "trainer/dynamics/lowest_frequency.h"

#include <algorithm>
#include <map>
#include <numbers>

#include "assets/wording.h"
#include "base/linear_algebra.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr int kMostRounds = 8;
constexpr double kNearEnough = 1.2;  // times the give that is allowed: frequencies of a tenth below
constexpr double kNoted = 0.02;      // of a joint's tissue, held: a note names it

// Every node's give along the axis that it gives way most to, 1/s^-2.
Eigen::VectorXd give_of(const TetMesh& mesh, const SparseMatrix& elastic, const JiggleSystem& system) {
  const Eigen::Index nodes = mesh.nodes.rows();
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index k = 0; k < system.springs.outerSize(); ++k) {
    for (SparseMatrix::InnerIterator entry(system.springs, k); entry; ++entry) {
      for (Eigen::Index i = 0; i < 3; ++i)
        entries.emplace_back(3 * entry.row() + i, 3 * entry.col() + i, entry.value());
    }
  }
  SparseMatrix matrix(3 * nodes, 3 * nodes);
  matrix.setFromTriplets(entries.begin(), entries.end());
  matrix += elastic;
  const SparseSolver factor(matrix);
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

}  // namespace

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

}  // namespace bodyopt
