// What is set on top of the clip: between the frames that have keys, and before it was changed, step by step.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "proxy_viewer/state/view_settings.h"

namespace bodyopt {

// Slow at each key, fast between them; before the first and after the last as those. Joints and axes that a key leaves
// out are there as the clip has them, controls and pins as the other key has them. There must be a key.
ViewSettings::PoseKey between_keys(const std::map<int, ViewSettings::PoseKey>& keys, int frame);

// The posing as it is at a frame: by its keys, or, without any, as it is.
ViewSettings::Posing keyed_posing(ViewSettings::Posing posing, int frame);

class PoseHistory {
 public:
  static constexpr std::size_t kMostSteps = 100;  // the oldest are forgotten

  // Of another pose, which has no step before it.
  void begin(const ViewSettings::Posing& now);
  // Where it has changed since, that is a step; what was undone is forgotten then.
  void note(const ViewSettings::Posing& now);

  // The keys show another pose at another frame: that is no step.
  void follow(const ViewSettings::Posing& now);

  // A step back or forth from what is now. False where there is none.
  bool undo(ViewSettings::Posing& now);
  bool redo(ViewSettings::Posing& now);

 private:
  struct Step {
    ViewSettings::PoseKey pose;
    std::map<int, ViewSettings::PoseKey> keys;
    bool operator==(const Step&) const = default;
  };

  static void show(const Step& step, ViewSettings::Posing& now);

  std::vector<Step> steps_ = {{}};  // oldest first
  std::size_t at_ = 0;              // that is shown
};

}  // namespace bodyopt
