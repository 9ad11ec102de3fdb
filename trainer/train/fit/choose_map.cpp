#include "trainer/train/fit/choose_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <string>

#include "base/linear_algebra.h"
#include "base/rows_where.h"
#include "base/spread_evenly.h"
#include "geometry/mesh.h"
#include "geometry/nearest_skin.h"
#include "geometry/surface_distance.h"
#include "trainer/train/regression/regress.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

// Parts of the character's longest extent: 20 cm and 5 cm of 1.8 m.
constexpr double kLength = 0.11, kApart = 0.028;

// The un-posed motion that a ridge-penalised linear map of all features leaves, mean over frames.
struct LeftMotion {
  Eigen::VectorXd left;  // V, square metres
  double moved = 0;      // of all vertices, with what the map explains
};

// Runs of frames are fitted and measured in turns.
LeftMotion left_by_linear_map(const SampleSet& set, const Groundwork& ground) {
  constexpr std::size_t kMostFrames = 800, kRun = 10;
  constexpr double kPenalty = 1e-2;
  const std::vector<std::size_t> frames = spread_evenly(set.train.size(), kMostFrames);
  const std::vector<std::uint32_t> all = all_vertices(ground.ordered.vertices.rows());
  const Displacements motion = ground.shapes("train: surface curves", frames, all).displacements;
  const Eigen::MatrixXd features =
      ground.features.values(frames, Eigen::all).rowwise() - Eigen::RowVectorXd(ground.features.rest);
  std::vector<Index> fitted, measured;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    (n / kRun % 2 == 0 || frames.size() <= kRun ? fitted : measured).push_back(static_cast<Index>(n));
  }
  if (measured.empty()) measured = fitted;
  const Eigen::MatrixXd x = features(fitted, Eigen::all);
  Eigen::MatrixXd normal = x.transpose() * x;
  normal.diagonal().array() += kPenalty * static_cast<double>(x.rows());
  const Eigen::MatrixXf prediction =
      (features(measured, Eigen::all) * Cholesky(normal).solve(x.transpose())).cast<float>();
  const Displacements left = motion(measured, Eigen::all) - prediction * motion(fitted, Eigen::all);
  const Eigen::RowVectorXd squares = left.cast<double>().colwise().squaredNorm() / static_cast<double>(left.rows());
  const Eigen::VectorXd per_vertex =
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(squares.data(), squares.size() / 3, 3)
          .rowwise()
          .sum();
  return {per_vertex, motion(measured, Eigen::all).cast<double>().squaredNorm() / static_cast<double>(left.rows())};
}

// The direction of the bone that begins at a joint, or ends there; zero for a joint alone.
Eigen::Vector3d bone_direction(const Skeleton& skeleton, std::uint32_t joint) {
  const auto place = [&](std::size_t j) { return Eigen::Vector3d(bind_place(skeleton, j).data()); };
  Eigen::Vector3d longest = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent != static_cast<int>(joint)) continue;
    const Eigen::Vector3d bone = place(j) - place(joint);
    if (bone.norm() > longest.norm()) longest = bone;
  }
  const int parent = skeleton.joints[joint].parent;
  if (longest.isZero() && parent >= 0) longest = place(joint) - place(static_cast<std::size_t>(parent));
  return longest;
}

class CurveMaker {
 public:
  // `character`: must outlive this.
  explicit CurveMaker(const Character& character)
      : character_(character),
        length_(kLength * longest_extent(character.vertices)),
        nearest_(character.vertices, character.triangles),
        normals_(vertex_normals(character.vertices, character.triangles)) {}

  Muscle along(Index vertex, const std::string& name) const { return curve(vertex, direction(vertex), name); }
  Muscle across(Index vertex, const std::string& name) const {
    return curve(vertex, normal(vertex).cross(direction(vertex)), name);
  }

 private:
  Eigen::Vector3d normal(Index vertex) const { return normals_.row(vertex).transpose().normalized(); }

  Eigen::Vector3d direction(Index vertex) const {
    const Eigen::Vector3d n = normal(vertex);
    const std::uint32_t joint = character_.weights[static_cast<std::size_t>(vertex)].front().joint;
    const Eigen::Vector3d bone = bone_direction(character_.skeleton, joint);
    const Eigen::Vector3d tangent = bone - bone.dot(n) * n;
    return tangent.norm() > 0.1 * bone.norm() ? tangent.normalized() : n.unitOrthogonal();
  }

  Muscle curve(Index vertex, const Eigen::Vector3d& direction, const std::string& name) const {
    std::vector<MusclePoint> path;
    const Eigen::Vector3d middle = character_.vertices.row(vertex).transpose();
    for (const double t : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
      const SkinPoint point = nearest_(middle + t * length_ * direction);
      Index corner = 0;
      point.weights.maxCoeff(&corner);
      const std::uint32_t joint = character_.weights[point.vertices[static_cast<std::size_t>(corner)]].front().joint;
      path.push_back({joint, {point.position.x(), point.position.y(), point.position.z()}});
    }
    return surface_curve(name, std::move(path));
  }

