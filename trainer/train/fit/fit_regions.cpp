#include "trainer/train/fit/fit_regions.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <set>

#include "base/parallel.h"
#include "base/progress.h"
#include "base/spread_evenly.h"
#include "geometry/mesh.h"
#include "runtime/host/rig.h"
#include "trainer/train/fit/choose_map.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

// Cross-validation: blocks of consecutive frames, dealt to folds.
constexpr int kFolds = 5, kLongestRun = 20;
// Components that coordinates are chosen by where frames are few. With as many as the map gives (32) there were too few
// coordinates for the poses of a range of motion.
constexpr int kMotionOfFewFrames = 128;

// Some of the regions and all vertices of theirs and beside them, ascending.
struct SkinPart {
  std::vector<std::size_t> regions;
  std::vector<std::uint32_t> vertices;
};

// Returns as few parts as leave half the memory free while the displacements of one are in it.
std::vector<SkinPart> parts_that_fit(const FitContext& context, const std::vector<std::size_t>& regions,
                                     std::size_t frames) {
  const double bytes = 3 * sizeof(float) * static_cast<double>(frames);
  const double most = 0.5 * context.options.memory_gib * 0x1p30 / bytes;
  std::vector<SkinPart> parts;
  for (const std::size_t r : regions) {
    const std::vector<std::uint32_t> vertices =
        context.ground.shapes.with_neighbours(context.layout.regions[r].vertices);
    std::vector<std::uint32_t> with_last;
    if (!parts.empty()) {
      const std::vector<std::uint32_t>& last = parts.back().vertices;
      std::set_union(last.begin(), last.end(), vertices.begin(), vertices.end(), std::back_inserter(with_last));
    }
    if (parts.empty() || static_cast<double>(with_last.size()) > most) {
      parts.push_back({{r}, vertices});
    } else {
      parts.back().regions.push_back(r);
      parts.back().vertices = std::move(with_last);
    }
  }
  return parts;
}

// The region with its vertices numbered as in the part.
RegionWeights within(const SkinPart& part, RegionWeights region) {
  for (std::uint32_t& vertex : region.vertices) {
    const auto place = std::lower_bound(part.vertices.begin(), part.vertices.end(), vertex);
    vertex = static_cast<std::uint32_t>(place - part.vertices.begin());
  }
  return region;
}

// A part's frames in un-posed space, and what is said of each region in them.
class PartFrames {
 public:
  PartFrames(const FitContext& context, const SkinPart& part, const std::string& title,
             const std::vector<std::size_t>& frames)
      : context_(context),
        part_(part),
        frames_(frames),
        unposed_(context.ground.shapes(title, frames, part.vertices)) {}

  const Displacements& displacements() const { return unposed_.displacements; }
  RegionWeights region(std::size_t r) const { return within(part_, context_.layout.regions[r]); }

  std::vector<OutlierVertex> outliers(std::size_t r) const {
    const std::vector<std::uint32_t>& own = context_.layout.regions[r].vertices;
    std::vector<OutlierVertex> outliers;
    std::copy_if(unposed_.outliers.begin(), unposed_.outliers.end(), std::back_inserter(outliers),
                 [&](const OutlierVertex& s) { return std::binary_search(own.begin(), own.end(), s.vertex); });
    return outliers;
  }

  // Returns contradictions among pairs whose frames are among these.
  std::vector<Contradiction> contradictions_of(std::size_t r, const std::vector<FramePair>& pairs,
                                               const Components& components) const {
    const auto row = [&](std::size_t frame) {
      return static_cast<std::size_t>(std::lower_bound(frames_.begin(), frames_.end(), frame) - frames_.begin());
    };
    std::vector<FramePair> rows;
    for (const FramePair& pair : pairs) rows.push_back({row(pair.first), row(pair.second)});
    const RegionWeights own = region(r);
    const double size = std::accumulate(own.weights.begin(), own.weights.end(), 0.0);
    std::vector<Contradiction> found =
        contradictions(rows, displacements(), own, longest_extent(context_.ground.ordered.vertices),
                       std::sqrt(components.energy.mean() / size));
    for (Contradiction& c : found) c.frames = {frames_[c.frames.first], frames_[c.frames.second]};
    return found;
  }

