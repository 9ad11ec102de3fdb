#include "trainer/transfer/transfer_columns.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/progress.h"
#include "runtime/core/half.h"
#include "runtime/core/transformed.h"
#include "runtime/cpu/kernels.h"
#include "runtime/host/rig.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt::trainer {
namespace {

using Column = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

// One column, V x 3, as the runtime reads it.
Column unpacked(const ResidualTable& residual, std::uint32_t coefficient, std::uint32_t vertices) {
  std::vector<float> coefficients(residual.coefficient_count(), 0.0f);
  coefficients[coefficient] = 1;
  Column column(vertices, 3);
  cpu::residual_blend(residual, coefficients, 1, 1, {column.data(), static_cast<std::size_t>(column.size())});
  return column;
}

BlockVectors lanes_of(const Column& column, std::uint32_t block) {
  BlockVectors vectors = BlockVectors::Zero();
  const Eigen::Index first = Eigen::Index{block} * kBlockSize,
                     count = std::min<Eigen::Index>(kBlockSize, column.rows() - first);
  vectors.leftCols(count) = column.middleRows(first, count).cast<double>().transpose();
  return vectors;
}

// A column in a block, and the energy that it has there: squared metres, summed over vertices.
struct BlockOfColumn {
  std::uint32_t coefficient, block;
  double energy;
};

// Sorts by rising energy, and gives how many of the least have no more than `allowed` together.
std::size_t least_worth(std::vector<BlockOfColumn>& entries, double allowed) {
  std::ranges::stable_sort(entries, {}, &BlockOfColumn::energy);
  std::size_t count = 0;
  for (double sum = 0; count < entries.size(); ++count) {
    sum += entries[count].energy;
    if (sum > allowed) break;
  }
  return count;
}

// Packs columns into the entries of every block, by coefficient.
class BlendPacker {
 public:
  BlendPacker(const std::vector<Column>& columns, const Eigen::VectorXd& sizes, std::uint32_t vertices,
              double tolerance)
      : columns_(columns),
        sizes_(sizes),
        allowed_(tolerance * tolerance * vertices),
        blocks_((vertices + kBlockSize - 1) / kBlockSize) {
    std::vector<BlockOfColumn> kept = worth_keeping(), rounding;
    for (const BlockOfColumn& entry : kept)
      rounding.push_back({entry.coefficient, entry.block, rounding_energy(entry)});
    const std::size_t coarse = least_worth(rounding, allowed_);
    for (std::size_t k = 0; k < rounding.size(); ++k) add(rounding[k], k >= coarse);
  }

  void write(ResidualTable& residual) {
    residual.blend.clear();
    residual.blend_begin = {0};
    for (std::vector<BlendEntry>& entries : blocks_) {
      std::ranges::stable_sort(entries, [](const BlendEntry& a, const BlendEntry& b) {
        return a.scale_coefficient >> 16 < b.scale_coefficient >> 16;
      });
      residual.blend.insert(residual.blend.end(), entries.begin(), entries.end());
      residual.blend_begin.push_back(static_cast<std::uint32_t>(residual.blend.size()));
    }
  }

 private:
  double size2(std::uint32_t coefficient) const { return std::pow(sizes_[coefficient], 2); }

  std::vector<BlockOfColumn> worth_keeping() const {
    std::vector<BlockOfColumn> all;
    for (std::uint32_t k = 0; k < columns_.size(); ++k) {
      for (std::uint32_t block = 0; block < blocks_.size(); ++block) {
        const double energy = size2(k) * lanes_of(columns_[k], block).squaredNorm();
        if (energy > 0) all.push_back({k, block, energy});
      }
    }
    all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(least_worth(all, allowed_)));
    return all;
  }

  double rounding_energy(const BlockOfColumn& entry) const {
    return size2(entry.coefficient) *
           pack_entry(lanes_of(columns_[entry.coefficient], entry.block), 0).left.squaredNorm();
  }

  void add(const BlockOfColumn& entry, bool fine) {
    const PackedEntry packed = pack_entry(lanes_of(columns_[entry.coefficient], entry.block), entry.coefficient);
    blocks_[entry.block].push_back(packed.entry);
    if (fine) blocks_[entry.block].push_back(pack_entry(packed.left, entry.coefficient).entry);
  }

  const std::vector<Column>& columns_;
  const Eigen::VectorXd& sizes_;
  const double allowed_;
  std::vector<std::vector<BlendEntry>> blocks_;
};

// Row k has the coordinates of the k-th centre of each region, over again where it has fewer. A region without centres
// has its coordinates at rest, each moved by 1, as much as its features do together.
std::vector<float> typical_coordinates(const ResidualTable& residual, const std::vector<float>& rest,
                                       std::uint32_t frames) {
  std::vector<float> coordinates(std::size_t{frames} * residual.coordinate_count());
  for (std::uint32_t m = 0; m < frames; ++m) {
    for (const Region& region : residual.regions) {
      for (std::uint32_t k = 0; k < region.coordinate_count; ++k) {
        const std::size_t place = region.coordinate_begin + k;
        float& value = coordinates[m * residual.coordinate_count() + place];
        if (region.centre_count == 0) {
          value = rest[place] + ((m >> (k % 8)) % 2 == 0 ? -1.0f : 1.0f);
          continue;
        }
        const std::size_t row = m % region.centre_count, words = (region.coordinate_count + 1) / 2;
        value = half_low(residual.centres[region.centre_values + row * words + k / 2] >> 16 * (k % 2));
      }
    }
  }
  return coordinates;
}

