#include "trainer/train/fit/choose_map.h"

#include <algorithm>
#include <limits>

#include "base/rows_where.h"
#include "trainer/train/regression/select_features.h"

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Features of a region at most, where there are kernels: more cost bytes and time and teach it next to nothing
// (measured from 60 to 200).
constexpr std::size_t kMostFeatures = 80, kMostFeaturesOfAll = 200;  // of a region that is the whole skin
// A region may do with all centres that it may have, a half or a quarter of them.
constexpr int kCentreFractions[] = {1, 2, 4};
// Kernels may leave so much of what a linear map leaves: bytes are not what they are chosen by.
constexpr double kWorthKernels = 1.05;
// Of few frames, strains of curves have to leave no more than so much of what joints alone leave: of many curves some
// look useful by chance. Muscles are there because they move the skin.
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

// By column.
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

// What features and coordinates that the other folds choose leave of every fold, square metres; with a quarter of the
// centres, which ranks choices as all of them do.
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

}  // namespace bodyopt