 private:
  const FitContext& context_;
  const SkinPart& part_;
  const std::vector<std::size_t>& frames_;
  UnposedFrames unposed_;
};

// A column of the basis divided by what its coefficients are multiplied with.
void scale_column(RegionModel& model, Index k, double factor) {
  model.components.basis.row(k) /= factor;
  model.components.coefficients.col(k) *= factor;
  for (Regression& fit : model.fits) {
    fit.weights.col(k) *= factor;
    fit.errors.col(k) *= factor;
  }
}

// Basis columns with a largest entry of 1 suit the scales of the blend table, which are halves; the coefficients keep
// the metres.
void normalise(RegionModel& model) {
  for (Index k = 0; k < model.components.basis.rows(); ++k) {
    const double largest = model.components.basis.row(k).cwiseAbs().maxCoeff();
    if (largest > 0) scale_column(model, k, largest);
  }
}

// Chooses features and regression before the columns are scaled. Until then the error of a coefficient is the error of
// positions, weighted by the region.
RegionModel fit_region(const FitContext& context, std::size_t r, const PartFrames& frames) {
  const TrainOptions& options = context.options;
  const FeatureSamples& features = context.ground.features;
  RegionModel model;
  model.region = context.layout.regions[r];
  const auto components = [&](int count) {
    return principal_components(frames.displacements(), frames.region(r), count, options.seed);
  };
  model.components = components(options.components);
  model.outliers = frames.outliers(r);
  model.contradictions = frames.contradictions_of(r, context.pairs, model.components);
  const Basis& basis = context.ground.base.basis;
  const StrainFeatures strains{joint_feature_count(basis.skeleton), basis.strain.fibre_count(),
                               context.ground.curve_count == context.ground.muscles.size()};
  const bool asks_for_more = context.folds.size() <= kFewFrames && options.components < kMotionOfFewFrames;
  const Eigen::MatrixXd motion =
      asks_for_more ? components(kMotionOfFewFrames).coefficients : model.components.coefficients;
  choose_map(features, strains, context.layout.choices[r], motion, context.folds, context.weights, options, model);
  normalise(model);
  return model;
}

std::string part_name(std::size_t part, std::size_t count) {
  return count > 1 ? ", part " + std::to_string(part + 1) + " of " + std::to_string(count) : "";
}

// Maps the frames of an earlier training to those of now, and knows which are new.
class FrameMap {
 public:
  FrameMap(const std::vector<int>& earlier, std::size_t earlier_count)
      : earlier_(earlier), earlier_count_(earlier_count) {
    for (std::size_t n = 0; n < earlier.size(); ++n) {
      if (earlier[n] < 0) continue;
      now_[static_cast<std::size_t>(earlier[n])] = n;
    }
  }

  bool is_new(std::size_t frame) const { return earlier_[frame] < 0; }
  // Pairs of earlier frames were looked at then. Without the first frame of its pose another pair is made of the rest.
  bool is_new(const FramePair& pair) const { return lost_some() || is_new(pair.first) || is_new(pair.second); }

  // Returns outliers of frames that are still there, as these are numbered now.
  std::vector<OutlierVertex> carried(const std::vector<OutlierVertex>& outliers) const {
    std::vector<OutlierVertex> carried;
    for (const OutlierVertex& outlier : outliers) {
      const auto frame = now_.find(outlier.frame);
      if (frame != now_.end()) carried.push_back({frame->second, outlier.vertex, outlier.distance});
    }
    return carried;
  }
  std::vector<Contradiction> carried(const std::vector<Contradiction>& contradictions) const {
    std::vector<Contradiction> carried;
    if (lost_some()) return carried;
    for (const Contradiction& c : contradictions) {
      const auto first = now_.find(c.frames.first), second = now_.find(c.frames.second);
      if (first == now_.end() || second == now_.end()) continue;
      carried.push_back({{first->second, second->second}, c.distance, c.region});
    }
    return carried;
  }