std::vector<float> coefficients_at(const ResidualTable& residual, const std::vector<float>& coordinates,
                                   const std::vector<float>& rest, std::uint32_t frames) {
  std::vector<float> kernels(std::size_t{frames} * residual.centre_count()),
      coefficients(std::size_t{frames} * residual.coefficient_count()),
      fades(std::size_t{frames} * residual.regions.size(), 1.0f);
  cpu::residual_kernels(residual, coordinates, frames, kernels);
  cpu::residual_coefficients(residual, coordinates, kernels, rest, fades, frames, coefficients);
  return coefficients;
}

// The nearest joint at or above `joint` that both have, of the target; -1 for none.
int target_at_or_above(const Skeleton& source, const SkeletonMatch& match, int joint) {
  joint = matched_at_or_above(source, match.target_joint, joint);
  return joint < 0 ? -1 : match.target_joint[static_cast<std::size_t>(joint)];
}

JointFeatures carried(const JointFeatures& of, const Skeleton& source, const Skeleton& target,
                      const SkeletonMatch& match) {
  const int own = match.target_joint[of.joint];
  const int top = target_at_or_above(source, match, static_cast<int>(of.above));
  const auto below = static_cast<std::uint32_t>(own), above = static_cast<std::uint32_t>(top);
  if (own < 0 || top < 0 || of.joint == of.above || common_joint(target, below, above) < 0) {  // it does not move
    const int at = target_at_or_above(source, match, static_cast<int>(of.joint));
    return {static_cast<std::uint32_t>(std::max(at, 0)), static_cast<std::uint32_t>(std::max(at, 0))};
  }
  return {below, above, of.above_turn * match.alignment[above], of.own_turn * match.alignment[below],
          of.per_metre / match.size};
}

// The size of each coefficient: root mean square of what it is away from rest, over the poses of the regions' kernel
// centres. coefficient_count.
Eigen::VectorXd coefficient_sizes(const ResidualTable& residual) {
  constexpr std::uint32_t kFrames = 256;
  // Nothing turned, no strain, no control.
  std::vector<float> features(residual.feature_count()), excess(residual.feature_count()),
      rest(residual.coordinate_count());
  const std::vector<float> none(residual.feature_count(), 0.0f);
  cpu::residual_features(residual.features, none, {}, {}, 1, features, excess);
  cpu::residual_project(residual, features, 1, rest);
  const std::vector<float> at_rest =
      coefficients_at(residual, rest, std::vector<float>(residual.coefficient_count(), 0.0f), 1);
  const std::vector<float> moved =
      coefficients_at(residual, typical_coordinates(residual, rest, kFrames), at_rest, kFrames);
  using Frames = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd values =
      Eigen::Map<const Frames>(moved.data(), kFrames, residual.coefficient_count()).cast<double>();
  return values.array().square().colwise().mean().sqrt().matrix().transpose();
}

}  // namespace

void transfer_columns(const SkinTransfer& transfer, std::uint32_t source_vertices, std::uint32_t vertices,
                      double tolerance, ResidualTable& residual) {
  const Eigen::VectorXd sizes = coefficient_sizes(residual);
  std::vector<Column> columns(residual.coefficient_count());
  Progress progress("transfer: columns", columns.size());
  parallel_for(columns.size(), [&](std::size_t k) {
    columns[k] =
        transfer(unpacked(residual, static_cast<std::uint32_t>(k), source_vertices).cast<double>()).cast<float>();
    progress.advance();
  });
  BlendPacker(columns, sizes, vertices, tolerance).write(residual);
}

std::vector<JointFeatures> carried_features(const Skeleton& source, const Skeleton& target,
                                            const SkeletonMatch& match) {
  const std::vector<JointFeatures> features = transformed(
      joint_features_of(source), [&](const JointFeatures& of) { return carried(of, source, target, match); });
  return features == joint_features_of(target) ? std::vector<JointFeatures>{} : features;
}

Pose pose_at_target_rest(const SkeletonMatch& match, const Skeleton& source) {
  Pose pose = bind_pose(source);
  const std::vector<Quat> bind = bind_rotations(source);
  std::vector<Quat> away(source.size());
  for (std::size_t j = 0; j < source.size(); ++j) {
    const int parent = source.joints[j].parent, other = match.target_joint[j];
    const Quat above = parent < 0 ? Quat{0, 0, 0, 1} : away[static_cast<std::size_t>(parent)];
    away[j] = other >= 0 ? conjugate(match.alignment[static_cast<std::size_t>(other)]) : above;
    const Quat world_above = parent < 0 ? above : above * bind[static_cast<std::size_t>(parent)];
    if (away[j] != above || parent < 0)
      pose.joints[j].rotation = normalized(conjugate(world_above) * away[j] * bind[j]);
  }
  return pose;
}

}  // namespace bodyopt::trainer