  const Character& character_;
  double length_;
  NearestSkin nearest_;
  Positions normals_;
};

using Eigen::MatrixXd;

// Features of a region at most, where there are kernels. More cost bytes and time and teach it next to nothing
// (measured from 60 to 200).
constexpr std::size_t kMostFeatures = 80, kMostFeaturesOfAll = 200;  // of a region that is the whole skin
// A region may do with all centres that it may have, a half or a quarter of them.
constexpr int kCentreFractions[] = {1, 2, 4};
// Kernels may leave so much of what a linear map leaves: bytes are not what they are chosen by.
constexpr double kWorthKernels = 1.05;
// Strains of curves may leave only so much of what joints alone leave, where frames are few. Of many curves some look
// useful by chance; muscles are there because they move the skin.
constexpr double kWorthCurves = 0.9;

std::size_t most_features(const Method& method) {
  if (!method.kernels) return std::numeric_limits<std::size_t>::max();
  return method.support == Method::Support::whole_skin ? kMostFeaturesOfAll : kMostFeatures;
}

int most_centres(const TrainOptions& options) { return options.method.kernels ? options.centres : 0; }

// Features that a map may have.
struct Candidates {
  const std::vector<std::uint32_t>& choice;
  MatrixXd values;              // N x choice, less their values at rest
  std::vector<Index> controls;  // those of the columns that are controls
};

Candidates candidates_of(const FeatureSamples& features, const std::vector<std::uint32_t>& choice) {
  const std::vector<Index> columns(choice.begin(), choice.end());
  Candidates result{
      choice, features.values(Eigen::all, columns).rowwise() - Eigen::RowVectorXd(features.rest(columns)), {}};
  const Index first_control = features.values.cols() - static_cast<Index>(features.control_count);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k] >= first_control) result.controls.push_back(static_cast<Index>(k));
  }
  return result;
}

std::vector<Index> columns_of(const std::vector<SelectedFeature>& selected) {
  std::vector<Index> columns;
  for (const SelectedFeature& feature : selected) columns.push_back(feature.column);
  return columns;
}

// The selected features, by column.
std::vector<SelectedFeature> selected_features(const Candidates& candidates, const MatrixXd& values,
                                               const MatrixXd& targets, std::size_t most) {
  std::vector<SelectedFeature> selected = select_features(values, targets, most, candidates.controls);
  std::ranges::sort(selected, {}, &SelectedFeature::column);
  return selected;
}

// The features that tell most of the motion, ascending, what each explains, and the coordinates among them.
void take_features(const Candidates& candidates, const MatrixXd& motion, std::size_t most, RegionModel& model) {
  const std::vector<SelectedFeature> selected = selected_features(candidates, candidates.values, motion, most);
  model.features.clear();
  model.explained.clear();
  for (const SelectedFeature& feature : selected) {
    model.features.push_back(candidates.choice[feature.column]);
    model.explained.push_back(feature.gain * motion.squaredNorm());
  }
  model.projection = projection(candidates.values(Eigen::all, columns_of(selected)), motion);
}

// The error of every fold with features and coordinates that the other folds choose, square metres. It is taken with a
// quarter of the centres, which ranks choices as all of them do.
double few_frames_error(const Candidates& candidates, const MatrixXd& motion, const MatrixXd& targets,
                        const std::vector<int>& folds, const Eigen::VectorXd& weights, std::size_t most, int centres) {
  const MatrixXd& values = candidates.values;
  double error = 0;
  const int last = *std::max_element(folds.begin(), folds.end());
  for (int fold = 0; fold <= last; ++fold) {
    const std::vector<Index> others = rows_where(folds, [&](int of) { return of >= 0 && of != fold; });
    const MatrixXd known = values(others, Eigen::all), moved = motion(others, Eigen::all);
    const std::vector<Index> columns = columns_of(selected_features(candidates, known, moved, most));
    const MatrixXd map = projection(known(Eigen::all, columns), moved);
    const RegressionData data{values(Eigen::all, columns) * map.transpose(), Eigen::RowVectorXd::Zero(map.rows()),
                              targets, weights, folds};
    error += fold_error(data, centres / 4, fold);
  }
  return error;
}

// The number of the choice that leaves least in cross-validation.
std::size_t best_choice(const FeatureSamples& features, const FeatureChoices& choices, const MatrixXd& motion,
                        const std::vector<int>& folds, const Eigen::VectorXd& weights, const TrainOptions& options,
                        RegionModel model) {
  const std::size_t most = most_features(options.method);
  const int centres = most_centres(options);
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < choices.size(); ++c) {
    const Candidates candidates = candidates_of(features, choices[c]);
    double error = 0;
    if (folds.size() <= kFewFrames) {
      error = few_frames_error(candidates, motion, model.components.coefficients, folds, weights, most, centres);
    } else {
      take_features(candidates, motion, most, model);
      error = trial_error(regression_data(features, model, folds, weights), centres);
    }
    if (!(error < least)) continue;
    least = error;
    best = c;
  }
  return best;
}

