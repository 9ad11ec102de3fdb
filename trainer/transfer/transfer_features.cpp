#include "trainer/transfer/transfer_features.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "runtime/core/half.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Halves, two a word, every row from a whole word on.
Rows read_halves(const std::vector<std::uint32_t>& words, std::size_t first, std::uint32_t rows,
                 std::uint32_t columns) {
  Rows result(rows, columns);
  for (std::uint32_t r = 0; r < rows; ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      const std::size_t word = first + std::size_t{r} * ((columns + 1) / 2) + c / 2;
      result(r, c) = double{half_low(words[word] >> 16 * (c % 2))};
    }
  }
  return result;
}

// Values whose half would be subnormal are 0, as everywhere in the tables.
std::uint32_t stored_half_bits(double value) {
  const std::uint32_t half = half_from_float(static_cast<float>(value));
  return (half & 0x7fffu) < kSmallestNormalHalf ? 0u : half;
}

void append_halves(const Rows& rows, std::vector<std::uint32_t>& words) {
  for (Eigen::Index r = 0; r < rows.rows(); ++r) {
    for (Eigen::Index c = 0; c < rows.cols(); c += 2) {
      const std::uint32_t low = stored_half_bits(rows(r, c)),
                          high = c + 1 < rows.cols() ? stored_half_bits(rows(r, c + 1)) : 0u;
      words.push_back(low | high << 16);
    }
  }
}

// Ranges of the target's features, from those of the source by their formulas turned round.
class RangeWriter {
 public:
  RangeWriter(const std::vector<FeatureFormula>& formulas, const std::vector<FeatureRange>& ranges, std::size_t count)
      : formulas_(formulas), ranges_(ranges), result_(count, FeatureRange{0, 0, 0, 0}) {}

  std::vector<FeatureRange> ranges(std::size_t joint_features) {
    for (std::size_t f = 0; f < formulas_.size(); ++f) {
      if (f < joint_features && f % 9 == 0 && !is_renamed(f)) {
        turn_back(f);
        f += 8;
      } else if (f >= joint_features || is_renamed(f / 9 * 9)) {
        scale_back(f);
      }
    }
    return std::move(result_);
  }

 private:
  bool is_renamed(std::size_t first) const {
    return std::all_of(formulas_.begin() + static_cast<std::ptrdiff_t>(first),
                       formulas_.begin() + static_cast<std::ptrdiff_t>(first) + 9,
                       [](const FeatureFormula& formula) { return formula.is_renamed(); });
  }

  // x = (y - constant) / factor.
  void scale_back(std::size_t f) {
    if (formulas_[f].terms.size() != 1) return;
    const auto& [feature, factor] = formulas_[f].terms[0];
    const auto back = [&](float y) { return static_cast<float>((double{y} - formulas_[f].constant) / factor); };
    const FeatureRange& range = ranges_[f];
    result_[feature] = {back(range.low), back(range.high), back(range.mean),
                        static_cast<float>(double{range.inverse_scale} * factor)};
  }

  // The nine of one joint: y = A x + constant with A orthogonal. All nine of the result are in units of the finest.
  void turn_back(std::size_t first) {
    std::map<std::uint32_t, std::vector<double>> columns;  // of A, by the target's feature
    for (std::size_t i = 0; i < 9; ++i) {
      for (const auto& [feature, factor] : formulas_[first + i].terms) {
        columns[feature].resize(9);
        columns[feature][i] = factor;
      }
    }
    float finest = 0;
    for (std::size_t i = 0; i < 9; ++i) finest = std::max(finest, ranges_[first + i].inverse_scale);
    for (const auto& [feature, column] : columns) {
      double low = 0, high = 0, mean = 0;
      for (std::size_t i = 0; i < 9; ++i) {
        const FeatureRange& range = ranges_[first + i];
        const double constant = formulas_[first + i].constant;
        const double a = column[i] * (double{range.low} - constant), b = column[i] * (double{range.high} - constant);
        low += std::min(a, b);
        high += std::max(a, b);
        mean += column[i] * (double{range.mean} - constant);
      }
      result_[feature] = {static_cast<float>(std::min(low, 0.0)), static_cast<float>(std::max(high, 0.0)),
                          static_cast<float>(mean), finest};
    }
  }

  const std::vector<FeatureFormula>& formulas_;
  const std::vector<FeatureRange>& ranges_;
  std::vector<FeatureRange> result_;
};

class RegionRewriter {
 public:
  RegionRewriter(const std::vector<FeatureFormula>& formulas, const ResidualTable& before, ResidualTable& after)
      : formulas_(formulas), before_(before), after_(after) {}

