#include "trainer/simulate/tet_tissue.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "base/parallel.h"

namespace bodyopt::trainer {
namespace {

// Samples along a tet's edge, less one: 84 in all, 20 of each eighth of a tet of second order.
constexpr int kSampleRows = 6, kEighthRows = 3;

struct Sample {
  Eigen::Vector4d weights;  // barycentric
  double volume;            // cubic metres
};

struct MuscleSum {
  double volume = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // weighted by volume
};

// Sums over the samples of a tet, cubic metres.
struct TetSums {
  double volume = 0;  // of the tet
  TissueShares of;    // muscles apart
  std::map<int, Eigen::Matrix4d> bones;
  std::map<int, MuscleSum> muscles;

  void add(const PointTissue& point, const Sample& sample) {
    switch (point.at.kind) {
      case TissueKind::bone:
        of.bone += sample.volume;
        bones.try_emplace(point.at.joint, Eigen::Matrix4d::Zero()).first->second +=
            sample.volume * sample.weights * sample.weights.transpose();
        break;
      case TissueKind::outside:  // where a skin was mended, a cage's own tissue
      case TissueKind::fat:
        of.fat += sample.volume;
        break;
      case TissueKind::cavity:
        of.cavity += sample.volume;
        break;
      case TissueKind::muscle: {
        MuscleSum& sum = muscles[point.at.muscle];
        sum.volume += sample.volume;
        sum.direction += sample.volume * point.fibre;
        break;
      }
      case TissueKind::tendon:
      case TissueKind::other_lean:
        of.lean += sample.volume;
        break;
    }
  }
};

TetSums sum_samples(const TetMesh& mesh, Eigen::Index tet, std::span<const Sample> samples, const TissueField& field) {
  TetSums sums;
  sums.volume = tet_edges(mesh, tet).determinant() / 6;
  for (const Sample& sample : samples) {
    sums.add(field(rest_position(mesh, {static_cast<int>(tet), sample.weights})), sample);
  }
  return sums;
}

// Barycentric; alike for all corners.
std::vector<Eigen::Vector4d> sample_weights(int rows) {
  // Their distance from the faces, in distances between samples, makes the mean of the squares of barycentric weights
  // that over the tet, a tenth. Nearer to the faces, what lies along edges would count too much.
  const double inset = (std::sqrt(0.25 * rows * rows + rows) - 0.5 * rows) / 2;
  return tet_lattice(rows, inset);
}

// The samples are points spread evenly in every tet.
std::vector<TetSums> sum_evenly(const TetMesh& mesh, const TissueField& field) {
  const std::vector<Eigen::Vector4d> lattice = sample_weights(mesh.is_second_order ? kEighthRows : kSampleRows);
  std::vector<TetSums> sums(static_cast<std::size_t>(mesh.tets.rows()));
  parallel_for(sums.size(), [&](std::size_t t) {
    const auto tet = static_cast<Eigen::Index>(t);
    const double volume = tet_edges(mesh, tet).determinant() / 6 / static_cast<double>(lattice.size());
    std::vector<Sample> samples;
    for (const Eigen::Vector4d& weights : lattice) samples.push_back({weights, volume});
    sums[t] = sum_samples(mesh, tet, samples, field);
  });
  return sums;
}

std::vector<TetSums> sum_own_samples(const Cage& cage, const TissueField& field) {
  std::vector<std::vector<Sample>> samples(static_cast<std::size_t>(cage.mesh.tets.rows()));
  for (const CageSample& sample : cage.samples) {
    samples[static_cast<std::size_t>(sample.point.tet)].push_back({sample.point.weights, sample.volume});
  }
  std::vector<TetSums> sums(samples.size());
  parallel_for(sums.size(), [&](std::size_t t) {
    sums[t] = sum_samples(cage.mesh, static_cast<Eigen::Index>(t), samples[t], field);
  });
  return sums;
}

std::vector<bool> muscles_with_room(const std::vector<TetSums>& sums) {
  std::vector<bool> has_room;
  for (const TetSums& tet : sums) {
    for (const auto& [muscle, sum] : tet.muscles) {
      const auto m = static_cast<std::size_t>(muscle);
      if (m >= has_room.size()) has_room.resize(m + 1, false);
      if (sum.volume >= TetTissue::kLeastShare * tet.volume) has_room[m] = true;
    }
  }
  return has_room;
}

TetTissue collect(const std::vector<TetSums>& sums) {
  TetTissue tissue;
  const std::vector<bool> has_room = muscles_with_room(sums);
  for (std::size_t t = 0; t < sums.size(); ++t) {
    const TetSums& tet = sums[t];
    TissueShares shares{tet.of.bone / tet.volume, tet.of.fat / tet.volume, tet.of.cavity / tet.volume, 0,
                        tet.of.lean / tet.volume};
    for (const auto& [joint, moments] : tet.bones) tissue.bones.push_back({static_cast<int>(t), joint, moments});
    for (const auto& [muscle, sum] : tet.muscles) {
      const double share = sum.volume / tet.volume, norm = sum.direction.norm();
      const bool is_sliver = share < TetTissue::kLeastShare && has_room[static_cast<std::size_t>(muscle)];
      if (is_sliver || !(norm > 0)) {
        shares.lean += share;
        continue;
      }
      shares.muscle += share;
      tissue.fibres.push_back({static_cast<int>(t), muscle, sum.direction / norm, share});
    }
    tissue.shares.push_back(shares);
  }
  return tissue;
}

TetTissue shared_among_slips(TetTissue tissue, const AnatomyField& anatomy) {
  std::map<int, std::vector<int>> slips;
  std::vector<FibreTet> fibres;
  for (const FibreTet& fibre : tissue.fibres) {
    const auto [found, is_new] = slips.try_emplace(fibre.muscle);
    if (is_new) found->second = anatomy.slips_of(fibre.muscle);
    const double share = fibre.share / static_cast<double>(found->second.size());
    for (const int slip : found->second) fibres.push_back({fibre.tet, slip, fibre.direction, share});
  }
  tissue.fibres = std::move(fibres);
  return tissue;
}

}  // namespace

TissueField tissue_field(const AnatomyField& anatomy) {
  return [&anatomy](const Eigen::Vector3d& point) {
    const TissueAt at = anatomy.tissue_at(point);
    return PointTissue{at, at.kind == TissueKind::muscle ? anatomy.fibre_at(point) : Eigen::Vector3d::Zero()};
  };
}

TetTissue find_tissue(const TetMesh& mesh, const TissueField& field) { return collect(sum_evenly(mesh, field)); }

TetTissue find_tissue(const Cage& cage, const TissueField& field) {
  return cage.is_lattice ? collect(sum_own_samples(cage, field)) : find_tissue(cage.mesh, field);
}

TetTissue find_tissue(const Cage& cage, const AnatomyField& anatomy) {
  return shared_among_slips(find_tissue(cage, tissue_field(anatomy)), anatomy);
}

std::vector<TetMaterial> tet_materials(const std::vector<TissueShares>& shares, const Materials& materials) {
  std::vector<TetMaterial> result;
  for (const TissueShares& share : shares) {
    const double lean = share.muscle + share.lean + share.bone;
    const auto mean = [&](double fat, double cavity, double muscle) {
      return share.fat * fat + share.cavity * cavity + lean * muscle;
    };
    result.push_back({mean(materials.fat.mu, materials.cavity.mu, materials.muscle.mu),
                      mean(materials.fat.lambda, materials.cavity.lambda, materials.muscle.lambda)});
  }
  return result;
}

}  // namespace bodyopt::trainer
