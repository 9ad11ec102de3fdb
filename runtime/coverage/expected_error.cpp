#include "runtime/coverage/expected_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "runtime/core/error.h"
#include "runtime/core/half.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

using Lanes = std::array<double, kBlockSize>;

// The squared error of Direct Delta Mush grows with the squared distance of the pose from rest. Beyond the centres it
// grows by this factor at most: measured on clips left out of a horse's and a fox's training.
constexpr double kMostBeyond = 2;

void add_squares(const BlendEntry& entry, Lanes& sums) {
  const double scale = double{half_low(entry.scale_coefficient)};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t lane = 0; lane < kBlockSize; ++lane) {
      const std::uint32_t word = entry.numbers[i * kLaneWords + lane / 4];
      sums[lane] += std::pow(scale * static_cast<std::int8_t>(word >> 8 * (lane % 4)), 2);
    }
  }
}

// Blended between centres by the inverse of the squared distance, squared: each centre's own value at the centre.
class Blend {
 public:
  void add(double squared_distance, double value) {
    const double weight = 1 / (squared_distance * squared_distance + 1e-12);
    sum_ += weight * value;
    weight_ += weight;
  }
  double value() const { return weight_ > 0 ? sum_ / weight_ : 0; }

 private:
  double sum_ = 0, weight_ = 0;
};

// Features that a region listens to, and those of the joints that move its skin. Of the latter some never moved in
// training, so that it could not listen to them.
std::vector<std::uint32_t> watched_features(const Basis& basis, std::size_t r) {
  const Region& region = basis.residual.regions[r];
  const auto first = basis.residual.region_features.begin() + region.feature_begin;
  std::set<std::uint32_t> watched(first, first + region.feature_count);
  const auto begin = basis.coverage.joints.begin() + basis.coverage.joint_begin[r],
             end = basis.coverage.joints.begin() + basis.coverage.joint_begin[r + 1];
  const std::vector<std::uint32_t> joints = feature_joints(basis.skeleton);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (std::find(begin, end, joints[j]) == end) continue;
    for (std::uint32_t k = 0; k < 9; ++k) watched.insert(9 * static_cast<std::uint32_t>(j) + k);
  }
  return {watched.begin(), watched.end()};
}

// The squared distance of the coordinates from centre `m` of the region.
double squared_distance(const Basis& basis, const Region& region, std::uint32_t m, std::span<const float> coordinates) {
  const std::vector<float>& metric = basis.coverage.metric;
  const std::uint32_t* centre =
      basis.residual.centres.data() + region.centre_values + m * ((region.coordinate_count + 1) / 2);
  double sum = 0;
  for (std::uint32_t k = 0; k < region.coordinate_count; ++k) {
    const std::size_t at = region.coordinate_begin + k;
    const double difference = double{coordinates[at]} - double{half_low(centre[k / 2] >> 16 * (k % 2))};
    sum += (metric.empty() ? 1 : double{metric[at]}) * difference * difference;
  }
  return sum;
}

// The squared distance of the coordinates from those of the rest pose, which are 0.
double squared_length(const Basis& basis, const Region& region, std::span<const float> coordinates) {
  const std::vector<float>& metric = basis.coverage.metric;
  double sum = 0;
  for (std::uint32_t k = 0; k < region.coordinate_count; ++k) {
    const std::size_t at = region.coordinate_begin + k;
    sum += (metric.empty() ? 1 : double{metric[at]}) * double{coordinates[at]} * double{coordinates[at]};
  }
  return sum;
}

}  // namespace

RegionShares::RegionShares(const Basis& basis) : vertex_count_(basis.mesh.vertex_count()) {
  const ResidualTable& residual = basis.residual;
  std::vector<double> sums(residual.regions.size());
  for (std::size_t block = 0; block + 1 < residual.blend_begin.size(); ++block) {
    std::map<std::uint32_t, Lanes> squares;  // by region
    for (std::uint32_t e = residual.blend_begin[block]; e < residual.blend_begin[block + 1]; ++e) {
      const BlendEntry& entry = residual.blend[e];
      add_squares(entry, squares[residual.coefficient_region[entry.scale_coefficient >> 16]]);
    }
    for (const auto& [region, lanes] : squares) {
      BlockShare& share = shares_.emplace_back(BlockShare{region, {}});
      for (std::size_t lane = 0; lane < kBlockSize; ++lane) {
        share.lanes[lane] = static_cast<float>(lanes[lane]);
        sums[region] += lanes[lane];
      }
    }
    begin_.push_back(shares_.size());
  }
  for (BlockShare& share : shares_) {
    const double sum = sums[share.region], size{basis.coverage.sizes[share.region]};
    for (float& lane : share.lanes) lane = sum > 0 ? static_cast<float>(double{lane} * size / sum) : 0;
  }
}

