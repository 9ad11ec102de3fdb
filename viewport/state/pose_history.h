// Earlier values of the pose on top of the clip, and of the camera's keys, step by step.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "shots/session/view_settings.h"

namespace bodyopt::viewport {

class PoseHistory {
 public:
  static constexpr std::size_t kMostSteps = 100;  // the oldest are forgotten

  // Begins with another pose, which has no step before it.
  void begin(const shots::ViewSettings& now);
  // Takes a change since then as a step, at a frame, and forgets what was undone.
  void note(const shots::ViewSettings& now, int frame = 0);

  // Follows the keys to the pose of another frame: that is no step, and what the last one set is kept.
  void follow(const shots::ViewSettings& now, int frame);

  // Goes a step back or forth from what is now, and returns the frame that it is of; nothing where there is none.
  std::optional<int> undo(shots::ViewSettings& now, int frame = 0);
  std::optional<int> redo(shots::ViewSettings& now, int frame = 0);

 private:
  struct Step {
    shots::ViewSettings::PoseKey pose;
    std::map<int, shots::ViewSettings::PoseKey> keys;
    std::map<int, shots::CameraKey> camera_keys;
    std::string camera_of_file;
    int frame = 0;
    bool is_of(const Step& other) const {
      return pose == other.pose && keys == other.keys && camera_keys == other.camera_keys;
    }
  };

  static Step step_of(const shots::ViewSettings& now, int frame) {
    return {now.pose, now.pose.keys, now.shot_camera.keys, now.shot_camera.of_file, frame};
  }
  int show(const Step& step, shots::ViewSettings& now);

  std::vector<Step> steps_ = {{}};  // oldest first
  std::size_t at_ = 0;              // that is shown
  std::optional<Step> followed_;    // what keys made of it since, at another frame
};

}  // namespace bodyopt::viewport