  void rewrite(Region region) {
    const auto first = before_.region_features.begin() + region.feature_begin;
    const std::vector<std::uint32_t> features(first, first + region.feature_count);
    const Rows projection =
        read_halves(before_.projections, region.projection_values, region.coordinate_count, region.feature_count);
    Rows centres = read_halves(before_.centres, region.centre_values, region.centre_count, region.coordinate_count);
    region.feature_begin = count(after_.region_features);
    region.projection_values = count(after_.projections);
    region.centre_values = count(after_.centres);
    const bool renamed =
        std::all_of(features.begin(), features.end(), [&](std::uint32_t f) { return formulas_[f].is_renamed(); });
    if (renamed) {
      for (const std::uint32_t f : features) after_.region_features.push_back(formulas_[f].terms[0].feature);
      append_halves(projection, after_.projections);
    } else {
      const Eigen::VectorXd shift = rewrite_projection(features, projection, region);
      centres.rowwise() -= shift.transpose();
      move_constants(region, shift);
    }
    append_halves(centres, after_.centres);
    after_.regions.push_back(region);
  }

 private:
  static std::uint32_t count(const std::vector<std::uint32_t>& values) {
    return static_cast<std::uint32_t>(values.size());
  }

  // -> what the new coordinates lack of the old ones.
  Eigen::VectorXd rewrite_projection(const std::vector<std::uint32_t>& features, const Rows& projection,
                                     Region& region) {
    std::map<std::uint32_t, Eigen::VectorXd> columns;  // by the target's feature
    Eigen::VectorXd shift = Eigen::VectorXd::Zero(projection.rows());
    for (std::size_t k = 0; k < features.size(); ++k) {
      const FeatureFormula& formula = formulas_[features[k]];
      const FeatureRange& range = before_.features[features[k]];
      const Eigen::VectorXd column = projection.col(static_cast<Eigen::Index>(k)) * double{range.inverse_scale};
      double constant = std::clamp(formula.constant, double{range.low}, double{range.high});
      if (!formula.terms.empty()) constant = formula.constant;
      for (const auto& [feature, factor] : formula.terms) {
        const FeatureRange& own = after_.features[feature];
        constant += factor * double{own.mean};
        if (own.inverse_scale == 0) continue;
        Eigen::VectorXd& sum = columns.try_emplace(feature, Eigen::VectorXd::Zero(projection.rows())).first->second;
        sum += factor / double{own.inverse_scale} * column;
      }
      shift += (constant - double{range.mean}) * column;
    }
    if (columns.empty()) columns.emplace(0, Eigen::VectorXd::Zero(projection.rows()));
    Rows rows(projection.rows(), static_cast<Eigen::Index>(columns.size()));
    for (Eigen::Index k = 0; const auto& [feature, column] : columns) {
      after_.region_features.push_back(feature);
      rows.col(k++) = column;
    }
    region.feature_count = static_cast<std::uint32_t>(columns.size());
    append_halves(rows, after_.projections);
    return shift;
  }

  // What the linear part makes of the shift.
  void move_constants(const Region& region, const Eigen::VectorXd& shift) {
    const std::size_t row = 1 + std::size_t{region.coordinate_count} + region.centre_count;
    for (std::uint32_t c = 0; c < region.coefficient_count; ++c) {
      float* weights = after_.weights.data() + region.weight_values + c * row;
      double sum{weights[0]};
      for (std::uint32_t k = 0; k < region.coordinate_count; ++k) sum += double{weights[1 + k]} * shift[k];
      weights[0] = static_cast<float>(sum);
    }
  }

  const std::vector<FeatureFormula>& formulas_;
  const ResidualTable& before_;
  ResidualTable& after_;
};

