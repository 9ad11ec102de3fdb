#include "trainer/train/region_features.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <numeric>

#include "runtime/rig.h"

namespace bodyopt {
namespace {

constexpr double kReach = 0.35;      // metres from a region's centre, for a human body
constexpr double kInfluence = 0.02;  // mean skin weight that makes a joint matter
constexpr std::size_t kMostJoints = 12;
constexpr std::size_t kNearStrains = 32, kMostStrains = 40;
constexpr double kRidge = 1e-3;
constexpr double kExplains = 0.02;  // part of what is left that a distant strain must explain

// Mean skin weight of every joint over a region.
std::vector<double> joint_influence(const SoftRegion& region, const Character& character) {
  std::vector<double> influence(character.skeleton.size(), 0.0);
  const double sum = std::accumulate(region.weights.begin(), region.weights.end(), 0.0);
  for (std::size_t k = 0; k < region.vertices.size(); ++k) {
    for (const JointWeight& w : character.weights[region.vertices[k]]) {
      influence[w.joint] += w.weight * static_cast<double>(region.weights[k]) / sum;
    }
  }
  return influence;
}

Eigen::Vector3d joint_position(const Joint& joint) {
  const Affine bind = inverse(joint.inverse_bind);
  return {bind.m[0][3], bind.m[1][3], bind.m[2][3]};
}

// How much each joint matters to a region; 0: not at all.
std::vector<double> joint_scores(const SoftRegion& region, const Character& character) {
  const double reach = kReach * body_scale(character.vertices);
  std::vector<double> scores = joint_influence(region, character);
  std::vector<bool> matters(scores.size());
  for (std::size_t j = 0; j < scores.size(); ++j) {
    const double distance = (joint_position(character.skeleton.joints[j]) - region.centre).norm();
    matters[j] = scores[j] > kInfluence || distance < reach;
    scores[j] += 0.5 * std::max(0.0, 1 - distance / (2 * reach));
  }
  const std::vector<bool> direct = matters;
  for (std::size_t j = 0; j < scores.size(); ++j) {
    const int parent = character.skeleton.joints[j].parent;
    if (parent < 0) continue;
    if (direct[j]) matters[static_cast<std::size_t>(parent)] = true;
    if (direct[static_cast<std::size_t>(parent)]) matters[j] = true;
  }
  for (std::size_t j = 0; j < scores.size(); ++j) scores[j] = matters[j] ? scores[j] + 1e-3 : 0;
  return scores;
}

double fibre_distance(const Basis& basis, std::uint32_t fibre, const Eigen::Vector3d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = basis.strain.fibre_begin[fibre]; k < basis.strain.fibre_begin[fibre + 1]; ++k) {
    const float* rest = basis.mesh.rest.data() + 3 * std::size_t{basis.strain.vertices[basis.strain.points[k].a]};
    nearest = std::min(nearest, (Eigen::Vector3d(rest[0], rest[1], rest[2]) - point).norm());
  }
  return nearest;
}

std::uint32_t first_strain(const Basis& basis) { return joint_feature_count(basis.skeleton); }
std::uint32_t first_control(const Basis& basis) { return first_strain(basis) + basis.strain.fibre_count(); }

void add_joint(std::vector<std::uint32_t>& chosen, std::size_t group) {
  for (std::size_t k = 0; k < 9; ++k) chosen.push_back(static_cast<std::uint32_t>(9 * group + k));
}

void add_controls(std::vector<std::uint32_t>& chosen, const Basis& basis) {
  for (std::uint32_t k = 0; k < basis.residual.controls.size(); ++k) chosen.push_back(first_control(basis) + k);
}

}  // namespace

std::vector<std::uint32_t> nearby_features(const SoftRegion& region, const Character& character, const Basis& basis) {
  const std::vector<double> scores = joint_scores(region, character);
  const std::vector<std::uint32_t> joints = feature_joints(basis.skeleton);
  std::vector<std::size_t> groups(joints.size());
  std::iota(groups.begin(), groups.end(), std::size_t{0});
  std::stable_sort(groups.begin(), groups.end(),
                   [&](std::size_t a, std::size_t b) { return scores[joints[a]] > scores[joints[b]]; });
  std::vector<std::uint32_t> chosen;
  for (std::size_t k = 0; k < std::min(groups.size(), kMostJoints) && scores[joints[groups[k]]] > 0; ++k) {
    add_joint(chosen, groups[k]);
  }

  std::vector<std::pair<double, std::uint32_t>> fibres;
  for (std::uint32_t s = 0; s < basis.strain.fibre_count(); ++s) {
    const double distance = fibre_distance(basis, s, region.centre);
    if (distance < kReach * body_scale(character.vertices)) fibres.emplace_back(distance, s);
  }
  std::sort(fibres.begin(), fibres.end());
  fibres.resize(std::min(fibres.size(), kNearStrains));
  for (const auto& [distance, fibre] : fibres) chosen.push_back(first_strain(basis) + fibre);
  add_controls(chosen, basis);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<std::uint32_t> joint_features_only(const Basis& basis) {
  std::vector<std::uint32_t> chosen;
  for (std::size_t group = 0; group < feature_joints(basis.skeleton).size(); ++group) add_joint(chosen, group);
  add_controls(chosen, basis);
  return chosen;
}

std::vector<std::uint32_t> add_explaining_strains(std::vector<std::uint32_t> chosen, const Basis& basis,
                                                  const Eigen::MatrixXd& features,
                                                  const Eigen::MatrixXd& coefficients) {
  const auto is_strain = [&](std::uint32_t k) { return k >= first_strain(basis) && k < first_control(basis); };
  std::vector<Eigen::Index> known;
  for (const std::uint32_t k : chosen) {
    if (!is_strain(k)) known.push_back(static_cast<Eigen::Index>(k));
  }
  const std::size_t strains = chosen.size() - known.size();
  if (strains >= kMostStrains) return chosen;

  const Eigen::MatrixXd inputs = features(Eigen::all, known).rowwise() - features(Eigen::all, known).colwise().mean();
  Eigen::MatrixXd gram = inputs.transpose() * inputs;
  gram.diagonal().array() += kRidge * static_cast<double>(inputs.rows());
  const Eigen::LDLT<Eigen::MatrixXd> solver(gram);
  Eigen::MatrixXd left = coefficients.rowwise() - coefficients.colwise().mean();
  if (!known.empty()) left -= inputs * solver.solve(inputs.transpose() * left);

  std::vector<std::pair<double, std::uint32_t>> candidates;
  for (std::uint32_t k = first_strain(basis); k < first_control(basis); ++k) {
    if (std::find(chosen.begin(), chosen.end(), k) != chosen.end()) continue;
    const Eigen::VectorXd column = features.col(k).array() - features.col(k).mean();
    const double length2 = column.squaredNorm();
    if (!(length2 > 1e-9)) continue;
    const double explained = (column.transpose() * left).squaredNorm() / length2;
    if (explained > kExplains * left.squaredNorm()) candidates.emplace_back(-explained, k);
  }
  std::sort(candidates.begin(), candidates.end());
  candidates.resize(std::min(candidates.size(), kMostStrains - strains));
  for (const auto& [score, k] : candidates) chosen.push_back(k);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace bodyopt