 private:
  bool lost_some() const { return now_.size() < earlier_count_; }

  const std::vector<int>& earlier_;
  std::size_t earlier_count_;
  std::map<std::size_t, std::size_t> now_;
};

// The new frames, those that have the pose of one, and some more, for what is usual of a vertex.
std::vector<std::size_t> frames_to_unpose(const FrameMap& map, const std::vector<FramePair>& pairs, std::size_t count) {
  constexpr std::size_t kUsual = 64;
  const std::vector<std::size_t> some = spread_evenly(count, kUsual);
  std::set<std::size_t> frames(some.begin(), some.end());
  for (std::size_t n = 0; n < count; ++n) {
    if (map.is_new(n)) frames.insert(n);
  }
  for (const FramePair& pair : pairs) {
    if (map.is_new(pair)) frames.insert({pair.first, pair.second});
  }
  return {frames.begin(), frames.end()};
}

// Coefficients and energies of all frames: those that the earlier training knew from it, the others from shapes.
Components extended(const Components& earlier, const Components& fresh, const std::vector<std::size_t>& frames,
                    const std::vector<int>& earlier_frames) {
  const auto count = static_cast<Index>(earlier_frames.size());
  Components all;
  all.basis = earlier.basis;
  all.coefficients.resize(count, earlier.coefficients.cols());
  all.energy.resize(count);
  all.truncated.resize(count);
  const auto put = [&](Index to, const Components& from, Index row) {
    all.coefficients.row(to) = from.coefficients.row(row);
    all.energy[to] = from.energy[row];
    all.truncated[to] = from.truncated[row];
  };
  for (Index n = 0; n < count; ++n) {
    const int row = earlier_frames[static_cast<std::size_t>(n)];
    if (row >= 0) put(n, earlier, row);
  }
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (earlier_frames[frames[k]] < 0) put(static_cast<Index>(frames[k]), fresh, static_cast<Index>(k));
  }
  return all;
}

// Do the components leave less of the new frames than twice what the fit left of the frames it knew?
bool components_hold(const RegionModel& earlier, const Components& all, const FrameMap& map) {
  double left = 0, frames = 0;
  for (Index n = 0; n < all.truncated.size(); ++n) {
    if (!map.is_new(static_cast<std::size_t>(n))) continue;
    left += all.truncated[n];
    ++frames;
  }
  const double usual = earlier.components.truncated.mean() + std::pow(earlier.fits.front().validation_error, 2);
  return left <= 2 * frames * usual;
}

// Was what was chosen by cross-validation chosen for data like these?
bool hyper_parameters_hold(const RegionModel& earlier, const RegionModel& now) {
  constexpr double kMostChange = 0.1;
  const double before = earlier.fits.front().validation_error, after = now.fits.front().validation_error;
  return std::abs(after - before) <= kMostChange * before;
}

RegionModel updated(const FitContext& context, RegionModel model, Components all) {
  model.components = std::move(all);
  const Eigen::VectorXd lengths = component_lengths(model.components, model.region);
  for (Index k = 0; k < lengths.size(); ++k) scale_column(model, k, lengths[k]);
  refit_map(context.ground.features, context.folds, context.weights, context.options, model);
  normalise(model);
  return model;
}

// Keeps the problems of frames that are still there, and adds those of new ones.
void carry_data_problems(const PartFrames& unposed, std::size_t region, const std::vector<FramePair>& new_pairs,
                         const FrameMap& map, RegionModel& model) {
  model.outliers = map.carried(model.outliers);
  for (const OutlierVertex& outlier : unposed.outliers(region)) {
    if (map.is_new(outlier.frame)) model.outliers.push_back(outlier);
  }
  model.contradictions = map.carried(model.contradictions);
  const std::vector<Contradiction> found = unposed.contradictions_of(region, new_pairs, model.components);
  model.contradictions.insert(model.contradictions.end(), found.begin(), found.end());
}

}  // namespace

