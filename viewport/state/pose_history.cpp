#include "viewport/state/pose_history.h"

namespace bodyopt::viewport {

void PoseHistory::begin(const shots::ViewSettings& now) {
  steps_ = {step_of(now, 0)};
  at_ = 0;
  followed_.reset();
}

void PoseHistory::note(const shots::ViewSettings& now, int frame) {
  const Step step = step_of(now, frame);
  if (step.is_of(followed_ ? *followed_ : steps_[at_])) return;
  steps_.resize(at_ + 1);
  if (followed_ && !followed_->is_of(steps_[at_])) steps_.push_back(*followed_);
  followed_.reset();
  steps_.push_back(step);
  if (steps_.size() > kMostSteps + 1) steps_.erase(steps_.begin(), steps_.end() - kMostSteps - 1);
  at_ = steps_.size() - 1;
}

// The keys are those of the last step: a change of them is yet to be noted.
void PoseHistory::follow(const shots::ViewSettings& now, int frame) {
  followed_ = {now.pose, steps_[at_].keys, steps_[at_].camera_keys, steps_[at_].camera_of_file, frame};
}

std::optional<int> PoseHistory::undo(shots::ViewSettings& now, int frame) {
  note(now, frame);
  if (at_ == 0) return {};
  return show(steps_[--at_], now);
}

std::optional<int> PoseHistory::redo(shots::ViewSettings& now, int frame) {
  note(now, frame);
  if (at_ + 1 == steps_.size()) return {};
  return show(steps_[++at_], now);
}

int PoseHistory::show(const Step& step, shots::ViewSettings& now) {
  followed_.reset();
  static_cast<shots::ViewSettings::PoseKey&>(now.pose) = step.pose;
  now.pose.keys = step.keys;
  if (now.shot_camera.keys == step.camera_keys) return step.frame;
  now.shot_camera.keys = step.camera_keys;
  now.shot_camera.of_file = step.camera_of_file;
  return step.frame;
}

}  // namespace bodyopt::viewport
