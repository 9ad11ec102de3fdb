#include "proxy_viewer/state/pose_history.h"

namespace bodyopt {

void PoseHistory::begin(const ViewSettings::Posing& now) {
  steps_ = {{now, now.keys}};
  at_ = 0;
}

void PoseHistory::note(const ViewSettings::Posing& now) {
  const Step step{now, now.keys};
  if (step == steps_[at_]) return;
  steps_.resize(at_ + 1);
  steps_.push_back(step);
  if (steps_.size() > kMostSteps + 1) steps_.erase(steps_.begin());
  at_ = steps_.size() - 1;
}

void PoseHistory::follow(const ViewSettings::Posing& now) { steps_[at_].pose = now; }

bool PoseHistory::undo(ViewSettings::Posing& now) {
  note(now);
  if (at_ == 0) return false;
  show(steps_[--at_], now);
  return true;
}

bool PoseHistory::redo(ViewSettings::Posing& now) {
  note(now);
  if (at_ + 1 == steps_.size()) return false;
  show(steps_[++at_], now);
  return true;
}

void PoseHistory::show(const Step& step, ViewSettings::Posing& now) {
  static_cast<ViewSettings::PoseKey&>(now) = step.pose;
  now.keys = step.keys;
}

}  // namespace bodyopt