std::vector<float> RegionShares::carry(const std::vector<double>& region_mm, std::vector<float> metres) const {
  metres.assign(vertex_count_, 0.0f);
  for (std::size_t block = 0; block + 1 < begin_.size(); ++block) {
    Lanes squares{};
    for (std::size_t s = begin_[block]; s < begin_[block + 1]; ++s) {
      const double mm = region_mm[shares_[s].region];
      for (std::size_t lane = 0; lane < kBlockSize; ++lane) squares[lane] += mm * mm * double{shares_[s].lanes[lane]};
    }
    const std::size_t first = block * kBlockSize, count = std::min<std::size_t>(kBlockSize, vertex_count_ - first);
    for (std::size_t lane = 0; lane < count; ++lane) {
      metres[first + lane] = static_cast<float>(1e-3 * std::sqrt(squares[lane]));
    }
  }
  return metres;
}

ErrorExpectation::ErrorExpectation(const Basis& basis) : basis_(basis) {
  if (basis.coverage.empty()) {
    throw Error(ErrorKind::mismatch, "the basis does not say how well it covers poses: it was trained without shapes");
  }
  const std::vector<float> rest(basis.residual.coordinate_count());
  for (std::size_t r = 0; r < basis.residual.regions.size(); ++r) {
    const Region& region = basis.residual.regions[r];
    watched_.push_back(watched_features(basis, r));
    for (std::uint32_t m = 0; m < region.centre_count; ++m) {
      centre_lengths_.push_back(squared_distance(basis, region, m, rest));
    }
    if (region.centre_count == 0) centre_lengths_.push_back(0);
  }
}

ErrorExpectation::Energy ErrorExpectation::energy(std::size_t r, std::size_t first_centre,
                                                  const Measured& frame) const {
  const CoverageTable& coverage = basis_.coverage;
  const Region& region = basis_.residual.regions[r];
  const double size{coverage.sizes[r]};
  const auto squared = [&](const std::vector<float>& rms, std::size_t m) {
    return size * double{rms[first_centre + m]} * double{rms[first_centre + m]};
  };
  double outside = 0;
  for (const std::uint32_t f : watched_[r]) outside += double{frame.excess[f]} * double{frame.excess[f]};
  double nearest = std::numeric_limits<double>::infinity();
  Blend local, motion, length;
  for (std::uint32_t m = 0; m < std::max(1u, region.centre_count); ++m) {
    const double distance = region.centre_count > 0 ? squared_distance(basis_, region, m, frame.coordinates) : 0;
    nearest = std::min(nearest, distance);
    local.add(distance, squared(coverage.local, m));
    if (!coverage.motion.empty()) motion.add(distance, squared(coverage.motion, m));
    length.add(distance, centre_lengths_[first_centre + m]);
  }
  const double further =
      region.centre_count == 0 ? outside : std::max(0.0, nearest + outside - double{coverage.usual[r]});
  const double learned = local.value() + double{coverage.growth[r]} * further;
  if (coverage.motion.empty()) return {learned, 0};
  // Beyond the centres the skin moves more than around them.
  const double further_from_rest = squared_length(basis_, region, frame.coordinates) / std::max(length.value(), 1e-12);
  const double ddm = motion.value() * (length.value() > 0 ? std::clamp(further_from_rest, 1.0, kMostBeyond) : 1);
  const double fade{frame.fades[r]};
  return {fade * std::min(learned, ddm) + (1 - fade) * ddm, ddm};
}

ExpectedError ErrorExpectation::of(const Evaluation& evaluation, std::size_t k, ExpectedError errors) const {
  const auto of_frame = [&](const std::vector<float>& values, std::size_t count) {
    return std::span(values).subspan(k * count, count);
  };
  const ResidualTable& residual = basis_.residual;
  const Measured frame{of_frame(evaluation.excess, residual.feature_count()),
                       of_frame(evaluation.coordinates, residual.coordinate_count()),
                       of_frame(evaluation.fades, residual.regions.size())};
  errors.region_mm.clear();
  Energy sum;
  for (std::size_t r = 0, first_centre = 0; r < watched_.size(); ++r) {
    const Energy of_region = energy(r, first_centre, frame);
    sum.full += of_region.full;
    sum.ddm += of_region.ddm;
    errors.region_mm.push_back(1e3 * std::sqrt(of_region.full / double{basis_.coverage.sizes[r]}));
    first_centre += std::max(1u, residual.regions[r].centre_count);
  }
  errors.rms_mm = 1e3 * std::sqrt(sum.full / basis_.mesh.vertex_count());
  errors.ddm_rms_mm = 1e3 * std::sqrt(sum.ddm / basis_.mesh.vertex_count());
  return errors;
}

}  // namespace bodyopt
