#include "proxy_viewer/state/pose_history.h"

namespace bodyopt {

void PoseHistory::begin(const ViewSettings::Posing& now) {
  steps_ = {{now.joints, now.controls}};
  at_ = 0;
}

void PoseHistory::note(const ViewSettings::Posing& now) {
  const Step step{now.joints, now.controls};
  if (step == steps_[at_]) return;
  steps_.resize(at_ + 1);
  steps_.push_back(step);
  if (steps_.size() > kMostSteps + 1) steps_.erase(steps_.begin());
  at_ = steps_.size() - 1;
}

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
  now.joints = step.joints;
  now.controls = step.controls;
}

}  // namespace bodyopt