// Feature joints of the target by those of the source, each turned into nine rows of the formulas; empty where the fade
// cannot be told so.
class FadeWriter {
 public:
  FadeWriter(const std::vector<FeatureFormula>& formulas, const Skeleton& source, const Skeleton& target,
             const SkeletonMatch& match, const FadeTable& before)
      : formulas_(formulas), before_(before), target_joints_(feature_joints(target)) {
    const std::vector<std::uint32_t> joints = feature_joints(source);
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const int other = match.target_joint[joints[k]];
      const auto found = std::find(target_joints_.begin(), target_joints_.end(), static_cast<std::uint32_t>(other));
      place_.push_back(other < 0 || found == target_joints_.end() ? -1
                                                                  : static_cast<int>(found - target_joints_.begin()));
    }
  }

  // Every joint feature is a turn of those of one joint.
  bool is_possible() const {
    for (std::size_t f = 0; f < 9 * place_.size(); ++f) {
      const FeatureFormula& formula = formulas_[f];
      if (formula.constant != 0) return false;
      for (const auto& term : formula.terms) {
        if (static_cast<int>(term.feature / 9) != place_[f / 9]) return false;
      }
    }
    return true;
  }

  FadeTable write() const {
    FadeTable after;
    std::vector<int> source_of(target_joints_.size(), -1);
    for (std::size_t k = 0; k < place_.size(); ++k) {
      if (place_[k] >= 0) source_of[static_cast<std::size_t>(place_[k])] = static_cast<int>(k);
    }
    after.joint_begin = {0};
    after.direction_begin = {0};
    for (const int source : source_of) {
      if (source >= 0) add_joint(static_cast<std::size_t>(source), after);
      after.tolerance.push_back(source >= 0 ? before_.tolerance[static_cast<std::size_t>(source)] : 0.0f);
      after.joint_begin.push_back(static_cast<std::uint32_t>(after.joints.size()));
      after.direction_begin.push_back(after.direction_begin.back());
      if (source >= 0) after.direction_begin.back() += rows_of_joint(static_cast<std::size_t>(source));
    }
    add_regions(after);
    return after;
  }

 private:
  std::uint32_t rows_of_joint(std::size_t j) const {
    return before_.direction_begin[j + 1] - before_.direction_begin[j];
  }

  std::size_t first_direction(std::size_t j) const {
    std::size_t first = 0;
    for (std::size_t k = 0; k < j; ++k) {
      first += std::size_t{rows_of_joint(k)} * 9 * (before_.joint_begin[k + 1] - before_.joint_begin[k]);
    }
    return first;
  }

  // D x = (D A) x' with x = A x'.
  void add_joint(std::size_t j, FadeTable& after) const {
    const std::size_t begin = before_.joint_begin[j], end = before_.joint_begin[j + 1];
    for (std::size_t k = begin; k < end; ++k) {
      const int place = place_[before_.joints[k]];
      if (place >= 0) after.joints.push_back(static_cast<std::uint32_t>(place));
    }
    const float* row = before_.directions.data() + first_direction(j);
    for (std::uint32_t r = 0; r < rows_of_joint(j); ++r, row += 9 * (end - begin)) {
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t joint = before_.joints[k];
        if (place_[joint] < 0) continue;
        double turned[9] = {};
        for (std::size_t i = 0; i < 9; ++i) {
          for (const auto& [feature, factor] : formulas_[9 * joint + i].terms) {
            turned[feature % 9] += factor * double{row[9 * (k - begin) + i]};
          }
        }
        for (const double value : turned) after.directions.push_back(static_cast<float>(value));
      }
    }
  }

  void add_regions(FadeTable& after) const {
    after.region_begin = {0};
    for (std::size_t r = 0; r + 1 < before_.region_begin.size(); ++r) {
      std::map<std::uint32_t, float> weights;
      for (std::uint32_t k = before_.region_begin[r]; k < before_.region_begin[r + 1]; ++k) {
        const int place = place_[before_.region_joints[k]];
        if (place >= 0) weights[static_cast<std::uint32_t>(place)] = before_.region_weights[k];
      }
      for (const auto& [joint, weight] : weights) {
        after.region_joints.push_back(joint);
        after.region_weights.push_back(weight);
      }
      after.region_begin.push_back(static_cast<std::uint32_t>(after.region_joints.size()));
    }
  }

  const std::vector<FeatureFormula>& formulas_;
  const FadeTable& before_;
  std::vector<std::uint32_t> target_joints_;
  std::vector<int> place_;  // per feature joint of the source: that of the target, or -1
};

}  // namespace

void transfer_features(const std::vector<FeatureFormula>& formulas, const Skeleton& source, const Skeleton& target,
                       const SkeletonMatch& match, ResidualTable& residual, std::vector<std::string>& notes) {
  if (residual.regions.empty()) return;
  const ResidualTable before = residual;
  const std::size_t count = joint_feature_count(target) + before.features.size() - joint_feature_count(source);
  residual.features = RangeWriter(formulas, before.features, count).ranges(joint_feature_count(source));
  residual.regions.clear();
  residual.region_features.clear();
  residual.projections.clear();
  residual.centres.clear();
  RegionRewriter rewriter(formulas, before, residual);
  for (const Region& region : before.regions) rewriter.rewrite(region);
  if (before.fade.empty()) return;
  residual.fade = {};
  const FadeWriter fade(formulas, source, target, match, before.fade);
  if (fade.is_possible()) {
    residual.fade = fade.write();
  } else {
    notes.push_back(
        "The skeletons rest or are built too differently for the fade away from trained poses: nothing of "
        "what was learned fades on the target.");
  }
}

}  // namespace bodyopt
