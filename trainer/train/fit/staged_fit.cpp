#include "trainer/train/fit/staged_fit.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/rows_where.h"
#include "base/wording.h"
#include "trainer/train/fit/choose_map.h"
#include "trainer/train/pack/trade_off.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

// An earlier training is brought to other frames where no more than this part of them is others.
constexpr double kMostOthers = 0.1;

std::vector<int> frames_in(const std::vector<std::uint64_t>& earlier, const std::vector<std::uint64_t>& frames) {
  std::map<std::uint64_t, int> numbers;
  for (std::size_t n = 0; n < earlier.size(); ++n) numbers.emplace(earlier[n], static_cast<int>(n));
  std::vector<int> found;
  for (const std::uint64_t frame : frames) {
    const auto number = numbers.find(frame);
    found.push_back(number == numbers.end() ? -1 : number->second);
  }
  return found;
}

}  // namespace

StagedFit::StagedFit(const SampleSet& set, const TrainOptions& options, std::vector<std::string>& notes)
    : set_(set), options_(options), notes_(notes), store_(options.keep_in) {
  if (store_.keeps()) look_back();
  if (options.surface_curves == 0 || !options.method.strains) return;
  curves_ = updates_ ? earlier_->curves : surface_curves(set, options);
}

void StagedFit::look_back() {
  lock_.emplace(options_.keep_in.string() + ".lock",
                "training this basis right now, and each would delete what the other keeps: wait for it to end, or "
                "name the basis otherwise");
  keys_ = training_keys(set_, options_);
  earlier_ = store_.layout();
  is_of_others_ = earlier_ && earlier_->from.subject != keys_.subject;
  if (is_of_others_) earlier_.reset();
  if (earlier_) earlier_frames_ = frames_in(earlier_->from.frames, keys_.frames);
  updates_ = options_.update && can_update();
}

// A tenth of the frames, of those before and of those now, may be others; none that was learned from may be held out.
bool StagedFit::can_update() const {
  const auto refuse = [&](const std::string& why) {
    notes_.push_back(why + ": trained from the start");
    return false;
  };
  if (!earlier_) {
    return refuse(is_of_others_ ? "what " + options_.keep_in.string() +
                                      " keeps is of another character, other muscles or regions, or other options"
                                : "there is nothing to update in " + options_.keep_in.string());
  }
  if (options_.smoothing_radius > 0 && options_.smoothing_radius != earlier_->smoothing_radius) {
    return refuse("the earlier training had another smoothing radius");
  }
  const std::vector<std::uint64_t>& before = earlier_->from.frames;
  const std::set<int> still(earlier_frames_.begin(), earlier_frames_.end());
  const auto fresh = static_cast<std::size_t>(std::count(earlier_frames_.begin(), earlier_frames_.end(), -1));
  const std::size_t gone = before.size() - (still.size() - still.count(-1));
  const auto too_many = [](std::size_t some, std::size_t all) {
    return static_cast<double>(some) > kMostOthers * static_cast<double>(all);
  };
  if (too_many(fresh, keys_.frames.size())) {
    return refuse(count_of(fresh, "frame", "frames") + " of " + std::to_string(keys_.frames.size()) +
                  " are new, more than a tenth");
  }
  if (too_many(gone, before.size())) {
    return refuse(count_of(gone, "frame", "frames") + " of " + std::to_string(before.size()) +
                  " are gone, more than a tenth");
  }
  const std::set<std::uint64_t> heldout(keys_.heldout.begin(), keys_.heldout.end());
  if (std::any_of(before.begin(), before.end(), [&](std::uint64_t frame) { return heldout.contains(frame); })) {
    return refuse("frames are held out that the earlier training learned from");
  }
  if (options_.budget > 0) {
    const Character ordered = in_order(set_.character, morton_order(set_.character.vertices));
    const Basis bare = make_ddm_base(ordered, earlier_->smoothing_radius, options_).basis;
    if (bytes_per_vertex(bare) > options_.budget) {
      return refuse("Direct Delta Mush of the earlier training takes more than --budget");
    }
  }
  return true;
}

