#include "trainer/transfer/refine_carried.h"

#include <algorithm>
#include <cmath>

#include "assets/wording.h"
#include "base/progress.h"
#include "runtime/core/error.h"
#include "runtime/host/device_choice.h"
#include "trainer/train/fit/train.h"

namespace bodyopt {
namespace {

void require_takes(const SampleSet& set, const std::set<std::string>& names) {
  for (const std::string& name : names) {
    if (std::ranges::find(set.takes, name) != set.takes.end()) continue;
    throw Error(ErrorKind::usage,
                "the dataset has no take '" + name + "' with frames to train on; there are " + list_names(set.takes));
  }
}

// Takes the samples of the body's own frames out of the set, which keeps the carried ones.
std::vector<Sample> take_own(SampleSet& set, const std::set<std::string>& carried) {
  const auto is_carried = [&](const Sample& sample) {
    return carried.contains(set.takes[static_cast<std::size_t>(sample.take)]);
  };
  const auto own = std::stable_partition(set.train.begin(), set.train.end(), is_carried);
  std::vector<Sample> taken(std::make_move_iterator(own), std::make_move_iterator(set.train.end()));
  set.train.erase(own, set.train.end());
  if (taken.empty()) {
    throw Error(ErrorKind::mismatch,
                "all takes are carried: there is no frame of the body's own to learn from; simulate some into the "
                "dataset");
  }
  if (set.train.empty()) throw Error(ErrorKind::mismatch, "no frame of the carried takes is trained on");
  return taken;
}

}  // namespace

std::string refinement_of(const std::string& take) { return "refined " + take; }

RefinedShapes::RefinedShapes(SampleSet set, const std::set<std::string>& carried, const TrainOptions& options) {
  require_takes(set, carried);
  set.heldout.clear();
  std::vector<Sample> own = take_own(set, carried);
  const Basis learned = train(set, options).basis;
  carried_ = std::make_unique<Deformer>(learned, DeviceChoice{.name = "cpu"});
  bare_ = std::make_unique<Deformer>(learned, DeviceChoice{.name = "cpu"});
  bare_->set_weights({.correction = 0});
  double sum = 0;
  Progress progress("transfer: what is off", own.size());
  for (Sample& sample : own) {
    const Positions off = sample.shape.read() - welded_from_output(set.character, of(*carried_, sample.pose).data());
    sum += off.squaredNorm() / static_cast<double>(off.rows());
    sample.shape = SampleShape(welded_from_output(set.character, of(*bare_, sample.pose).data()) + off);
    progress.advance();
  }
  difference_mm_ = 1e3 * std::sqrt(sum / static_cast<double>(own.size()));
  set.train = std::move(own);
  own_ = std::make_unique<Deformer>(train(set, options).basis, DeviceChoice{.name = "cpu"});
}

std::vector<float> RefinedShapes::of(Deformer& deformer, const Pose& pose) const {
  return deformer.evaluate({&pose, 1}).positions;
}

std::vector<float> RefinedShapes::operator()(const Pose& pose) {
  std::vector<float> shape = of(*carried_, pose);
  const std::vector<float> bare = of(*bare_, pose), own = of(*own_, pose);
  for (std::size_t k = 0; k < shape.size(); ++k) shape[k] += own[k] - bare[k];
  return shape;
}

}  // namespace bodyopt