FitContext::FitContext(const SampleSet& set, const Groundwork& groundwork, const Layout& regions,
                       const TrainOptions& train_options)
    : ground(groundwork),
      layout(regions),
      options(train_options),
      folds(training_folds(set)),
      weights(training_weights(set)),
      pairs(frames_of_one_pose(ground.features.values)) {}

Eigen::VectorXd training_weights(const SampleSet& set) {
  Eigen::VectorXd weights(static_cast<Index>(set.train.size()));
  for (std::size_t n = 0; n < set.train.size(); ++n) weights[static_cast<Index>(n)] = set.train[n].weight;
  return weights;
}

std::vector<int> training_folds(const SampleSet& set) {
  const std::vector<std::size_t> origins = training_origins(set);
  std::vector<int> takes;
  for (std::size_t n = 0; n < origins.size(); ++n) {
    if (origins[n] == n) takes.push_back(set.train[n].take);
  }
  const std::vector<int> of_origins = blocked_folds(takes, kLongestRun, kFolds);
  std::vector<int> folds;
  for (std::size_t n = 0, next = 0; n < origins.size(); ++n) {
    folds.push_back(origins[n] == n ? of_origins[next++] : folds[origins[n]]);
  }
  return folds;
}

void fit_regions(const FitContext& context, const std::vector<std::size_t>& regions, std::vector<RegionModel>& models,
                 const RegionDone& done, const std::string& kept) {
  const std::vector<std::size_t> frames = spread_evenly(context.folds.size(), context.folds.size());
  const std::vector<SkinPart> parts = parts_that_fit(context, regions, frames.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const SkinPart& part = parts[p];
    const PartFrames unposed(context, part, "train: un-posing" + part_name(p, parts.size()), frames);
    Progress progress("train: regions" + part_name(p, parts.size()), part.regions.size(), kept);
    parallel_for(part.regions.size(), [&](std::size_t k) {
      const std::size_t r = part.regions[k];
      models[r] = fit_region(context, r, unposed);
      done(r, models[r]);
      progress.advance();
    });
  }
}

std::vector<std::size_t> update_regions(const FitContext& context, const std::vector<int>& earlier,
                                        const std::vector<std::size_t>& regions, std::vector<RegionModel>& models,
                                        const RegionDone& done, const std::string& kept) {
  if (regions.empty()) return {};
  const auto earlier_count = models[regions.front()].components.coefficients.rows();
  const FrameMap map(earlier, static_cast<std::size_t>(earlier_count));
  const std::vector<std::size_t> frames = frames_to_unpose(map, context.pairs, earlier.size());
  std::vector<FramePair> new_pairs;
  std::copy_if(context.pairs.begin(), context.pairs.end(), std::back_inserter(new_pairs),
               [&](const FramePair& pair) { return map.is_new(pair); });
  std::vector<char> holds(models.size(), true);
  for (const SkinPart& part : parts_that_fit(context, regions, frames.size())) {
    const PartFrames unposed(context, part, "train: un-posing new frames", frames);
    Progress progress("train: regions", part.regions.size(), kept);
    parallel_for(part.regions.size(), [&](std::size_t k) {
      const std::size_t r = part.regions[k];
      const Components fresh = on_basis_of(models[r].components, unposed.displacements(), unposed.region(r));
      const Components all = extended(models[r].components, fresh, frames, earlier);
      holds[r] = components_hold(models[r], all, map);
      if (holds[r]) {
        RegionModel model = updated(context, models[r], all);
        holds[r] = hyper_parameters_hold(models[r], model);
        if (holds[r]) {
          carry_data_problems(unposed, r, new_pairs, map, model);
          models[r] = std::move(model);
          done(r, models[r]);
        }
      }
      progress.advance();
    });
  }
  std::vector<std::size_t> anew;
  std::copy_if(regions.begin(), regions.end(), std::back_inserter(anew), [&](std::size_t r) { return !holds[r]; });
  return anew;
}

}  // namespace bodyopt::trainer