TrainOptions StagedFit::options() const {
  TrainOptions options = options_;
  if (updates_) options.smoothing_radius = earlier_->smoothing_radius;
  return options;
}

EarlierFeatures StagedFit::earlier_features() const {
  if (!earlier_ || muscles_hash(earlier_->curves) != muscles_hash(curves_)) return {};
  return {earlier_->smoothing_radius, {earlier_->features, earlier_frames_}};
}

// No feature may vary in the new frames only.
bool StagedFit::suits(const Groundwork& ground) const {
  if (!updates_) return true;
  const Eigen::MatrixXd& values = ground.features.values;
  const std::vector<Eigen::Index> known = rows_where(earlier_frames_, [](int frame) { return frame >= 0; });
  const auto count = static_cast<std::uint32_t>(values.cols());
  Eigen::MatrixXd before = values(known, Eigen::all);
  const Eigen::RowVectorXd mean = before.colwise().mean();
  before.rowwise() -= mean;
  if (varying_features(values, 0, count) == varying_features(before, 0, count)) return true;
  notes_.push_back("joints or muscles move that did not move before: trained from the start");
  return false;
}

Layout StagedFit::layout(const Groundwork& ground) {
  if (updates_) {
    const bool same = earlier_->from.frames == keys_.frames && earlier_->from.takes == keys_.takes;
    if (same) notes_.push_back("no frame has changed since the earlier training: what it found is kept as it is");
    key_ = same ? earlier_->key : updated_key(earlier_->key, keys_);
    return earlier_->layout;
  }
  key_ = training_key(keys_, ground.base.radius);
  if (earlier_ && earlier_->key == key_) return earlier_->layout;
  Layout layout = make_layout(set_, ground, options_.method);
  keep(ground, layout);
  return layout;
}

void StagedFit::keep(const Groundwork& ground, const Layout& layout) const {
  store_.keep({key_, keys_, ground.base.radius, curves_, ground.features.raw, layout});
  store_.forget_other_regions(key_);
}

std::vector<RegionModel> StagedFit::regions(const Groundwork& ground, const Layout& layout) {
  const FitContext context(set_, ground, layout, options_);
  std::vector<RegionModel> models(layout.regions.size());
  std::vector<std::size_t> missing;
  for (std::size_t r = 0; r < models.size(); ++r) {
    std::optional<RegionModel> kept = store_.region(r, key_);
    if (!kept) missing.push_back(r);
    if (kept) models[r] = std::move(*kept);
  }
  const RegionDone done = [&](std::size_t r, const RegionModel& model) { store_.keep(r, key_, model); };
  const std::string kept = store_.keeps() ? "run again, it goes on: what is done is in " + options_.keep_in.string()
                                          : "nothing of it is kept";
  if (updates_) missing = update(context, models, missing, done, kept);
  if (!missing.empty()) fit_regions(context, missing, models, done, kept);
  if (updates_) keep(ground, layout);
  return models;
}

std::vector<std::size_t> StagedFit::update(const FitContext& context, std::vector<RegionModel>& models,
                                           const std::vector<std::size_t>& missing, const RegionDone& done,
                                           const std::string& kept) {
  std::vector<std::size_t> old, anew;
  for (const std::size_t r : missing) {
    std::optional<RegionModel> model = store_.region(r, earlier_->key);
    (model ? old : anew).push_back(r);
    if (model) models[r] = std::move(*model);
  }
  const std::vector<std::size_t> refused = update_regions(context, earlier_frames_, old, models, done, kept);
  if (!refused.empty()) {
    notes_.push_back("in " + count_of(refused.size(), "region", "regions") + " of " + std::to_string(models.size()) +
                     " what the earlier training found does not fit these frames: fitted from the start");
  }
  anew.insert(anew.end(), refused.begin(), refused.end());
  std::sort(anew.begin(), anew.end());
  return anew;
}

}  // namespace bodyopt::trainer