// The map of the best of some choices.
void fit_best_choice(const FeatureSamples& features, const FeatureChoices& choices, const MatrixXd& motion,
                     const std::vector<int>& folds, const Eigen::VectorXd& weights, const TrainOptions& options,
                     RegionModel& model) {
  const FeatureChoices::value_type& best =
      choices[best_choice(features, choices, motion, folds, weights, options, model)];
  take_features(candidates_of(features, best), motion, most_features(options.method), model);
  const RegressionData data = regression_data(features, model, folds, weights);
  const int centres = most_centres(options);
  const Regression linear = fit_regression(data, 0);
  model.fits.clear();
  for (const int fraction : kCentreFractions) {
    if (centres > 0) model.fits.push_back(fit_regression(data, centres / fraction));
  }
  const bool kernels = centres > 0 && model.fits.front().validation_error < kWorthKernels * linear.validation_error;
  if (!kernels) model.fits = {linear};
}

bool has_strains(const std::vector<std::uint32_t>& choice, const StrainFeatures& strains) {
  return std::any_of(choice.begin(), choice.end(), [&](std::uint32_t feature) {
    return feature >= strains.first && feature < strains.first + strains.count;
  });
}

double least_error(const RegionModel& model) {
  return std::ranges::min_element(model.fits, {}, &Regression::validation_error)->validation_error;
}

}  // namespace

std::vector<Muscle> surface_curves(const SampleSet& set, const TrainOptions& options) {
  check_samples(set);
  const Groundwork ground(set, options);
  const Character& character = ground.ordered;
  const double apart = kApart * longest_extent(character.vertices);
  Eigen::VectorXd left =
      smoothed(character.vertices, character.triangles, left_by_linear_map(set, ground).left, 0.5 * apart);
  const double least = 1e-3 * left.maxCoeff();
  const CurveMaker maker(character);
  std::vector<Muscle> curves;
  for (int k = 1; k <= options.surface_curves; ++k) {
    Index worst = 0;
    if (!(left.maxCoeff(&worst) > least)) break;
    const std::string name = "surface " + std::to_string(k);
    curves.push_back(maker.along(worst, name + " along"));
    curves.push_back(maker.across(worst, name + " across"));
    const Positions away = character.vertices.rowwise() - character.vertices.row(worst);
    left.array() *= 1 - (away.rowwise().squaredNorm().array() / (-2 * apart * apart)).exp();
  }
  return curves;
}

int needed_surface_curves(const SampleSet& set, const TrainOptions& options) {
  constexpr std::size_t kFewest = 80;
  constexpr int kPairs = 40;
  constexpr double kLeft = 1.0 / 3, kNoMotion = 1e-4;  // the latter of the longest extent; less is no motion
  if (!set.muscles.empty() || set.train.size() < kFewest || set.train.size() > kFewFrames) return 0;
  check_samples(set);
  const Groundwork ground(set, options);
  const LeftMotion motion = left_by_linear_map(set, ground);
  const double still = kNoMotion * longest_extent(ground.ordered.vertices);
  if (motion.moved < still * still * static_cast<double>(motion.left.size())) return 0;
  return motion.left.sum() > kLeft * kLeft * motion.moved ? kPairs : 0;
}

void choose_map(const FeatureSamples& features, const StrainFeatures& strains, const FeatureChoices& choices,
                const MatrixXd& motion, const std::vector<int>& folds, const Eigen::VectorXd& weights,
                const TrainOptions& options, RegionModel& model) {
  FeatureChoices with, without;
  for (const std::vector<std::uint32_t>& choice : choices) {
    (has_strains(choice, strains) ? with : without).push_back(choice);
  }
  if (folds.size() > kFewFrames || with.empty() || without.empty()) {
    return fit_best_choice(features, choices, motion, folds, weights, options, model);
  }
  RegionModel simpler = model;
  fit_best_choice(features, without, motion, folds, weights, options, simpler);
  fit_best_choice(features, with, motion, folds, weights, options, model);
  const double most = (strains.of_curves ? kWorthCurves : 1) * least_error(simpler);
  if (!(least_error(model) < most)) model = std::move(simpler);
}

void refit_map(const FeatureSamples& features, const std::vector<int>& folds, const Eigen::VectorXd& weights,
               const TrainOptions& options, RegionModel& model) {
  const RegressionData data = regression_data(features, model, folds, weights);
  for (std::size_t f = 0; f < model.fits.size(); ++f) {
    const bool kernels = model.fits[f].centres.rows() > 0;
    const int centres = kernels ? most_centres(options) / kCentreFractions[f] : 0;
    model.fits[f] = refit_regression(data, centres, model.fits[f]);
  }
}

}  // namespace bodyopt::trainer
